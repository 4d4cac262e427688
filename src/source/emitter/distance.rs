//! The distance of a point from a solid, and where a path enters it.
//!
//! All solids are convex. The distance along a straight way is then a convex function, and Newton's
//! method from outside comes to its first root without ever passing it: the plane that it steps to
//! has all of the solid behind it. So each shape needs only a distance, and nothing tunnels.

use bevy::math::Vec3A;

use crate::source::solid::SolidShape;

/// Ways flatter than this along a surface do not lead into it.
const GRAZE: f32 = 1e-4;
/// Newton's steps double the correct digits, except at a graze, where they halve the distance.
const STEPS: usize = 24;

impl SolidShape {
    /// The signed distance of a point from the surface, negative inside, and its gradient.
    pub(super) fn distance(&self, point: Vec3A) -> (f32, Vec3A) {
        match *self {
            Self::Ground => (point.y, Vec3A::Y),
            Self::Sphere { radius } => ball(point, radius),
            Self::Capsule {
                radius,
                half_length,
            } => {
                let along = point.y.clamp(-half_length, half_length);
                ball(point - along * Vec3A::Y, radius)
            }
            Self::Cylinder {
                radius,
                half_height,
            } => {
                let along = Vec3A::Y * 1_f32.copysign(point.y);
                let axis_to_point = Vec3A::new(point.x, 0.0, point.z);
                let out = axis_to_point.normalize_or(Vec3A::X);
                let across = axis_to_point.length() - radius;
                let above = point.y.abs() - half_height;
                let distance = across.hypot(above);
                match (across > 0.0, above > 0.0) {
                    (true, true) => (distance, (across * out + above * along) / distance),
                    _ if across > above => (across, out),
                    _ => (above, along),
                }
            }
            Self::Cuboid { half_size } => {
                let beyond = point.abs() - Vec3A::from(half_size);
                let side = Vec3A::ONE.copysign(point);
                let depth = beyond.max_element();
                if depth > 0.0 {
                    let out = beyond.max(Vec3A::ZERO);
                    let distance = out.length();
                    return (distance, side * out / distance);
                }
                let axis = match beyond {
                    b if b.x == depth => Vec3A::X,
                    b if b.y == depth => Vec3A::Y,
                    _ => Vec3A::Z,
                };
                (depth, side * axis)
            }
        }
    }

    /// The part of `way` from `start` after which a ball of `radius` meets the solid, if it does:
    /// where they are nearer than `tolerance` and come nearer.
    pub(super) fn sweep(
        &self,
        start: Vec3A,
        way: Vec3A,
        radius: f32,
        tolerance: f32,
    ) -> Option<f32> {
        let flattest = -GRAZE * way.length();
        let mut part = 0.0;
        for _ in 0..STEPS {
            let (distance, normal) = self.distance(start + part * way);
            let (gap, slope) = (distance - radius, normal.dot(way));
            if slope >= flattest || slope.is_nan() {
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

fn ball(point: Vec3A, radius: f32) -> (f32, Vec3A) {
    let distance = point.length();
    let normal = if distance > 0.0 {
        point / distance
    } else {
        Vec3A::Y
    };
    (distance - radius, normal)
}
