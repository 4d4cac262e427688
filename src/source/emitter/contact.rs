//! The contact of a particle with a collider: it bounces, slides or stops.

use bevy::math::Vec3A;

use super::{
    colliders::Collider,
    flight::{Flight, Forces},
    motion::Step,
};

/// Where a particle meets a collider.
#[derive(Clone, Copy)]
pub(super) struct Contact<'a> {
    pub(super) collider: &'a Collider,
    /// Of the way there.
    pub(super) part: f32,
    /// The particle's centre.
    pub(super) point: Vec3A,
    /// Out of the collider.
    pub(super) normal: Vec3A,
    /// The collider's own velocity there.
    pub(super) velocity: Vec3A,
}

impl Step<'_> {
    /// The first collider that a particle meets on its straight way to `end`, which takes the last
    /// `time` seconds of the step.
    pub(super) fn first_contact(
        &self,
        start: Vec3A,
        end: Vec3A,
        time: f32,
        except: Option<&Collider>,
    ) -> Option<Contact<'_>> {
        let tolerance = self.tolerance(start);
        let begin = 1.0 - time / self.seconds;
        let mut first: Option<Contact<'_>> = None;
        for collider in self.colliders.list() {
            if except.is_some_and(|except| core::ptr::eq(except, collider))
                || !collider.is_near(start, end, self.radius)
            {
                continue;
            }
            // In the collider's space, which moves.
            let from = collider.to_local(begin, start);
            let way = collider.to_local(1.0, end) - from;
            let Some(part) = collider.solid.sweep(from, way, self.radius, tolerance) else {
                continue;
            };
            if first.is_some_and(|first| first.part <= part) {
                continue;
            }
            let point = from + part * way;
            let (_, normal) = collider.solid.distance(point);
            let then = begin + part * (1.0 - begin);
            first = Some(Contact {
                collider,
                part,
                point: collider.to_world(then, point),
                normal: collider.turn(then, normal),
                velocity: collider.way(point - self.radius * normal) / self.seconds,
            });
        }
        first
    }

    /// Flies to the contact and returns how long that takes. The time is found by Newton's method,
    /// starting with that along the chord: where the flight meets the tangent plane of the contact.
    pub(super) fn approach(
        &self,
        contact: &Contact,
        position: &mut Vec3A,
        velocity: &mut Vec3A,
        time: f32,
    ) -> f32 {
        if contact.part == 0.0 {
            return 0.0;
        }
        let along_chord = contact.part * time;
        let mut needed = along_chord;
        let mut flight = self.forces.over(needed);
        let gap = |needed: f32, flight: &Flight| {
            let plane = contact.point + contact.velocity * (needed - along_chord);
            contact
                .normal
                .dot(flight.position(*position, *velocity) - plane)
        };
        for _ in 0..3 {
            let speed = contact
                .normal
                .dot(flight.velocity(*velocity) - contact.velocity);
            let correction = gap(needed, &flight) / speed;
            // Where it does not come nearer, the chord is used instead.
            if !(speed < 0.0 && correction.abs() < time) {
                break;
            }
            needed = (needed - correction).clamp(0.0, time);
            flight = self.forces.over(needed);
        }
        let rest = gap(needed, &flight);
        *position = flight.position(*position, *velocity) - contact.normal * rest;
        *velocity = flight.velocity(*velocity);
        needed
    }

    /// Whether the particle leaves the collider again. Sets its velocity after the bounce; without
    /// one, only the part along the surface is left.
    pub(super) fn bounce(&self, contact: &Contact, velocity: &mut Vec3A) -> bool {
        let Contact {
            collider, normal, ..
        } = contact;
        let relative = *velocity - contact.velocity;
        let speed = normal.dot(relative);
        let along = relative - normal * speed;
        let rebound = if speed < 0.0 {
            -collider.restitution * speed
        } else {
            speed
        };
        let along = less(along, collider.friction * (rebound - speed));
        // A particle that would fall back within a step rests.
        let weight = -self.forces.gravity.dot(*normal);
        let leaves = 2.0 * rebound > weight * self.seconds;
        *velocity = contact.velocity + along;
        if leaves {
            *velocity += normal * rebound;
        }
        leaves
    }

    /// Slides along the plane of contact for the last `time` seconds of the step, slowed down by
    /// friction, or rests.
    pub(super) fn slide(
        &self,
        contact: &Contact,
        position: &mut Vec3A,
        velocity: &mut Vec3A,
        time: f32,
    ) {
        let Contact {
            collider, normal, ..
        } = contact;
        let weight = -self.forces.gravity.dot(*normal);
        let friction = collider.friction * weight.max(0.0);
        let along = Forces {
            gravity: self.forces.gravity + normal * weight,
            ..self.forces
        };
        let before = *velocity - contact.velocity;
        let free = along.over(time).velocity(before);
        let after = less(free, friction * time);
        let moving = if after == Vec3A::ZERO {
            // It stops on the way, slowed down evenly.
            let (speed, braking) = (before.length(), (free - before).length());
            let slowdown = if free.length() < speed {
                friction + braking / time
            } else {
                friction - braking / time
            };
            (speed / slowdown.max(f32::MIN_POSITIVE)).min(time)
        } else {
            time
        };
        let end = *position + (before + after) * (0.5 * moving) + contact.velocity * time;
        *velocity = contact.velocity + after;
        *position = match self.first_contact(*position, end, time, Some(*collider)) {
            None => end,
            Some(other) => {
                let speed = other.normal.dot(*velocity - other.velocity);
                *velocity -= other.normal * speed.min(0.0);
                other.point
            }
        };
    }
}

/// A velocity slowed down by `speed`, to rest at most.
fn less(velocity: Vec3A, speed: f32) -> Vec3A {
    let length = velocity.length();
    if length > speed {
        velocity * (1.0 - speed / length)
    } else {
        Vec3A::ZERO
    }
}
