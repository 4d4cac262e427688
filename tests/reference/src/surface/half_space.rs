//! Everything below a plane.

use glam::DVec3;

use super::{Crossing, Surface, crossing};
use crate::Ray;

/// The points on one side of a plane. Unbounded: good as an opaque floor or wall, not for layers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    /// A point of the plane, m.
    pub point: DVec3,
    /// Out of the body; unit length.
    pub normal: DVec3,
}

impl Surface for HalfSpace {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let t = self.normal.dot(self.point - ray.origin) / self.normal.dot(ray.direction);
        if t.is_finite() {
            out.push(crossing(ray, t, self.normal));
        }
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        (self.normal.dot(point - self.point) < 0.0).then_some(0)
    }
}
