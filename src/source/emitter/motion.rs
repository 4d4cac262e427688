//! The motion of a particle during a step.
//!
//! Contacts are found along the chord of the flight, so that nothing tunnels; the time of contact
//! is then solved on the flight itself, so that a bounce has the right speed.

use bevy::math::Vec3A;

use super::{
    colliders::Colliders,
    flight::{Flight, Forces},
};

/// The most bounces of a particle in a step; after them the rest of the step is dropped.
const CONTACTS: usize = 4;
/// Nearer than this is touching. Unit: particle radii.
const TOUCH: f32 = 1e-3;

/// What is the same for all particles of an emitter in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<'a> {
    pub(super) forces: Forces,
    /// Unit: s, > 0.
    pub(super) seconds: f32,
    pub(super) colliders: &'a Colliders,
    /// Of the particles, in the world. Unit: m.
    pub(super) radius: f32,
}

impl Step<'_> {
    /// Moves a particle by `flight`, which takes `time` (s), to the end of the step.
    #[inline]
    pub(super) fn advance(
        &self,
        position: &mut Vec3A,
        velocity: &mut Vec3A,
        flight: &Flight,
        time: f32,
    ) {
        let end = flight.position(*position, *velocity);
        if self.colliders.any_near(*position, end, self.radius) {
            self.collide(position, velocity, *flight, time);
        } else {
            *velocity = flight.velocity(*velocity);
            *position = end;
        }
    }

    /// The same where something may be in the way.
    fn collide(
        &self,
        position: &mut Vec3A,
        velocity: &mut Vec3A,
        mut flight: Flight,
        mut time: f32,
    ) {
        if self.rests(*position, *velocity) {
            return;
        }
        for _ in 0..CONTACTS {
            let end = flight.position(*position, *velocity);
            let Some(contact) = self.first_contact(*position, end, time, None) else {
                *velocity = flight.velocity(*velocity);
                *position = end;
                break;
            };
            time -= self.approach(&contact, position, velocity, time);
            if !self.bounce(&contact, velocity) {
                self.slide(&contact, position, velocity, time);
                break;
            }
            flight = self.forces.over(time);
        }
        self.push_out(position, velocity);
    }

    /// Whether a particle lies still on something that holds it, with nothing near that moves: then
    /// it stays where it is.
    fn rests(&self, position: Vec3A, velocity: Vec3A) -> bool {
        if velocity != Vec3A::ZERO {
            return false;
        }
        let mut is_held = false;
        for collider in self.colliders.list() {
            if !collider.is_near(position, position, self.radius) {
                continue;
            }
            if collider.moves() {
                return false;
            }
            let (distance, normal) = collider.solid.distance(collider.to_local(1.0, position));
            let normal = collider.turn(1.0, normal);
            let weight = -self.forces.gravity.dot(normal);
            let pull = self.forces.gravity + normal * weight;
            let gap = distance - self.radius;
            if gap < 0.0 {
                return false;
            }
            is_held |= gap <= self.tolerance(position)
                && weight > 0.0
                && pull.length_squared() <= (collider.friction * weight).powi(2);
        }
        is_held
    }

    /// Pushes a particle out of solids that it is in at the end of the step: because one was put
    /// over it, or by rounding.
    fn push_out(&self, position: &mut Vec3A, velocity: &mut Vec3A) {
        for _ in 0..2 {
            let mut is_pushed = false;
            for collider in self.colliders.list() {
                if !collider.is_near(*position, *position, self.radius) {
                    continue;
                }
                let point = collider.to_local(1.0, *position);
                let (distance, normal) = collider.solid.distance(point);
                let depth = self.radius - distance;
                if depth > 0.0 {
                    is_pushed = true;
                    let own = collider.way(point - distance * normal) / self.seconds;
                    let normal = collider.turn(1.0, normal);
                    *position += depth * normal;
                    *velocity -= normal * normal.dot(*velocity - own).min(0.0);
                }
            }
            if !is_pushed {
                break;
            }
        }
    }

    /// The resolution of f32 here, and a small part of the radius. Unit: m.
    pub(super) fn tolerance(&self, point: Vec3A) -> f32 {
        TOUCH * self.radius + 4.0 * f32::EPSILON * point.abs().max_element()
    }
}
