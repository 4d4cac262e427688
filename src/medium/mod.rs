//! The medium inside a fluid: absorption, scattering and emission of light.

#[cfg(test)]
mod tests;

use core::ops::Add;

use bevy::prelude::*;

use crate::settings::{SettingRange, Settings};

/// Largest density (1/m) and emission (cd/m² per metre), so that squares and products with lengths
/// stay finite.
const MOST: f64 = 1e12;

/// Largest extinction (1/m), far beyond any visible difference. GPUs compute exp with powers of 2:
/// f32's largest numbers times log₂ e are infinite, and infinity times a distance of 0 is NaN.
const DENSEST: f32 = 1e30;

/// A homogeneous, evenly lit medium that scatters, absorbs and emits light.
///
/// Per channel, with the extinction `B = α_D + α_A (1 − C_A)`, a path of `d` metres transmits the
/// fraction `f_T = exp(-B d)` of the light from behind and adds the in-scattered and emitted light
/// `f_R = (C_D α_D L + C_E) (1 − exp(-B d)) / B`. This is the volume article's closed form; `L` is
/// the surrounding light. Consecutive segments compose in order, so cutting a path anywhere changes
/// nothing.
///
/// The article assumes that the same light reaches every point inside. `L` is therefore the mean
/// over all directions of the light that falls on the scene: directional lights (a quarter of their
/// illuminance over π), the camera's [`EnvironmentMapLight`] and the ambient light. The medium does
/// not shadow itself, and point and spot lights are ignored.
///
/// Media are mixed with `+`.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct Medium {
    /// Density of the matter that scatters light evenly in all directions (`α_D`). Unit: 1/m, range
    /// 0..=1e12, default 0. Higher: more like milk.
    #[reflect(@SettingRange::new(0.0, 1000.0).unit("1/m").logarithmic().valid(0.0, MOST))]
    pub scattering_density: f32,
    /// The colour of the scattering matter in white light (`C_D`), linear, each channel 0..=1,
    /// default white. Light that is not scattered is absorbed.
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub scattering_color: LinearRgba,
    /// Density of the absorbing matter (`α_A`). Unit: 1/m, range 0..=1e12, default 0. Higher: light
    /// fades over a shorter distance.
    #[reflect(@SettingRange::new(0.0, 1000.0).unit("1/m").logarithmic().valid(0.0, MOST))]
    pub absorption_density: f32,
    /// The colour that the absorbing matter transmits (`C_A`), linear, each channel 0..=1, default
    /// white (nothing is absorbed).
    #[reflect(@SettingRange::new(0.0, 1.0))]
    pub absorption_color: LinearRgba,
    /// Emission: light emitted by the medium itself (`C_E`). Unit: cd/m² per metre of depth, each
    /// channel 0..=1e12, default black. Higher: brighter; with Bevy's default exposure, white begins at
    /// about 1000 cd/m².
    #[reflect(@SettingRange::new(0.0, 1e5).unit("cd/m³").logarithmic().valid(0.0, MOST))]
    pub emission: LinearRgba,
}

impl Medium {
    /// A medium that neither scatters, absorbs nor emits light.
    pub const CLEAR: Self = Self {
        scattering_density: 0.0,
        scattering_color: LinearRgba::WHITE,
        absorption_density: 0.0,
        absorption_color: LinearRgba::WHITE,
        emission: LinearRgba::BLACK,
    };

    /// Returns [`Medium::CLEAR`].
    pub const fn clear() -> Self {
        Self::CLEAR
    }

    /// The absorbing medium that turns white light into `color` after `distance` metres.
    ///
    /// Channels are clamped to 0.001..=1, so that no density is infinite; a distance that is not
    /// positive gives [`Medium::CLEAR`].
    pub fn absorbing(color: impl Into<LinearRgba>, distance: f32) -> Self {
        if !is_length(distance) {
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
            ..Self::CLEAR
        }
    }

    /// The scattering medium that has `color` in white light where it is deep, and hides half of
    /// the background after `distance` metres.
    ///
    /// A distance that is not positive gives [`Medium::CLEAR`].
    pub fn scattering(color: impl Into<LinearRgba>, distance: f32) -> Self {
        if !is_length(distance) {
            return Self::CLEAR;
        }
        Self {
            scattering_density: core::f32::consts::LN_2 / distance,
            scattering_color: color.into(),
            ..Self::CLEAR
        }
    }

