//! What is inside a fluid: how light fades on its way through.

use bevy::prelude::*;

/// Extinction (1/m) beyond which nothing differs. GPUs take powers of 2, and f32's largest numbers
/// times log₂ e are infinite, which over no distance is not a number.
const DENSEST: f32 = 1e30;

/// A homogeneous medium that absorbs light.
///
/// Along a path of length `d` metres the fraction `exp(-B d)` of each channel is left, with
/// `B = density · (1 − color)` (Beer–Lambert; the absorption terms `α_A` and `C_A` of the volume
/// article).
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct Medium {
    /// How densely the medium is filled with absorbing matter. Unit: 1/m, range 0.., default 0.
    /// Higher: light fades over a shorter way.
    pub absorption_density: f32,
    /// The colour that the absorbing matter lets pass, linear, each channel 0..=1, default white
    /// (nothing is absorbed).
    pub absorption_color: LinearRgba,
}

impl Medium {
    /// Lets all light through.
    pub const CLEAR: Self = Self {
        absorption_density: 0.0,
        absorption_color: LinearRgba::WHITE,
    };

    /// The medium that leaves `color` of white light after `distance` metres.
    ///
    /// Channels are clamped to 0.001..=1, so that no channel asks for an infinite density;
    /// a distance that is not positive gives [`Medium::CLEAR`].
    pub fn absorbing(color: impl Into<LinearRgba>, distance: f32) -> Self {
        if !(distance > 0.0 && distance.is_finite()) {
            return Self::CLEAR;
        }
        let color = color.into();
        let extinction = color.to_vec3().map(|kept| -kept.clamp(1e-3, 1.0).ln()) / distance;
        let density = extinction.max_element();
        if density <= 0.0 {
            return Self::CLEAR;
        }
        let kept = Vec3::ONE - extinction / density;
        Self {
            absorption_density: density,
            absorption_color: LinearRgba::rgb(kept.x, kept.y, kept.z),
        }
    }

    /// Extinction `B` per channel. Unit: 1/m. Values that make no sense count as none.
    pub fn extinction(&self) -> Vec3 {
        let density = if self.absorption_density.is_finite() {
            self.absorption_density.max(0.0)
        } else {
            0.0
        };
        self.absorption_color.to_vec3().map(|kept| {
            let kept = if kept.is_finite() { kept } else { 1.0 };
            (density * (1.0 - kept.clamp(0.0, 1.0))).min(DENSEST)
        })
    }

    /// The fraction of light per channel that is left after `distance` metres.
    pub fn transmitted(&self, distance: f32) -> Vec3 {
        // Finite, because 0 · ∞ is not a number.
        let distance = distance.clamp(0.0, f32::MAX);
        self.extinction().map(|b| (-b * distance).exp())
    }
}

impl Default for Medium {
    fn default() -> Self {
        Self::CLEAR
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absorbing_leaves_the_colour_after_the_distance() {
        let color = LinearRgba::rgb(0.2, 0.5, 0.9);
        let left = Medium::absorbing(color, 3.0).transmitted(3.0);
        assert!((left - color.to_vec3()).length() < 1e-6, "{left}");
    }

    #[test]
    fn clear_and_senseless_media_let_all_light_through() {
        let odd = Medium {
            absorption_density: f32::NAN,
            absorption_color: LinearRgba::rgb(f32::NAN, -1.0, 2.0),
        };
        for medium in [Medium::CLEAR, Medium::absorbing(LinearRgba::RED, -1.0), odd] {
            for distance in [0.0, 1.0, f32::INFINITY] {
                assert_eq!(medium.transmitted(distance), Vec3::ONE);
            }
        }
    }
}
