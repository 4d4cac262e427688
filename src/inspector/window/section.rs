//! A component's settings.

use bevy::{
    ecs::reflect::ReflectComponent,
    prelude::*,
    reflect::{PartialReflect, TypeRegistration, TypeRegistry},
};
use bevy_egui::egui::{CollapsingHeader, Ui};
use core::any::TypeId;

use crate::{
    inspector::{rust_code, walker::Walker, widgets},
    material::FluidMaterial,
    settings::ScreenSpaceFluid,
};

/// A section for a component, if the entity has it.
pub(super) fn component(
    ui: &mut Ui,
    world: &mut World,
    entity: Entity,
    registration: &TypeRegistration,
    types: &TypeRegistry,
) {
    let Some(data) = registration.data::<ReflectComponent>() else {
        return;
    };
    if !data.contains(world.entity(entity)) {
        return;
    }
    let info = registration.type_info();
    let name = info.type_path_table().short_path();
    let header = CollapsingHeader::new(name)
        .id_salt((name, entity))
        .default_open(opens(info.type_id()))
        .show_unindented(ui, |ui| {
            // Lists of one name are in more than one section.
            ui.push_id(name, |ui| {
                let Some(mut value) = data.reflect_mut(world.entity_mut(entity)) else {
                    return;
                };
                let edited = section(ui, value.bypass_change_detection(), types);
                if edited {
                    value.set_changed();
                }
            });
        });
    widgets::explained(header.header_response, info.docs());
}

/// Whether a section is open at first.
fn opens(id: TypeId) -> bool {
    id == TypeId::of::<ScreenSpaceFluid>() || id == TypeId::of::<FluidMaterial>()
}

/// Presets, reset and copy above all fields.
fn section(ui: &mut Ui, value: &mut dyn Reflect, types: &TypeRegistry) -> bool {
    let walker = Walker { registry: types };
    let default = walker.default_of(value.reflect_type_info().type_id());
    let default = default.as_deref().map(PartialReflect::as_partial_reflect);
    let value = value.as_partial_reflect_mut();
    let mut edited = false;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let label = ui.weak("preset");
        edited |= walker.presets(ui, label.id, value, 120.0);
        if let Some(default) = default
            && ui
                .button("Reset")
                .on_hover_text("all to the defaults")
                .clicked()
        {
            edited |= value.try_apply(default).is_ok();
        }
        let copy = ui.button("Copy as Rust");
        if copy
            .on_hover_text("what differs from the defaults, as code")
            .clicked()
        {
            ui.ctx().copy_text(rust_code(value, types));
        }
    });
    edited | walker.parts(ui, value, default, 0)
}