    /// The emitting medium that hides nothing and adds `luminance` (cd/m², per channel) over a
    /// depth of `distance` metres.
    ///
    /// A distance that is not positive gives [`Medium::CLEAR`].
    pub fn emitting(luminance: impl Into<LinearRgba>, distance: f32) -> Self {
        if !is_length(distance) {
            return Self::CLEAR;
        }
        Self {
            emission: opaque(luminance.into().to_vec3() / distance),
            ..Self::CLEAR
        }
    }

    /// Extinction `B` per channel. Unit: 1/m. Values out of range are clamped.
    pub fn extinction(&self) -> Vec3 {
        let it = self.clamped();
        let extinction = it.scattering_density
            + it.absorption_density * (Vec3::ONE - it.absorption_color.to_vec3());
        extinction.min(Vec3::splat(DENSEST))
    }

    /// In-scattered light and emission per metre of depth, before extinction: `C_D α_D L + C_E` per
    /// channel. `light` is the mean luminance L (cd/m²) of the surrounding light.
    pub fn source(&self, light: Vec3) -> Vec3 {
        let it = self.clamped();
        it.scattered() * light + it.emission.to_vec3()
    }

    /// The fraction of light per channel that is transmitted over `distance` metres: `f_T`.
    pub fn transmitted(&self, distance: f32) -> Vec3 {
        let distance = finite(distance);
        self.extinction().map(|b| (-b * distance).exp())
    }

    /// In-scattered light and emission of `distance` metres in even `light` (cd/m², per channel):
    /// `f_R`.
    pub fn reflected(&self, distance: f32, light: Vec3) -> Vec3 {
        let distance = finite(distance);
        let lengths = self.extinction().map(|b| seen_length(b, distance));
        (self.source(light) * lengths).min(Vec3::MAX)
    }

    /// In-scattered light per metre, in units of the surrounding light: `C_D α_D`.
    pub(crate) fn scattered(&self) -> Vec3 {
        self.scattering_density * self.scattering_color.to_vec3()
    }
}

impl Settings for Medium {}

impl Default for Medium {
    fn default() -> Self {
        Self::CLEAR
    }
}

/// Both media in the same place, each with its own density.
impl Add for Medium {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (scattering_density, scattering_color) = mixed(
            [self.scattering_density, other.scattering_density],
            [self.scattering_color, other.scattering_color],
        );
        let (absorption_density, absorption_color) = mixed(
            [self.absorption_density, other.absorption_density],
            [self.absorption_color, other.absorption_color],
        );
        Self {
            scattering_density,
            scattering_color,
            absorption_density,
            absorption_color,
            emission: opaque(self.emission.to_vec3() + other.emission.to_vec3()),
        }
    }
}

/// Mixes two kinds of matter; their colours are weighted by density.
fn mixed([a, b]: [f32; 2], [of_a, of_b]: [LinearRgba; 2]) -> (f32, LinearRgba) {
    let share = if b > 0.0 { b / (a + b) } else { 0.0 };
    (a + b, opaque(of_a.to_vec3().lerp(of_b.to_vec3(), share)))
}

/// The length of a path without extinction that adds as much light as `distance` does with it:
/// `(1 − exp(-x)) / B` with `x = B d`. Its twin is `seen_length` in `medium.wgsl`.
///
/// As printed, the formula is 0/0 without extinction and loses digits near it; below x = 0.5 the
/// series `d Σ (-x)^k / (k + 1)!` is used instead.
fn seen_length(extinction: f32, distance: f32) -> f32 {
    let x = extinction * distance;
    if x >= 0.5 {
        return (1.0 - (-x).exp()) / extinction;
    }
    // Horner's rule: 1 − x/2 (1 − x/3 (1 − x/4 …)).
    let series = (2..=8).rev().fold(1.0, |sum, k| 1.0 - x / k as f32 * sum);
    distance * series
}

fn is_length(distance: f32) -> bool {
    distance.is_finite() && distance > 0.0
}

/// A finite length, because 0 · ∞ is NaN; NaN itself counts as 0.
fn finite(distance: f32) -> f32 {
    if distance > 0.0 {
        distance.min(f32::MAX)
    } else {
        0.0
    }
}

fn opaque(color: Vec3) -> LinearRgba {
    LinearRgba::rgb(color.x, color.y, color.z)
}
