//! The messages, and the speed from which on none is needed.

use bevy::prelude::*;

use crate::settings::{Checked, SettingRange, Settings};

/// The whole world has been moved by this way (m): the origin has been put elsewhere.
///
/// To be written once for every frame in which all transforms are shifted; several add up. See
/// [`relocation`](crate::relocation) for its use. A way that is not finite is ignored, which is
/// logged once.
#[derive(Message, Clone, Copy, Debug, Default, PartialEq)]
pub struct WorldShift(pub Vec3);

/// An entity, and with it all its descendants, has been put elsewhere: its move in this frame was no
/// motion.
///
/// See [`relocation`](crate::relocation) for its use.
#[derive(Message, Clone, Copy, Debug, PartialEq)]
pub struct Teleport {
    /// What has been put elsewhere.
    pub entity: Entity,
    /// The way that its particles are moved, in the world's space; `None`: they stay.
    pub particles: Option<Isometry3d>,
}

impl Teleport {
    /// The entity alone: its particles stay where they are.
    pub const fn of(entity: Entity) -> Self {
        Self {
            entity,
            particles: None,
        }
    }

    /// Its particles come along, by this way in the world's space: a vector (m), or an
    /// [`Isometry3d`], which turns them about the origin first, velocities too.
    ///
    /// A way that is not finite is ignored, which is logged once.
    #[must_use]
    pub fn carrying(self, way: impl Into<Isometry3d>) -> Self {
        Self {
            particles: Some(way.into()),
            ..self
        }
    }
}

/// When a move is a jump by itself.
///
/// Values out of range are logged once and clamped.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[require(Checked<Self>)]
pub struct TeleportSettings {
    /// An emitter, a collider or a boundary that moves faster than this has jumped, as by
    /// [`Teleport::of`]. A turn of a collider or a boundary counts by the way of a point a metre
    /// from its axis. Unit: m/s, range 0..=∞, default 50: 0.8 m a frame at 60 frames a second.
    /// Higher: fast vehicles spread their particles along their way, and what is put elsewhere
    /// needs a message. Infinite: never.
    #[reflect(@SettingRange::new(1.0, 1e3).unit("m/s").logarithmic().valid(0.0, f64::INFINITY))]
    pub speed: f32,
}

impl Settings for TeleportSettings {}

impl Default for TeleportSettings {
    fn default() -> Self {
        Self { speed: 50.0 }
    }
}
