//! What light goes through.

use glam::DVec3;

use super::Object;
use crate::Surface;

/// Radiance from far away, by unit direction in world space.
pub type Sky<'a> = dyn Fn(DVec3) -> DVec3 + Send + Sync + 'a;

/// What light meets.
#[derive(Clone, Copy)]
pub struct World<'a> {
    /// The liquid.
    pub surface: &'a dyn Surface,
    /// Opaque things. Let the liquid reach a little into those that it touches, or there is air
    /// between.
    pub objects: &'a [Object],
    /// What is around it all.
    pub sky: &'a Sky<'a>,
}

/// What the liquid does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics {
    /// Refractive index relative to the air around it.
    pub refractive_index: f64,
    /// Extinction per channel, 1/m: after d metres exp(−extinction · d) is left (Beer–Lambert).
    pub extinction: DVec3,
}

impl Optics {
    /// Water that absorbs nothing.
    pub const WATER: Self = Self {
        refractive_index: 1.333,
        extinction: DVec3::ZERO,
    };

    /// The fraction left after a path (m) inside.
    pub fn transmitted(&self, distance: f64) -> DVec3 {
        (-self.extinction * distance).exp()
    }
}
