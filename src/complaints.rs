//! Errors already logged for each entity, so that each is logged once.

use bevy::ecs::entity::{Entity, EntityHashMap};

/// An error about a setting.
pub(crate) trait AboutField {
    /// The name of the setting.
    fn field(&self) -> &'static str;
}

/// The field named by the last error logged for each entity.
#[derive(Default)]
pub(crate) struct Complaints(EntityHashMap<&'static str>);

impl Complaints {
    /// Returns the error of an entity's settings, unless it has been logged already.
    pub(crate) fn of<E: AboutField>(
        &mut self,
        entity: Entity,
        checked: Result<(), E>,
    ) -> Option<E> {
        let Err(error) = checked else {
            self.0.remove(&entity);
            return None;
        };
        // Errors are compared by field: NaN never equals itself, and a value that is animated out
        // of range would be logged every frame.
        let before = self.0.insert(entity, error.field());
        (before != Some(error.field())).then_some(error)
    }

    /// Forgets an entity that is gone.
    pub(crate) fn forget(&mut self, entity: Entity) {
        self.0.remove(&entity);
    }
}
