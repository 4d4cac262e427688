//! What has been said of whom, so that the same is not said again.

use bevy::ecs::entity::{Entity, EntityHashMap};

/// An error about a setting.
pub(crate) trait AboutField {
    /// The name of the setting.
    fn field(&self) -> &'static str;
}

/// What has been said of whom.
#[derive(Default)]
pub(crate) struct Complaints(EntityHashMap<&'static str>);

impl Complaints {
    /// The error of an entity's settings, unless it has been said already.
    pub(crate) fn of<E: AboutField>(
        &mut self,
        entity: Entity,
        checked: Result<(), E>,
    ) -> Option<E> {
        let Err(error) = checked else {
            self.0.remove(&entity);
            return None;
        };
        // By what they name: a number that is none never equals itself, and one that is
        // animated out of range would be said every frame.
        let before = self.0.insert(entity, error.field());
        (before != Some(error.field())).then_some(error)
    }

    /// Forgets an entity that is gone.
    pub(crate) fn forget(&mut self, entity: Entity) {
        self.0.remove(&entity);
    }
}
