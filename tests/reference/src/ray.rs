//! Rays and the angle between directions.

use glam::{DAffine3, DVec3};

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, in m.
    pub origin: DVec3,
    /// Where it goes; unit length.
    pub direction: DVec3,
}

impl Ray {
    /// From a point along a direction of any length but zero.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let direction = direction.normalize();
        Self { origin, direction }
    }

    /// The point at a distance `t` (m).
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// The same ray in other coordinates. The direction keeps the map's scale, so that distances
    /// stay what they were.
    pub(crate) fn seen_from(&self, map: &DAffine3) -> Self {
        Self {
            origin: map.transform_point3(self.origin),
            direction: map.transform_vector3(self.direction),
        }
    }
}

/// Degrees between two vectors, exact for small angles too.
pub fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}
