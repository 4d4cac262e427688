//! Opaque things.

use glam::DVec3;

use super::SKIN;
use crate::{Ray, Surface};

/// Something opaque that shines by itself, as unlit materials do.
pub struct Object {
    /// Its surface.
    pub surface: Box<dyn Surface>,
    /// Radiance by place (m) on the surface.
    pub color: Box<dyn Fn(DVec3) -> DVec3 + Send + Sync>,
}

impl Object {
    /// A thing of a shape and a colour.
    pub fn new(
        surface: impl Surface + 'static,
        color: impl Fn(DVec3) -> DVec3 + Send + Sync + 'static,
    ) -> Self {
        Self {
            surface: Box::new(surface),
            color: Box::new(color),
        }
    }

    /// Distance (m) at which a ray meets it.
    pub(super) fn meets(&self, ray: &Ray) -> Option<f64> {
        let mut crossings = Vec::new();
        self.surface.crossings(ray, &mut crossings);
        let met = crossings.iter().find(|c| c.t > SKIN && c.entering);
        met.map(|crossing| crossing.t)
    }
}

/// Squares of `size` m along two axes, the one at the origin in the first colour.
pub fn checker(
    axes: [DVec3; 2],
    size: f64,
    colors: [DVec3; 2],
) -> impl Fn(DVec3) -> DVec3 + Send + Sync {
    move |at| {
        let square = |axis: DVec3| (at.dot(axis) / size).floor();
        let odd = (square(axes[0]) + square(axes[1])).rem_euclid(2.0) == 1.0;
        colors[usize::from(odd)]
    }
}
