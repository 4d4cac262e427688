//! A ball.

use glam::DVec3;

use super::{Crossing, Figure, Nearest, Surface};
use crate::Ray;

/// A ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Middle, m.
    pub center: DVec3,
    /// Radius, m.
    pub radius: f64,
}

impl Surface for Sphere {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let middle = ray.direction.dot(self.center - ray.origin);
        // From the centre to the closest approach: no large numbers cancel.
        let closest = ray.at(middle) - self.center;
        let half_squared = self.radius * self.radius - closest.length_squared();
        if half_squared > 0.0 {
            let half = half_squared.sqrt();
            out.extend(
                [(-half, true), (half, false)].map(|(from_middle, entering)| Crossing {
                    t: middle + from_middle,
                    normal: (closest + from_middle * ray.direction) / self.radius,
                    entering,
                    body: 0,
                }),
            );
        }
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        (point.distance(self.center) < self.radius).then_some(0)
    }

    fn nearest(&self, point: DVec3) -> Option<Nearest> {
        let out = point - self.center;
        Some(Nearest {
            distance: out.length() - self.radius,
            normal: out.normalize_or(DVec3::Y),
        })
    }

    fn figures(&self) -> Vec<Figure> {
        vec![Figure::Sphere(*self)]
    }
}
