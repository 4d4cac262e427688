//! What a fluid is made of.

use bevy::prelude::*;

use crate::medium::Medium;

/// The optical properties of a fluid. Fluids of a view whose materials are equal form one body:
/// they merge on screen.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct FluidMaterial {
    /// Refractive index relative to air. Range 0.2..=5, default 1.333 (water).
    /// Higher: rays bend more and more light is reflected; 1: neither.
    pub refractive_index: f32,
    /// What is inside.
    pub medium: Medium,
    /// Perceptual roughness of the surface for the highlights of lights. Range 0.03..=1,
    /// default 0.1. Higher: wider, dimmer highlights. Refractions stay sharp.
    pub perceptual_roughness: f32,
}

impl FluidMaterial {
    /// Clean water: red fades first, almost a third of it over a metre.
    pub const WATER: Self = Self {
        refractive_index: 1.333,
        medium: Medium {
            absorption_density: 0.4,
            absorption_color: LinearRgba::rgb(0.1, 0.75, 0.88),
        },
        perceptual_roughness: 0.1,
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
        },
        perceptual_roughness: 0.1,
    };

    /// Honey: golden, strongly refracting.
    pub const HONEY: Self = Self {
        refractive_index: 1.49,
        medium: Medium {
            absorption_density: 9.0,
            absorption_color: LinearRgba::rgb(0.93, 0.62, 0.02),
        },
        perceptual_roughness: 0.1,
    };
}

impl Default for FluidMaterial {
    fn default() -> Self {
        Self::WATER
    }
}
