//! Solids that particles bounce off.

mod list;
mod moving;

use bevy::prelude::*;

pub(super) use self::{
    list::Colliders,
    moving::{Collider, ColliderPath},
};
use crate::settings::{Checked, SettingRange, Settings};

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
///     ParticleCollider { restitution: 0.6, ..ball.into() },
///     Transform::from_xyz(0.0, 1.0, 0.0),
/// ));
/// # }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, ColliderPath, Checked<Self>)]
pub struct ParticleCollider {
    /// Its shape. Default: the ground.
    pub shape: ColliderShape,
    /// Restitution: share of the speed across the surface that is left after a bounce. Range 0..=1,
    /// default 0.2. Higher: particles bounce more; 0: they stay on it.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
    /// Coulomb's friction coefficient: maximum ratio of the force along the surface to that across
    /// it. Range 0..=1000, default 0.2. Higher: particles stop sooner and stay on steeper slopes.
    #[reflect(@SettingRange::new(0.0, 1e3).logarithmic())]
    pub friction: f32,
}

/// The shape of a [`ParticleCollider`], in its entity's space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum ColliderShape {
    /// Everything below the xz plane.
    #[default]
    Ground,
    /// A ball around the origin. With a non-uniform scale, the largest component applies.
    Sphere {
        /// Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        radius: f32,
    },
    /// An axis-aligned box around the origin.
    Cuboid {
        /// Half of its side lengths. Unit: m, range 0..=1e6 each.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        half_size: Vec3,
    },
    /// A cylinder along y with a hemisphere at each end. The greater of the scales along x and z
    /// applies to the radius.
    Capsule {
        /// Radius of the cylinder and the hemispheres. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        radius: f32,
        /// Half of the cylinder's length, without the hemispheres. Unit: m, range 0..=1e6.
        #[reflect(@SettingRange::new(0.0, 1e6).unit("m").logarithmic())]
        half_length: f32,
    },
}

impl ParticleCollider {
    /// The default: the ground.
    pub const DEFAULT: Self = Self {
        shape: ColliderShape::Ground,
        restitution: 0.2,
        friction: 0.2,
    };

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

impl From<ColliderShape> for ParticleCollider {
    fn from(shape: ColliderShape) -> Self {
        Self {
            shape,
            ..Self::DEFAULT
        }
    }
}

impl From<Sphere> for ParticleCollider {
    fn from(Sphere { radius }: Sphere) -> Self {
        ColliderShape::Sphere { radius }.into()
    }
}

impl From<Cuboid> for ParticleCollider {
    fn from(Cuboid { half_size }: Cuboid) -> Self {
        ColliderShape::Cuboid { half_size }.into()
    }
}

impl From<Capsule3d> for ParticleCollider {
    fn from(capsule: Capsule3d) -> Self {
        ColliderShape::Capsule {
            radius: capsule.radius,
            half_length: capsule.half_length,
        }
        .into()
    }
}
