//! Light on its way through a medium: the differential equation of the volume article, marched.
//!
//! `dC/dx = A − B C` per channel, where x runs from behind the medium to the eye, A is what a
//! metre sends and B what it takes.

use glam::DVec3;

/// What a metre of a medium does to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// What it sends (A), radiance per m.
    pub source: DVec3,
    /// The fraction that it takes (B), 1/m.
    pub extinction: DVec3,
}

impl Medium {
    /// Empty space.
    pub const NONE: Self = Self {
        source: DVec3::ZERO,
        extinction: DVec3::ZERO,
    };

    /// An evenly lit medium by the article's names: densities in 1/m, colours by channel, emission
    /// in radiance per m.
    pub fn new(
        [scattering_density, absorption_density]: [f64; 2],
        [scattering_color, absorption_color]: [DVec3; 2],
        emission: DVec3,
    ) -> Self {
        Self {
            source: scattering_density * scattering_color + emission,
            extinction: scattering_density + absorption_density * (1.0 - absorption_color),
        }
    }

    /// The light that comes through `length` metres of the medium, in closed form.
    pub fn through(&self, length: f64, behind: DVec3) -> DVec3 {
        let channel = |i: usize| {
            let (a, b) = (self.source[i], self.extinction[i]);
            let seen = if b == 0.0 {
                length
            } else {
                -(-b * length).exp_m1() / b
            };
            a * seen + (-b * length).exp() * behind[i]
        };
        DVec3::new(channel(0), channel(1), channel(2))
    }
}

/// The light that reaches the eye through `length` metres, in `steps` steps of the classical
/// Runge–Kutta method. `at` is the medium at a distance (m) from the eye; it may change on the way.
///
/// The error falls with the fourth power of the step where the medium is smooth, and with the
/// first where it jumps within one. Steps longer than 2.7 / B diverge.
pub fn march(at: impl Fn(f64) -> Medium, length: f64, behind: DVec3, steps: usize) -> DVec3 {
    let step = length / steps as f64;
    let slope = |t: f64, light: DVec3| {
        let medium = at(t);
        medium.source - medium.extinction * light
    };
    (0..steps).rev().fold(behind, |light, i| {
        // From the far end of the step towards the eye.
        let (far, near) = ((i + 1) as f64 * step, i as f64 * step);
        let middle = 0.5 * (far + near);
        let k1 = slope(far, light);
        let k2 = slope(middle, light + 0.5 * step * k1);
        let k3 = slope(middle, light + 0.5 * step * k2);
        let k4 = slope(near, light + step * k3);
        light + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    })
}
