//! The particles that an emitter emits in a step, whatever moves them afterwards.

use core::f32::consts::{PI, TAU};

use bevy::prelude::*;

use super::ParticleEmitter;
use crate::random::Random;

/// A particle that comes into being within a step. In the world's space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Birth {
    /// Where it is born. Unit: m.
    pub(crate) position: Vec3,
    /// Its number among all of the emitter's particles, from 0 again after the last.
    pub(crate) id: u32,
    /// Its velocity at birth. Unit: m/s.
    pub(crate) velocity: Vec3,
    /// How old it is at the end of the step, and so for how long it has yet to be moved within it.
    /// Unit: s.
    pub(crate) age: f32,
}

/// An emitter's state between one step and the next.
///
/// Emission is deterministic: the k-th particle is born at the same time, with the same random
/// numbers, at any frame rate. It does not depend on what becomes of the particles.
#[derive(Component, Clone, Copy, Debug, Default)]
pub(crate) struct Emission {
    /// The part of a particle that the rate has already yielded, 0..1.
    owed: f64,
    /// How many have been born, and the number of the next one.
    born: u64,
    /// Where the emitter was at the end of the last step.
    last: Option<Pose>,
}

impl Emission {
    /// Calls `birth` for each particle of a step of `seconds` that ends with the emitter at `to`,
    /// oldest first, those of a burst last. It is to be called in every frame, to follow the
    /// emitter's path; nothing is born while no time passes.
    ///
    /// They are spread along the way there, unless that is a jump: longer than at `fastest` (m/s).
    /// Nothing is born where the transform is not finite or has no rotation, as with a scale of 0.
    /// `emitter` comes from [`ParticleEmitter::take`]. If more would be born than its capacity,
    /// only the last ones are.
    pub(crate) fn emit(
        &mut self,
        emitter: &ParticleEmitter,
        to: &GlobalTransform,
        seconds: f64,
        fastest: f32,
        mut birth: impl FnMut(Birth),
    ) {
        let from = core::mem::replace(&mut self.last, Pose::new(to));
        let Some(to) = self.last.filter(|_| seconds > 0.0) else {
            return;
        };
        let farthest = fastest * seconds as f32;
        let from = from.filter(|from| !from.jumps_to(&to, farthest));
        let from = from.unwrap_or(to);
        let nozzle = Nozzle::new(emitter);
        let rate = if emitter.enabled {
            f64::from(emitter.rate)
        } else {
            0.0
        };
        let owed = self.owed;
        let total = owed + rate * seconds;
        let steady = total as u64;
        let all = steady + u64::from(emitter.pending_burst);
        for number in all.saturating_sub(u64::from(emitter.capacity))..all {
            // Those of a burst are born where the emitter is now.
            let time = if number < steady {
                (((number + 1) as f64 - owed) / rate).clamp(0.0, seconds)
            } else {
                seconds
            };
            let pose = from.towards(&to, (time / seconds) as f32);
            let number = self.born.wrapping_add(number);
            let (position, velocity) = nozzle.particle(&pose, number);
            birth(Birth {
                position,
                id: number as u32,
                velocity,
                age: (seconds - time) as f32,
            });
        }
        self.born = self.born.wrapping_add(all);
        self.owed = total.fract();
    }

    /// The world is shifted.
    pub(super) fn shift(&mut self, by: Vec3) {
        if let Some(last) = &mut self.last {
            last.translation += by;
        }
    }

    /// The emitter has been put elsewhere: nothing is spread along the way there.
    pub(super) fn forget_place(&mut self) {
        self.last = None;
    }
}

/// An emitter's place.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    /// What is left of the transform without the rotation: scale, and the shear of a hierarchy.
    stretch: Mat3,
    rotation: Quat,
    translation: Vec3,
}

impl Pose {
    fn new(transform: &GlobalTransform) -> Option<Self> {
        let (_, rotation, translation) = transform.to_scale_rotation_translation();
        let rotation = rotation.normalize();
        let matrix = Mat3::from(transform.affine().matrix3);
        let stretch = Mat3::from_quat(rotation.inverse()) * matrix;
        let is_sound = stretch.is_finite() && rotation.is_finite() && translation.is_finite();
        is_sound.then_some(Self {
            stretch,
            rotation,
            translation,
        })
    }

    /// Whether there is no way from here to there: it is longer than `farthest` (m), or one of the
    /// two is mirrored or turned over, as by a scale that passes zero.
    fn jumps_to(&self, to: &Self, farthest: f32) -> bool {
        let is_mirrored = |pose: &Self| pose.stretch.determinant() < 0.0;
        self.translation.distance(to.translation) > farthest
            || is_mirrored(self) != is_mirrored(to)
            || self.rotation.angle_between(to.rotation) > 0.75 * PI
    }

    /// A part of the way from here to there.
    fn towards(&self, to: &Self, part: f32) -> Self {
        if self == to {
            return *to;
        }
        Self {
            stretch: self.stretch + (to.stretch - self.stretch) * part,
            rotation: self.rotation.slerp(to.rotation, part),
            translation: self.translation.lerp(to.translation, part),
        }
    }

    fn vector(&self, vector: Vec3) -> Vec3 {
        self.rotation * (self.stretch * vector)
    }
}

/// The opening that emits particles, in the emitter's space.
struct Nozzle {
    /// Across the direction, across it again, and along it.
    axes: Mat3,
    radius: f32,
    /// One minus the cosine of the cone's half angle.
    opening: f32,
    speed: f32,
    jitter: f32,
    seed: u64,
}

impl Nozzle {
    fn new(emitter: &ParticleEmitter) -> Self {
        let direction = emitter.direction.normalize_or(Vec3::Y);
        let (side, other) = direction.any_orthonormal_pair();
        Self {
            axes: Mat3::from_cols(side, other, direction),
            radius: emitter.nozzle_radius,
            // 1 − cos would lose the small angles of jets.
            opening: 2.0 * (0.5 * emitter.cone_half_angle).sin().powi(2),
            speed: emitter.speed,
            jitter: emitter.jitter,
            seed: emitter.seed,
        }
    }

    /// The place and the velocity of the particle of this number.
    fn particle(&self, pose: &Pose, number: u64) -> (Vec3, Vec3) {
        let mut random = Random::sequence(self.seed, number);
        let mut next = || random.next_f64() as f32;
        let offset = Vec2::from_angle(TAU * next()) * (self.radius * next().sqrt());
        let place = self.axes * offset.extend(0.0);
        let direction = self.axes * within_cap(self.opening, next(), next());
        let jitter = within_cap(2.0, next(), next()) * (self.jitter * next().cbrt());
        let direction = pose.vector(direction).normalize_or_zero();
        (
            pose.translation + pose.vector(place),
            direction * self.speed + jitter,
        )
    }
}

/// A direction distributed evenly over the cap of this height around +z of the unit sphere, from
/// two numbers from 0 to 1.
fn within_cap(height: f32, u: f32, v: f32) -> Vec3 {
    let down = height * u;
    // sin² = 1 − (1 − down)².
    let across = (down * (2.0 - down)).max(0.0).sqrt();
    (Vec2::from_angle(TAU * v) * across).extend(1.0 - down)
}
