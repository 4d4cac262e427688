//! How a particle flies, bounces, slides and comes to rest.
//!
//! Free flight under gravity and linear drag is the closed form, exact for steps of any length. What
//! is met on the way is found along the chord of the flight, so that nothing tunnels; the moment of
//! contact is then sought on the flight itself, so that a bounce has the right speed.

use bevy::math::Vec3A;

use super::colliders::{Collider, Colliders};

/// How often a particle may bounce in a step; what is left of the step then is lost to it.
const CONTACTS: usize = 4;
/// Nearer than this is touching. Unit: particle radii.
const TOUCH: f32 = 1e-3;

/// Gravity and linear drag.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forces {
    /// Unit: m/s².
    pub(super) gravity: Vec3A,
    /// Unit: 1/s.
    pub(super) drag: f32,
}

/// Free flight for some time: x + v·drift + g·fall, v·decay + g·drift.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    decay: f32,
    drift: f32,
    fall: f32,
    gravity: Vec3A,
}

impl Forces {
    /// Flight for `time` (s), from v' = g − drag·v.
    #[inline]
    pub(super) fn over(&self, time: f32) -> Flight {
        let r = self.drag * time;
        // (exp(−r) − 1 + r) / r², from which the others follow. The exact form loses its digits for
        // small r; the series is right to the last one there, and far faster.
        let second = if r < 0.5 {
            const SERIES: [f32; 7] = [
                1.0 / 40_320.0,
                -1.0 / 5040.0,
                1.0 / 720.0,
                -1.0 / 120.0,
                1.0 / 24.0,
                -1.0 / 6.0,
                0.5,
            ];
            SERIES.iter().fold(0.0, |sum, term| sum * r + term)
        } else {
            ((-r).exp_m1() + r) / (r * r)
        };
        let first = 1.0 - r * second;
        Flight {
            decay: 1.0 - r * first,
            drift: time * first,
            fall: time * time * second,
            gravity: self.gravity,
        }
    }
}

impl Flight {
    #[inline]
    pub(super) fn position(&self, position: Vec3A, velocity: Vec3A) -> Vec3A {
        position + velocity * self.drift + self.gravity * self.fall
    }

    #[inline]
    pub(super) fn velocity(&self, velocity: Vec3A) -> Vec3A {
        velocity * self.decay + self.gravity * self.drift
    }
}

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

/// Where a particle meets a collider.
#[derive(Clone, Copy)]
struct Contact<'a> {
    collider: &'a Collider,
    /// Of the way there.
    part: f32,
    /// The particle's centre.
    point: Vec3A,
    /// Out of the collider.
    normal: Vec3A,
    /// The collider's own velocity there.
    velocity: Vec3A,
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

    /// The first collider that a particle meets on its straight way to `end`, which takes the last
    /// `time` seconds of the step.
    fn first_contact(
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

    /// Flies to the contact and returns how long that takes. Seconds are sought by Newton's method,
    /// from those along the chord: where the flight meets the plane that touches there.
    fn approach(
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
            // Where it does not come nearer, the chord has to do.
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

    /// Whether the particle leaves the collider again, with its velocity after that; else only what
    /// is along the surface is left of it.
    fn bounce(&self, contact: &Contact, velocity: &mut Vec3A) -> bool {
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
        // What would fall back within a step rests.
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
    fn slide(&self, contact: &Contact, position: &mut Vec3A, velocity: &mut Vec3A, time: f32) {
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

    /// Pushes a particle out of what it is in at the end of the step: of what has been put over it,
    /// or what rounding has left.
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

    /// What f32 can tell apart here, and a small part of the radius. Unit: m.
    fn tolerance(&self, point: Vec3A) -> f32 {
        TOUCH * self.radius + 4.0 * f32::EPSILON * point.abs().max_element()
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
