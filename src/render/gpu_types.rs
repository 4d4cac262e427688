//! The Rust twins of `types.wgsl`: the same fields under the same names.

use bevy::{prelude::*, render::render_resource::ShaderType};

use super::smooth::window_radii;
use crate::{
    material::{FluidMaterial, Thickness},
    settings::{ScreenSpaceFluid, Search, Smoothing},
};

/// Directional lights that give highlights; further ones are left out.
pub(crate) const MAX_LIGHTS: usize = 4;

/// Transform and particle radius of a fluid.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuFluid {
    pub(crate) world_from_local: Mat4,
    pub(crate) radius: f32,
}

/// A light that gives highlights.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuDirectionalLight {
    pub(crate) direction_to_light: Vec3,
    pub(crate) illuminance: Vec3,
}

/// Appearance of a body in a view.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuBody {
    pub(crate) environment_from_world: Mat3,
    pub(crate) clear_color: Vec3,
    pub(crate) environment_intensity: f32,
    pub(crate) extinction: Vec3,
    pub(crate) refractive_index: f32,
    pub(crate) lights: [GpuDirectionalLight; MAX_LIGHTS],
    pub(crate) perceptual_roughness: f32,
    pub(crate) radius: f32,
    pub(crate) window_radii: f32,
    pub(crate) range: f32,
    pub(crate) bound: f32,
    pub(crate) flow_step: f32,
    pub(crate) coarse_samples: u32,
    pub(crate) contact: f32,
    pub(crate) scattering: Vec3,
    pub(crate) emission: Vec3,
    pub(crate) even_light: Vec3,
    pub(crate) diffuse_intensity: f32,
    pub(crate) softness: f32,
    pub(crate) behind: Vec4,
}

/// For methods without a bound.
const UNBOUND: f32 = 1e6;

impl GpuBody {
    /// A body of particles of `radius` (view units); invalid values are replaced by safe ones.
    /// Lights, surroundings and emission are left dark.
    pub(crate) fn new(
        material: &FluidMaterial,
        radius: f32,
        settings: &ScreenSpaceFluid,
        smoothing: &Smoothing,
    ) -> Self {
        let positive = |value: f32, fallback: f32| {
            if value.is_finite() && value > 0.0 {
                value
            } else {
                fallback
            }
        };
        let (window, range, bound) = match *smoothing {
            Smoothing::None => (0.0, 1.0, 0.0),
            Smoothing::PlaneFit(fit) => (
                window_radii(fit.window),
                fit.range.clamp(0.5, 4.0),
                fit.bound,
            ),
            // exp(−Δ² / 2σ²) is exp(−(Δ / √2σ)²).
            Smoothing::Bilateral(filter) => (
                window_radii(filter.window),
                filter.range * core::f32::consts::SQRT_2,
                UNBOUND,
            ),
            Smoothing::NormalAverage(average) => (window_radii(average.window), 1.0, UNBOUND),
            Smoothing::NarrowRange(filter) => (window_radii(filter.window), filter.range, UNBOUND),
            Smoothing::CurvatureFlow(flow) => (0.0, flow.range, UNBOUND),
        };
        let flow_step = match *smoothing {
            Smoothing::CurvatureFlow(flow) => positive(flow.step, 0.4).clamp(0.01, 0.5),
            _ => 0.0,
        };
        Self {
            extinction: material.medium.extinction(),
            scattering: material.medium.scattered(),
            softness: match material.thickness {
                Thickness::Layers => 0.0,
                Thickness::Accumulated { softness } => softness,
            },
            refractive_index: positive(material.refractive_index, 1.0).clamp(0.2, 5.0),
            perceptual_roughness: positive(material.perceptual_roughness, 0.1).clamp(0.03, 1.0),
            radius,
            window_radii: window,
            range: positive(range, 2.0).clamp(0.5, 20.0) * radius,
            bound: positive(bound, 2.0).max(0.1) * radius,
            flow_step,
            coarse_samples: match settings.search {
                Search::Secant => 0,
                Search::Bracketed { coarse_samples } => coarse_samples.min(32),
            },
            contact: positive(settings.contact, 0.0).min(8.0) * radius,
            ..default()
        }
    }

    /// Converts the values per metre for a view whose metres are `view_scale` times the world's.
    pub(crate) fn scale_lengths(&mut self, view_scale: f32) {
        self.extinction /= view_scale;
        self.scattering /= view_scale;
        self.emission /= view_scale;
    }
}

/// How a search for the next interface ended, as stored per ray (`STATUS_…` in `types.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum SearchStatus {
    /// No search was made.
    None = 0,
    /// The interface was found.
    Hit = 1,
    /// The ray meets no further interface.
    NoBracket = 2,
    /// The ray left the layer's silhouette before it crossed the layer.
    LeftLayer = 3,
    /// There was no valid sample to search in.
    Invalid = 4,
    /// Total internal reflection at the interface that was found.
    TotalReflection = 5,
    /// The evaluations ran out before the tolerance was reached.
    Budget = 6,
    /// The ray met an opaque surface first.
    Opaque = 7,
}

impl SearchStatus {
    /// All statuses, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Hit,
        Self::NoBracket,
        Self::LeftLayer,
        Self::Invalid,
        Self::TotalReflection,
        Self::Budget,
        Self::Opaque,
    ];
}
