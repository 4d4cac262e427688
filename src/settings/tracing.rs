//! Ray tracing through the liquid: refractions, interface search and Fresnel reflectance.

use bevy::prelude::*;

use super::SettingRange;

/// Maximum number of interfaces between liquid and air that a ray crosses (or is totally reflected
/// at).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Refractions {
    /// No refraction: reflection and absorption along the straight line only.
    Zero,
    /// Only the first surface refracts; absorption is that of the straight ray.
    One,
    /// Into the liquid and out of it.
    Two,
    /// Into the liquid, out of it, into the other class (spray behind bulk, bulk behind spray) and
    /// out of that.
    #[default]
    Four,
}

impl Refractions {
    /// The number of interfaces.
    pub const fn count(self) -> u32 {
        match self {
            Self::Zero => 0,
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }
}

/// How the next interface along a ray is found in a depth layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Search {
    /// The thesis's secant (3.12), halving the distance while a sample is invalid.
    Secant,
    /// An expanding bracket, then Anderson–Björck steps; at most eight evaluations.
    Bracketed {
        /// Evenly spaced samples taken first, to find the first of several crossings.
        /// Range 0..=32, default 0. More: fewer wrong crossings at steps in depth.
        #[reflect(@SettingRange::new(0.0, 32.0).unit("samples").initial(0.0))]
        coarse_samples: u32,
    },
}

impl Search {
    /// The default: bracketed, without coarse samples.
    pub const BRACKETED: Self = Self::Bracketed { coarse_samples: 0 };
}

impl Default for Search {
    fn default() -> Self {
        Self::BRACKETED
    }
}

/// How the Fresnel reflectance of an interface is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Fresnel {
    /// The Fresnel equations for dielectrics and unpolarised light.
    #[default]
    Exact,
    /// Schlick's approximation; rays from inside use the angle outside. Up to 0.06 off for water.
    Schlick,
}
