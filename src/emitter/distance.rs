//! How far a point is from a solid, and where a way into it begins.
//!
//! All solids are convex. The distance along a straight way is then a convex function, and Newton's
//! method from outside comes to its first root without ever passing it: the plane that it steps to
//! has all of the solid behind it. So one distance each is all that a shape needs, and nothing
//! tunnels.

use bevy::math::Vec3;

/// A convex solid in its own space. Lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    /// All that is below y = 0.
    HalfSpace,
    Sphere {
        radius: f32,
    },
    Cuboid {
        half_size: Vec3,
    },
    /// About the y axis.
    Capsule {
        radius: f32,
        half_length: f32,
    },
}

/// Ways flatter than this along a surface do not lead into it.
const GRAZE: f32 = 1e-4;
/// Newton's steps double the right digits, but at a graze, where they halve the distance.
const STEPS: usize = 24;

impl Solid {
    /// The signed distance of a point from the surface, negative inside, and its gradient.
    pub(super) fn distance(&self, point: Vec3) -> (f32, Vec3) {
        match *self {
            Self::HalfSpace => (point.y, Vec3::Y),
            Self::Sphere { radius } => ball(point, radius),
            Self::Capsule {
                radius,
                half_length,
            } => {
                let along = point.y.clamp(-half_length, half_length);
                ball(point - along * Vec3::Y, radius)
            }
            Self::Cuboid { half_size } => {
                let beyond = point.abs() - half_size;
                let side = Vec3::ONE.copysign(point);
                let depth = beyond.max_element();
                if depth > 0.0 {
                    let out = beyond.max(Vec3::ZERO);
                    let distance = out.length();
                    return (distance, side * out / distance);
                }
                let axis = match beyond {
                    b if b.x == depth => Vec3::X,
                    b if b.y == depth => Vec3::Y,
                    _ => Vec3::Z,
                };
                (depth, side * axis)
            }
        }
    }

    /// The part of `way` from `start` after which a ball of `radius` meets the solid, if it does:
    /// where they are nearer than `tolerance` and come nearer.
    pub(super) fn sweep(&self, start: Vec3, way: Vec3, radius: f32, tolerance: f32) -> Option<f32> {
        let flattest = -GRAZE * way.length();
        let mut part = 0.0;
        for _ in 0..STEPS {
            let (distance, normal) = self.distance(start + part * way);
            let (gap, slope) = (distance - radius, normal.dot(way));
            // Not so for NaN either.
            if !(slope < flattest) {
                return None;
            }
            if gap <= tolerance {
                return Some(part);
            }
            part -= gap / slope;
            if part > 1.0 {
                return None;
            }
        }
        Some(part)
    }
}

fn ball(point: Vec3, radius: f32) -> (f32, Vec3) {
    let distance = point.length();
    let normal = if distance > 0.0 {
        point / distance
    } else {
        Vec3::Y
    };
    (distance - radius, normal)
}
