//! Free flight under gravity and linear drag: the closed form, exact for steps of any length.

use bevy::math::Vec3A;

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
