//! Solids that particles bounce off.

mod list;
mod moving;

use bevy::prelude::*;

pub(super) use self::{
    list::Colliders,
    moving::{Collider, ColliderPath},
};
use crate::{
    settings::{Checked, SettingRange, Settings},
    source::solid::SolidShape,
};

/// A solid that the particles of every [`ParticleEmitter`](super::ParticleEmitter) bounce off. It
/// follows the transform of its entity, scale included; a collider that moves or turns carries
/// particles along. Create it from one of Bevy's shapes, or by [`ground`](Self::ground).
///
/// Particles collide as balls of their radius. A particle that is narrowly wedged between two
/// solids may be pressed into one of them. Values out of range are logged once and clamped.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_fluid::prelude::*;
/// # fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
/// let ball = Sphere::new(0.3);
/// commands.spawn((
///     Mesh3d(meshes.add(ball)),
///     ParticleCollider { restitution: 0.6, ..ParticleCollider::new(ball) },
///     Transform::from_xyz(0.0, 1.0, 0.0),
/// ));
/// # }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, ColliderPath, Checked<Self>)]
pub struct ParticleCollider {
    /// Its shape. Default: the ground.
    pub shape: SolidShape,
    /// Restitution: share of the speed across the surface that is left after a bounce. Range 0..=1,
    /// default 0.2. Higher: particles bounce more; 0: they stay on it.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
    /// Coulomb's friction coefficient: maximum ratio of the force along the surface to that across
    /// it. Range 0..=1000, default 0.2. Higher: particles stop sooner and stay on steeper slopes.
    #[reflect(@SettingRange::new(0.0, 1e3).logarithmic())]
    pub friction: f32,
}

impl ParticleCollider {
    /// The default: the ground.
    pub const DEFAULT: Self = Self {
        shape: SolidShape::Ground,
        restitution: 0.2,
        friction: 0.2,
    };

    /// A collider of this shape, such as one of Bevy's primitives.
    pub fn new(shape: impl Into<SolidShape>) -> Self {
        Self {
            shape: shape.into(),
            ..Self::DEFAULT
        }
    }

    /// Everything below the entity's xz plane.
    pub const fn ground() -> Self {
        Self::DEFAULT
    }
}

impl Settings for ParticleCollider {}

impl Default for ParticleCollider {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl<T: Into<SolidShape>> From<T> for ParticleCollider {
    fn from(shape: T) -> Self {
        Self::new(shape)
    }
}
