//! The components of simulated solids, and the load on them.

use bevy::prelude::*;

use crate::{
    settings::{Checked, SettingRange, Settings},
    source::solid::SolidShape,
};

/// The shape of a simulated solid in the space of its entity, scaled by the entity's transform.
/// Bevy's primitives convert into it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SalvaShape {
    /// The entity's `Mesh3d`, which must be kept in the main world (`RenderAssetUsages`). A
    /// boundary uses its triangles: liquid is on their front side, so a closed mesh keeps it out
    /// or, with its walls modelled, in; walls should be two radii thick. A body uses their convex
    /// hull, which must have a volume. Later changes within a mesh are not detected.
    #[default]
    Mesh,
    /// A convex solid. Its sizes must be above 0, but for the half length of a capsule; the ground
    /// is only for boundaries.
    Solid(SolidShape),
    /// A box around the origin with liquid inside, open at the top. Only for boundaries.
    Tank {
        /// Half of the side lengths of the inside. Unit: m, range 1e-6..=1e6.
        #[reflect(@SettingRange::new(1e-3, 1e3).unit("m").logarithmic().valid(1e-6, 1e6))]
        half_size: Vec3,
    },
}

impl<T: Into<SolidShape>> From<T> for SalvaShape {
    fn from(solid: T) -> Self {
        Self::Solid(solid.into())
    }
}

/// A solid that liquid and [`SalvaBody`]s collide with: at rest, or moved by its transform.
///
/// Between two frames it moves evenly, and its velocity acts on the liquid: a plunger makes waves,
/// a tipped tank pours. It jumps, without a velocity, when it is inserted again or
/// [teleported](crate::relocation), and when it moves faster than
/// [`TeleportSettings::speed`](crate::relocation::TeleportSettings::speed) or
/// [`SalvaSettings::max_speed`](super::SalvaSettings::max_speed). No particle passes its surface,
/// from either side, however fast.
///
/// It always follows its transform, even while the liquid moves in slow motion: at a fifth of the
/// speed, a plunger of 1 m/s hits the liquid at 5 m/s. Where that matters, move it in the liquid's
/// time: by `time.delta_secs() * status.speed` of [`SalvaStatus`](super::SalvaStatus).
///
/// Values out of range are logged once and clamped.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, Checked<Self>)]
pub struct SalvaBoundary {
    /// Its shape. Default: the entity's mesh.
    pub shape: SalvaShape,
    /// Friction of bodies on it. Range 0..=10, default 0.5.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub friction: f32,
    /// Restitution of bodies that bounce off it. Range 0..=1, default 0.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
}

impl SalvaBoundary {
    /// The surface of the entity's `Mesh3d`.
    pub const MESH: Self = Self::of(SalvaShape::Mesh);
    /// Endless ground.
    pub const GROUND: Self = Self::of(SalvaShape::Solid(SolidShape::Ground));

    /// A boundary of a shape, such as one of Bevy's primitives.
    pub fn new(shape: impl Into<SalvaShape>) -> Self {
        Self::of(shape.into())
    }

    /// A box with liquid inside, open at the top; `size` (m) is that of the inside.
    pub fn tank(size: Vec3) -> Self {
        Self::of(SalvaShape::Tank {
            half_size: 0.5 * size,
        })
    }

    const fn of(shape: SalvaShape) -> Self {
        Self {
            shape,
            friction: 0.5,
            restitution: 0.0,
        }
    }
}

impl Settings for SalvaBoundary {}

impl Default for SalvaBoundary {
    fn default() -> Self {
        Self::MESH
    }
}

/// A rigid body moved by rapier and coupled with the liquid in both directions: it floats where its
/// [`density`](Self::density) is less than the fluid's.
///
/// Its `Transform` is written in every update, in world space: it must have no parent. A transform
/// written by other code teleports it, at rest, but for a
/// [`WorldShift`](crate::relocation::WorldShift), through which it goes on. It should be several
/// particles across.
///
/// Other changes leave its motion unchanged; inserting it again restarts it. On an entity that also
/// has a [`SalvaBoundary`], the body takes precedence. Values out of range are logged once and
/// clamped.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, Checked<Self>)]
pub struct SalvaBody {
    /// Its shape. Default: the convex hull of the entity's mesh.
    pub shape: SalvaShape,
    /// Density. Unit: kg/m³, range 20..=100000, default 500: wood. Below a fifth of the liquid's
    /// density it trembles, as the liquid responds a step late.
    #[reflect(@SettingRange::new(20.0, 1e5).unit("kg/m³").logarithmic())]
    pub density: f32,
    /// Initial velocity; a later change is applied at once. Unit: m/s, default 0.
    #[reflect(@SettingRange::new(-100.0, 100.0).unit("m/s").open())]
    pub velocity: Vec3,
    /// Initial angular velocity; a later change is applied at once, together with the velocity.
    /// Unit: rad/s, default 0.
    #[reflect(@SettingRange::new(-100.0, 100.0).unit("rad/s").open())]
    pub angular_velocity: Vec3,
    /// Friction coefficient. Range 0..=10, default 0.5.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub friction: f32,
    /// Restitution: how much it bounces. Range 0..=1, default 0.2.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub restitution: f32,
}

impl SalvaBody {
    /// A body of a shape, such as one of Bevy's primitives, and a density (kg/m³), at rest.
    pub fn new(shape: impl Into<SalvaShape>, density: f32) -> Self {
        Self {
            shape: shape.into(),
            density,
            velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            friction: 0.5,
            restitution: 0.2,
        }
    }
}

impl Settings for SalvaBody {}

impl Default for SalvaBody {
    fn default() -> Self {
        Self::new(SalvaShape::Mesh, 500.0)
    }
}

/// The load of the liquid on the [`SalvaBoundary`] or the [`SalvaBody`] of its entity, written
/// whenever steps are finished.
///
/// For scales and triggers, and for boundaries moved by another physics engine: rapier worlds
/// outside of this crate are not coupled directly.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct SalvaLoad {
    /// Force in world space, the mean over the finished steps. Unit: N.
    pub force: Vec3,
    /// Torque about the body's centre of mass, or the boundary's origin. Unit: N m.
    pub torque: Vec3,
}
