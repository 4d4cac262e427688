//! What a fluid is made of.

mod check;

use bevy::prelude::*;

pub use check::MaterialError;
pub(crate) use check::plugin;

use crate::{medium::Medium, range::SettingRange};

/// The optical properties of a fluid. Fluids of a view whose materials are equal form one body:
/// they merge on screen, unless one of another material lies between them.
///
/// Values out of their range are said once in the log and drawn as the nearest that is in range.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
pub struct FluidMaterial {
    /// Refractive index relative to air. Range 0.2..=5, default 1.333 (water).
    /// Higher: rays bend more and more light is reflected; 1: neither, as in smoke and fire.
    #[reflect(@SettingRange::new(0.2, 5.0))]
    pub refractive_index: f32,
    /// What is inside.
    pub medium: Medium,
    /// Perceptual roughness of the surface for the highlights of lights. Range 0.03..=1,
    /// default 0.1. Higher: wider, dimmer highlights. Refractions stay sharp.
    #[reflect(@SettingRange::new(0.03, 1.0))]
    pub perceptual_roughness: f32,
    /// How the length of a ray's way through a fluid of refractive index 1 is found. Others
    /// ignore it. Default: [`Thickness::Layers`].
    pub thickness: Thickness,
}

/// How the length of a ray's way through a fluid of refractive index 1 is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Thickness {
    /// From the front of the nearest particle to the back of the farthest: a body without gaps.
    /// Cheap, and smooth with its surface; but gaps between puffs count as full.
    #[default]
    Layers,
    /// The sum over all particles of the way through each, in one more pass over all of them.
    /// Every particle counts as the volume that it fills at rest, (2r)³, however its splat is
    /// shaped, so nothing pops where the particles disperse.
    Accumulated {
        /// How far a particle thins out towards its rim: its density is `(1 − q²)^softness` over
        /// the distance q from its centre, relative to the splat. Range 0..=8, default 1.
        /// Higher: softer puffs; 0: even balls with a sharp rim.
        #[reflect(@SettingRange::new(0.0, 8.0))]
        softness: f32,
    },
}

impl Thickness {
    /// Accumulated, with soft rims.
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

    /// Milk: a few millimetres hide what is behind.
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

    /// Grey smoke: half a metre hides nine tenths.
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

    /// Fire: 0.2 m of it are some times as bright as what is shown white, and nearly clear.
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

impl Default for FluidMaterial {
    fn default() -> Self {
        Self::WATER
    }
}
