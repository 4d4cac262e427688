//! Entities and resources to show.

use bevy::{ecs::reflect::ReflectResource, prelude::*, reflect::TypeRegistry};

use crate::{inspector::FluidInspector, particles::FluidParticles};

/// Entities that have something to show.
#[derive(Default)]
pub(super) struct Subjects {
    pub(super) cameras: Vec<(Entity, String)>,
    pub(super) fluids: Vec<(Entity, String)>,
    pub(super) others: Vec<(Entity, String)>,
    pub(super) resources: Vec<Entity>,
}

impl Subjects {
    pub(super) fn find(
        world: &mut World,
        inspector: &FluidInspector,
        types: &TypeRegistry,
    ) -> Self {
        let components: Vec<_> = inspector
            .types()
            .iter()
            .filter_map(|id| Some((world.components().get_id(*id)?, types.get(*id)?)))
            .collect();
        if components.is_empty() {
            return Self::default();
        }
        let mut query = QueryBuilder::<EntityRef>::new(world);
        query.or(|any| {
            for (id, _) in &components {
                any.with_id(*id);
            }
        });
        let mut found = Self::default();
        for entity in query.build().iter(world) {
            let is_resource = components.iter().any(|(id, registration)| {
                entity.contains_id(*id) && registration.contains::<ReflectResource>()
            });
            let (list, kind) = if is_resource {
                found.resources.push(entity.id());
                continue;
            } else if entity.contains::<Camera>() {
                (&mut found.cameras, "camera")
            } else if entity.contains::<FluidParticles>() {
                (&mut found.fluids, "fluid")
            } else {
                (&mut found.others, "entity")
            };
            let name = match entity.get::<Name>() {
                Some(name) => name.to_string(),
                None => format!("{kind} {}", entity.id()),
            };
            list.push((entity.id(), name));
        }
        for list in [&mut found.cameras, &mut found.fluids, &mut found.others] {
            list.sort();
        }
        found
    }

    /// In the order in which they are shown.
    pub(super) fn all(&self) -> impl Iterator<Item = Entity> {
        let named = [&self.cameras, &self.fluids, &self.others].into_iter();
        let named = named.flatten().map(|(entity, _)| *entity);
        named.chain(self.resources.iter().copied())
    }
}
