//! Why something is not simulated, logged once for each entity.

use core::mem::{Discriminant, discriminant};

use bevy::{ecs::entity::EntityHashMap, prelude::*};
use thiserror::Error;

use super::SalvaShape;

/// Why a fluid, a boundary or a body is not simulated as it is set.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SalvaError {
    /// The radius of a fluid's particles is not finite and positive.
    #[error("`FluidParticles::radius` is {0}; it must be finite and above 0")]
    Radius(f32),
    /// The radius differs from that of the other fluids.
    #[error("its particles' radius is {own}, but that of all simulated fluids is {others}")]
    OtherRadius {
        /// Radius in the world's space, m.
        own: f32,
        /// Radius of the fluid that came first, m.
        others: f32,
    },
    /// There is no `Mesh3d` with triangles in the main world, or a body's hull has no volume.
    #[error(
        "there is no `Mesh3d` with triangles in the main world, or a body's hull has no volume"
    )]
    Mesh,
    /// A size is not finite and positive.
    #[error("`SalvaShape` {0:?} (scaled) is invalid: sizes must be finite and above 0")]
    Shape(SalvaShape),
    /// A body's shape is hollow or endless.
    #[error("a body cannot be a `SalvaShape::Tank` or the `SolidShape::Ground`")]
    BodyShape,
    /// The transform is not finite.
    #[error("its transform is not finite")]
    Transform,
    /// A surface needs more particles than can be simulated.
    #[error(
        "its surface is too large for particles of this radius: liquid collides with its shell only"
    )]
    Surface,
}

/// The kind of error last logged for each entity: an animated value is not logged in every frame.
#[derive(Default)]
pub(super) struct Warned(EntityHashMap<Discriminant<SalvaError>>);

impl Warned {
    /// The error, unless it has been logged already.
    pub(super) fn news(
        &mut self,
        entity: Entity,
        result: Result<(), SalvaError>,
    ) -> Option<SalvaError> {
        let Err(error) = result else {
            self.0.remove(&entity);
            return None;
        };
        let kind = discriminant(&error);
        (self.0.insert(entity, kind) != Some(kind)).then_some(error)
    }

    /// Forgets an entity that is gone.
    pub(super) fn forget(&mut self, entity: Entity) {
        self.0.remove(&entity);
    }
}
