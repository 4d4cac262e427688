//! Entities and resources as the Rust statements that create them.

use bevy::{
    ecs::reflect::{ReflectComponent, ReflectResource},
    prelude::*,
    reflect::{TypeRegistration, TypeRegistry},
};
use core::any::TypeId;

use super::Writer;
use crate::settings::FluidDebugView;

/// The Rust statement that spawns an entity with those of its components that are in `types`, each
/// as [`rust_code`](super::rust_code) writes it. The entity's name, its transform and its
/// `Camera3d` are included. For a resource, the statement inserts it. The code is for a system with
/// `mut commands: Commands`.
///
/// ```
/// use bevy::{prelude::*, reflect::TypeRegistry};
/// use bevy_fluid::{prelude::SurfaceKernel, inspector::spawn_code};
/// use core::any::TypeId;
///
/// let mut registry = TypeRegistry::new();
/// registry.register::<SurfaceKernel>();
/// let mut world = World::new();
/// let pond = world.spawn((Name::new("pond"), SurfaceKernel::THESIS.clone()));
/// let code = spawn_code(pond.as_readonly(), &[TypeId::of::<SurfaceKernel>()], &registry);
/// assert!(code.starts_with("commands.spawn((\n    Name::new(\"pond\"),\n    SurfaceKernel {"));
/// ```
pub fn spawn_code(entity: EntityRef, types: &[TypeId], registry: &TypeRegistry) -> String {
    let shown: Vec<_> = types.iter().filter_map(|id| registry.get(*id)).collect();
    let code = |registration: &TypeRegistration, depth| {
        let component = registration.data::<ReflectComponent>()?.reflect(entity)?;
        let code = Writer { registry }.expression(component.as_partial_reflect(), depth);
        Some(code.unwrap_or_else(|| "default()".into()))
    };
    let resource = shown.iter().find_map(|registration| {
        registration.data::<ReflectResource>()?;
        code(registration, 0)
    });
    if let Some(resource) = resource {
        return format!("commands.insert_resource({resource});");
    }
    let mut parts = Vec::new();
    if let Some(name) = entity.get::<Name>() {
        parts.push(format!("Name::new({:?})", name.as_str()));
    }
    if entity.contains::<Camera3d>() {
        parts.push("Camera3d::default()".into());
    }
    // Visible properties other than the settings.
    let place = entity.get::<Transform>();
    if let Some(place) = place.filter(|place| **place != Transform::IDENTITY) {
        parts.extend(Writer { registry }.expression(place, 1));
    }
    if let Some(view) = entity.get::<FluidDebugView>() {
        parts.extend(Writer { registry }.expression(view, 1));
    }
    let is_listed = |it: &&&TypeRegistration| it.type_id() != TypeId::of::<FluidDebugView>();
    parts.extend(shown.iter().filter(is_listed).filter_map(|it| code(it, 1)));
    match &parts[..] {
        [] => "commands.spawn_empty();".into(),
        _ => format!("commands.spawn((\n    {},\n));", parts.join(",\n    ")),
    }
}
