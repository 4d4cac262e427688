//! Interpolation between two frames.

use std::cmp::Ordering;

use bevy::prelude::*;

use super::frame::ParticleFrame;
use crate::source::particles::FluidParticles;

/// The frame in the order of its ids, so that two can be walked through side by side. If an id
/// occurs twice, all ids are dropped, and the order stays the file's.
pub(super) fn in_order_of_ids(mut frame: ParticleFrame) -> ParticleFrame {
    let ids = &frame.ids;
    if ids.is_sorted_by(|a, b| a < b) {
        return frame;
    }
    let mut order: Vec<_> = (0..ids.len()).collect();
    order.sort_unstable_by_key(|&index| ids[index]);
    if order.windows(2).any(|pair| ids[pair[0]] == ids[pair[1]]) {
        frame.ids.clear();
        return frame;
    }
    let vectors = |from: &[Vec3]| match from {
        [] => Vec::new(),
        _ => order.iter().map(|&index| from[index]).collect(),
    };
    ParticleFrame {
        positions: vectors(&frame.positions),
        velocities: vectors(&frame.velocities),
        ids: order.iter().map(|&index| ids[index]).collect(),
        radius: frame.radius,
    }
}

/// The moment between two frames in the order of their ids.
pub(super) struct Between<'a> {
    pub(super) before: &'a ParticleFrame,
    pub(super) after: &'a ParticleFrame,
    /// How far from the one to the other, from 0 to 1.
    pub(super) share: f32,
    /// From the one to the other. Unit: s.
    pub(super) seconds: f32,
    /// Whether velocities count.
    pub(super) by_velocity: bool,
    /// Recorded seconds per second, which velocities are written with.
    pub(super) rate: f32,
}

impl Between<'_> {
    /// Writes the particles in the order of the ids. A particle that only one of the frames has is
    /// there in the half that is nearer to it. Velocities are written if the frames have some.
    pub(super) fn write(&self, particles: &mut FluidParticles) {
        particles.positions.clear();
        particles.velocities.clear();
        particles.ids.clear();
        let (before, after) = (self.before, self.after);
        let have_velocities = !before.velocities.is_empty() && !after.velocities.is_empty();
        let mut write = |id: u32, (position, velocity): (Vec3, Vec3)| {
            particles.positions.push(position);
            particles.ids.push(id);
            if have_velocities {
                particles.velocities.push(velocity * self.rate);
            }
        };
        let (mut a, mut b) = (0, 0);
        while a < before.ids.len() || b < after.ids.len() {
            let id = |frame: &ParticleFrame, at: usize| {
                frame.ids.get(at).map_or(u64::MAX, |&id| id.into())
            };
            let order = id(before, a).cmp(&id(after, b));
            match order {
                Ordering::Equal => write(before.ids[a], self.both(a, b)),
                Ordering::Less if self.share < 0.5 => {
                    write(before.ids[a], self.one(before, a, self.share));
                }
                Ordering::Greater if self.share >= 0.5 => {
                    write(after.ids[b], self.one(after, b, self.share - 1.0));
                }
                _ => {}
            }
            a += usize::from(order.is_le());
            b += usize::from(order.is_ge());
        }
    }

    fn velocity(&self, frame: &ParticleFrame, at: usize) -> Option<Vec3> {
        let velocity = frame.velocities.get(at).copied()?;
        (self.by_velocity && velocity.is_finite()).then_some(velocity)
    }

    /// A particle of only one frame, extrapolated with its velocity there.
    fn one(&self, frame: &ParticleFrame, at: usize, share: f32) -> (Vec3, Vec3) {
        let velocity = self.velocity(frame, at).unwrap_or_default();
        let way = velocity * (share * self.seconds);
        (frame.positions[at] + way, velocity)
    }

    /// The cubic with these positions and velocities at its ends, or the line; and its slope.
    fn both(&self, a: usize, b: usize) -> (Vec3, Vec3) {
        let (from, to) = (self.before.positions[a], self.after.positions[b]);
        let velocities = (self.velocity(self.before, a), self.velocity(self.after, b));
        let mean = (to - from) / self.seconds;
        let (Some(start), Some(end)) = velocities else {
            return (from.lerp(to, self.share), mean);
        };
        let (t, rest) = (self.share, 1.0 - self.share);
        let line = from + (to - from) * (t * t * (3.0 - 2.0 * t));
        let position = line + (start * (t * rest * rest) - end * (t * t * rest)) * self.seconds;
        let velocity = mean * (6.0 * t * rest)
            + start * (rest * (1.0 - 3.0 * t))
            + end * (t * (3.0 * t - 2.0));
        (position, velocity)
    }
}
