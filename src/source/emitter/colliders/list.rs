//! Colliders and their lookup.

use bevy::{
    math::{Vec3A, bounding::Aabb3d},
    prelude::*,
    transform::helper::TransformHelper,
};

use super::{
    ParticleCollider,
    moving::{Collider, ColliderPath, Reach, overlaps},
};
use crate::settings::Checked;

/// All colliders during a step.
#[derive(Debug)]
pub(in crate::source::emitter) struct Colliders {
    /// Half-spaces first.
    list: Vec<Collider>,
    half_spaces: usize,
    /// Around all others.
    bounds: Aabb3d,
}

impl Default for Colliders {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            half_spaces: 0,
            bounds: NOWHERE,
        }
    }
}

/// An empty box.
const NOWHERE: Aabb3d = Aabb3d {
    min: Vec3A::INFINITY,
    max: Vec3A::NEG_INFINITY,
};

impl Colliders {
    /// Collects all colliders of this step. What gets farther in it than `farthest` (m) has jumped.
    pub(in crate::source::emitter) fn gather(
        &mut self,
        colliders: &mut Query<(Entity, &Checked<ParticleCollider>, &mut ColliderPath)>,
        transforms: &TransformHelper,
        farthest: f32,
    ) {
        self.list.clear();
        self.half_spaces = 0;
        self.bounds = NOWHERE;
        for (entity, collider, mut path) in colliders {
            let transform = transforms.compute_global_transform(entity).ok();
            let collider =
                transform.and_then(|at| Collider::new(collider, &at, &mut path, farthest));
            let Some(collider) = collider else {
                continue;
            };
            let reach = collider.reach;
            self.list.push(collider);
            match reach {
                Reach::Below(_) => {
                    let last = self.list.len() - 1;
                    self.list.swap(self.half_spaces, last);
                    self.half_spaces += 1;
                }
                Reach::Within(bounds) => {
                    self.bounds.min = self.bounds.min.min(bounds.min);
                    self.bounds.max = self.bounds.max.max(bounds.max);
                }
            }
        }
    }

    pub(in crate::source::emitter) fn list(&self) -> &[Collider] {
        &self.list
    }

    /// Whether a ball of `radius` may touch any collider on its straight path. May be true for a
    /// miss, never false for a hit.
    #[inline]
    pub(in crate::source::emitter) fn any_near(
        &self,
        start: Vec3A,
        end: Vec3A,
        radius: f32,
    ) -> bool {
        let is_near = |collider: &Collider| collider.is_near(start, end, radius);
        let (half_spaces, others) = self.list.split_at(self.half_spaces);
        half_spaces.iter().any(is_near)
            || overlaps(&self.bounds, start, end, radius) && others.iter().any(is_near)
    }
}
