//! The material of a fluid: refractive index, medium, roughness and thickness.

use bevy::prelude::*;

pub use crate::medium::Medium;
use crate::settings::{Checked, SettingRange, Settings};

/// The optical properties of a fluid.
///
/// Fluids with equal materials in one view form one surface: they merge on screen, unless a fluid of
/// another material lies between them.
///
/// Values out of range are logged once and clamped.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Checked<Self>)]
pub struct FluidMaterial {
    /// Refractive index relative to air. Range 0.2..=5, default 1.333 (water). Higher: rays bend
    /// more and more light is reflected. 1: no refraction or reflection, as in smoke and fire.
    #[reflect(@SettingRange::new(0.2, 5.0))]
    pub refractive_index: f32,
    /// The medium inside the fluid. Default: that of [`FluidMaterial::WATER`], which transmits
    /// seven tenths of the red light over a metre.
    pub medium: Medium,
    /// Perceptual roughness of the surface, for the specular highlights of lights. Range 0.03..=1,
    /// default 0.1. Higher: wider, dimmer highlights. Refractions stay sharp.
    #[reflect(@SettingRange::new(0.03, 1.0))]
    pub perceptual_roughness: f32,
    /// How a ray's path length through a fluid of refractive index 1 is measured. Fluids of other
    /// indices ignore it. Default: [`Thickness::Layers`].
    pub thickness: Thickness,
}

/// How a ray's path length through a fluid of refractive index 1 is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Thickness {
    /// From the front of the nearest particle to the back of the farthest, as if the liquid had no
    /// gaps. Cheap, and as smooth as the surface, but gaps between puffs count as filled.
    #[default]
    Layers,
    /// The sum of the path lengths through all particles, which takes one more pass over them.
    /// Every particle counts as the volume it fills at rest, (2r)³, whatever the shape of its
    /// splat, so nothing pops where particles disperse.
    Accumulated {
        /// How much a particle thins out towards its rim: its density is `(1 − q²)^softness`, where
        /// q is the distance from its centre relative to the splat. Range 0..=8, default 1. Higher:
        /// softer puffs. 0: uniform balls with a sharp rim.
        #[reflect(@SettingRange::new(0.0, 8.0))]
        softness: f32,
    },
}

impl Thickness {
    /// [`Thickness::Accumulated`] with soft rims.
    pub const SOFT: Self = Self::Accumulated { softness: 1.0 };
}

impl FluidMaterial {
    /// Clean water: red fades first, almost a third of it over a metre.
    pub const WATER: Self = Self {
        refractive_index: 1.333,
        medium: Medium {
            absorption_density: 0.4,
            absorption_color: LinearRgba::rgb(0.1, 0.75, 0.88),
            ..Medium::CLEAR
        },
        perceptual_roughness: 0.1,
        thickness: Thickness::Layers,
    };

    /// Water that absorbs nothing.
    pub const CLEAR_WATER: Self = Self {
        medium: Medium::CLEAR,
        ..Self::WATER
    };

    /// Thin blue ink.
    pub const INK: Self = Self {
        refractive_index: 1.34,
        medium: Medium {
            absorption_density: 12.0,
            absorption_color: LinearRgba::rgb(0.02, 0.25, 0.85),
            ..Medium::CLEAR
        },
        ..Self::WATER
    };

    /// Milk: a few millimetres hide the background.
    pub const MILK: Self = Self {
        refractive_index: 1.35,
        medium: Medium {
            scattering_density: 600.0,
            scattering_color: LinearRgba::rgb(0.95, 0.93, 0.86),
            ..Medium::CLEAR
        },
        ..Self::WATER
    };

    /// Honey: golden, strongly refracting.
    pub const HONEY: Self = Self {
        refractive_index: 1.49,
        medium: Medium {
            absorption_density: 9.0,
            absorption_color: LinearRgba::rgb(0.93, 0.62, 0.02),
            ..Medium::CLEAR
        },
        ..Self::WATER
    };

    /// Grey smoke: half a metre hides nine tenths of the background.
    pub const SMOKE: Self = Self {
        refractive_index: 1.0,
        medium: Medium {
            scattering_density: 3.0,
            scattering_color: LinearRgba::rgb(0.62, 0.63, 0.65),
            absorption_density: 1.6,
            absorption_color: LinearRgba::BLACK,
            ..Medium::CLEAR
        },
        thickness: Thickness::SOFT,
        ..Self::WATER
    };

    /// Fire: nearly transparent, with emission several times as bright as display white
    /// over 0.2 m.
    pub const FIRE: Self = Self {
        refractive_index: 1.0,
        medium: Medium {
            absorption_density: 0.5,
            absorption_color: LinearRgba::BLACK,
            emission: LinearRgba::rgb(25_000.0, 5_500.0, 500.0),
            ..Medium::CLEAR
        },
        thickness: Thickness::SOFT,
        ..Self::WATER
    };
}

impl Settings for FluidMaterial {}

impl Default for FluidMaterial {
    fn default() -> Self {
        Self::WATER
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_make_sense() {
        for preset in [
            FluidMaterial::WATER,
            FluidMaterial::CLEAR_WATER,
            FluidMaterial::INK,
            FluidMaterial::MILK,
            FluidMaterial::HONEY,
            FluidMaterial::SMOKE,
            FluidMaterial::FIRE,
        ] {
            assert_eq!(preset.validate(), Ok(()));
            assert_eq!(preset.clamped(), preset);
        }
    }

    #[test]
    fn bad_fields_are_named_and_clamped() {
        let cases: [(&str, fn(&mut FluidMaterial, f32)); 4] = [
            ("FluidMaterial::refractive_index", |m, v| {
                m.refractive_index = v;
            }),
            ("FluidMaterial::perceptual_roughness", |m, v| {
                m.perceptual_roughness = v;
            }),
            ("FluidMaterial::thickness.softness", |m, v| {
                m.thickness = Thickness::Accumulated { softness: v };
            }),
            ("FluidMaterial::medium.scattering_density", |m, v| {
                m.medium.scattering_density = v;
            }),
        ];
        for (field, set) in cases {
            for value in [-1.0, f32::NAN, f32::INFINITY] {
                let mut bad = FluidMaterial::SMOKE;
                set(&mut bad, value);
                let error = bad.validate().unwrap_err().to_string();
                assert!(
                    error.contains(field) && error.contains(&value.to_string()),
                    "{error}"
                );
                assert_eq!(bad.clamped().validate(), Ok(()));
            }
        }
    }
}
