//! The motion of a collider during a step.

use bevy::{
    math::{Affine3A, Mat3A, Vec3A, bounding::Aabb3d},
    prelude::*,
};

use super::ParticleCollider;
use crate::source::solid::SolidShape;

/// Where a collider was at the end of the last frame.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(in crate::source::emitter) struct ColliderPath(Option<Pose>);

impl ColliderPath {
    /// The world is shifted.
    pub(in crate::source::emitter) fn shift(&mut self, by: Vec3) {
        if let Some(last) = &mut self.0 {
            last.translation += Vec3A::from(by);
        }
    }
}

/// Where a collider is, without its scale.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    rotation: Quat,
    translation: Vec3A,
}

impl Pose {
    fn to_world(self, point: Vec3A) -> Vec3A {
        self.rotation * point + self.translation
    }

    fn to_local(self, point: Vec3A) -> Vec3A {
        self.rotation.inverse() * (point - self.translation)
    }

    /// How far a point gets from here to there that is a metre from the axis of the turn.
    fn way_to(&self, to: &Self) -> f32 {
        self.translation.distance(to.translation) + self.rotation.angle_between(to.rotation)
    }
}

/// A collider in the world during a step.
#[derive(Debug)]
pub(in crate::source::emitter) struct Collider {
    pub(in crate::source::emitter) solid: SolidShape,
    pub(in crate::source::emitter) restitution: f32,
    pub(in crate::source::emitter) friction: f32,
    /// At the end of the step.
    world_from_local: Affine3A,
    local_from_world: Affine3A,
    /// From where to where it moves, if it does.
    path: Option<[Pose; 2]>,
    pub(super) reach: Reach,
}

/// Where a collider is within a step, roughly.
#[derive(Clone, Copy, Debug)]
pub(super) enum Reach {
    /// Below two planes, at the step's begin and end: normals, and heights along them.
    Below([(Vec3A, f32); 2]),
    Within(Aabb3d),
}

impl Collider {
    /// `None` for a transform that is not finite or has no rotation. If the way since the last step
    /// is longer than `farthest` (m), it has jumped and does not move.
    pub(super) fn new(
        collider: &ParticleCollider,
        transform: &GlobalTransform,
        path: &mut ColliderPath,
        farthest: f32,
    ) -> Option<Self> {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        if !(translation.is_finite() && rotation.is_normalized()) {
            // When it is there again, it has not come from where it was before.
            *path = ColliderPath::default();
            return None;
        }
        let to = Pose {
            rotation,
            translation: translation.into(),
        };
        let from = path.0.replace(to);
        let from = from.filter(|from| from == &to || from.way_to(&to) <= farthest);
        let from = from.unwrap_or(to);
        let solid = collider.shape.scaled(scale);
        let world_from_local = Affine3A::from_rotation_translation(rotation, translation);
        Some(Self {
            solid,
            restitution: collider.restitution,
            friction: collider.friction,
            world_from_local,
            local_from_world: world_from_local.inverse(),
            path: (from != to).then_some([from, to]),
            reach: Reach::new(&solid, [from, to]),
        })
    }

    /// A point in the collider's space after a part of the step.
    #[inline]
    pub(in crate::source::emitter) fn to_local(&self, part: f32, point: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.to_local(point),
            None => self.local_from_world.transform_point3a(point),
        }
    }

    /// A point of the collider in the world after a part of the step.
    #[inline]
    pub(in crate::source::emitter) fn to_world(&self, part: f32, point: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.to_world(point),
            None => self.world_from_local.transform_point3a(point),
        }
    }

    /// A direction of the collider in the world after a part of the step.
    #[inline]
    pub(in crate::source::emitter) fn turn(&self, part: f32, direction: Vec3A) -> Vec3A {
        match self.pose(part) {
            Some(pose) => pose.rotation * direction,
            None => self.world_from_local.transform_vector3a(direction),
        }
    }

    /// Where it is after a part of the step, on its way.
    fn pose(&self, part: f32) -> Option<Pose> {
        self.path.map(|[from, to]| Pose {
            rotation: from.rotation.lerp(to.rotation, part),
            translation: from.translation.lerp(to.translation, part),
        })
    }

    pub(in crate::source::emitter) fn moves(&self) -> bool {
        self.path.is_some()
    }

    /// How far a point of it, in its own space, gets in the step.
    #[inline]
    pub(in crate::source::emitter) fn way(&self, point: Vec3A) -> Vec3A {
        self.path.map_or(Vec3A::ZERO, |[from, to]| {
            to.to_world(point) - from.to_world(point)
        })
    }

    /// Whether a ball of `radius` may touch it on its straight path. Cheap: may be true for a miss,
    /// never false for a hit.
    #[inline]
    pub(in crate::source::emitter) fn is_near(
        &self,
        start: Vec3A,
        end: Vec3A,
        radius: f32,
    ) -> bool {
        match &self.reach {
            Reach::Below([(from, from_height), (to, to_height)]) => {
                (from.dot(start) - from_height).min(to.dot(end) - to_height) <= radius
            }
            Reach::Within(bounds) => overlaps(bounds, start, end, radius),
        }
    }
}

#[inline]
pub(super) fn overlaps(bounds: &Aabb3d, start: Vec3A, end: Vec3A, radius: f32) -> bool {
    let (low, high) = (start.min(end) - radius, start.max(end) + radius);
    (low.cmple(bounds.max) & high.cmpge(bounds.min)).all()
}

impl Reach {
    fn new(solid: &SolidShape, poses: [Pose; 2]) -> Self {
        let half_size = match *solid {
            SolidShape::Ground => {
                return Self::Below(poses.map(|pose| {
                    let normal = pose.rotation * Vec3A::Y;
                    (normal, normal.dot(pose.translation))
                }));
            }
            SolidShape::Sphere { radius } => Vec3A::splat(radius),
            SolidShape::Cuboid { half_size } => half_size.into(),
            SolidShape::Capsule {
                radius,
                half_length,
            } => Vec3A::new(radius, radius + half_length, radius),
            SolidShape::Cylinder {
                radius,
                half_height,
            } => Vec3A::new(radius, half_height, radius),
        };
        let [from, to] = poses.map(|pose| pose.translation);
        let reach = if poses[0].rotation == poses[1].rotation {
            let turned = Mat3A::from_quat(poses[0].rotation);
            turned.x_axis.abs() * half_size.x
                + turned.y_axis.abs() * half_size.y
                + turned.z_axis.abs() * half_size.z
        } else {
            // While it turns, it may reach as far as its corners.
            Vec3A::splat(half_size.length())
        };
        Self::Within(Aabb3d {
            min: from.min(to) - reach,
            max: from.max(to) + reach,
        })
    }
}
