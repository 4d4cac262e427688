//! Published filters, for comparison: shaders and parameters.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
};

use super::steps::{SmoothKernel, radii};
use crate::settings::Smoothing;

/// For methods without a bound. Unit: particle radii.
const UNBOUND: f32 = 1e6;

pub(super) struct PublishedShaders {
    bilateral: Handle<Shader>,
    narrow_range: Handle<Shader>,
    curvature_flow: Handle<Shader>,
}

pub(super) fn embed_shaders(app: &mut App) {
    embedded_asset!(app, "bilateral.wgsl");
    embedded_asset!(app, "narrow_range.wgsl");
    embedded_asset!(app, "curvature_flow.wgsl");
    embedded_asset!(app, "average_normals.wgsl");
}

impl PublishedShaders {
    pub(super) fn load(world: &World) -> Self {
        Self {
            bilateral: load_embedded_asset!(world, "bilateral.wgsl"),
            narrow_range: load_embedded_asset!(world, "narrow_range.wgsl"),
            curvature_flow: load_embedded_asset!(world, "curvature_flow.wgsl"),
        }
    }

    /// The shader of a published kernel.
    pub(super) fn of(&self, kernel: SmoothKernel) -> &Handle<Shader> {
        match kernel {
            SmoothKernel::NarrowRows | SmoothKernel::NarrowColumns => &self.narrow_range,
            SmoothKernel::CurvatureFlow => &self.curvature_flow,
            _ => &self.bilateral,
        }
    }
}

/// Window, range and bound in radii, and the time step.
pub(super) fn parameters(smoothing: &Smoothing) -> (f32, f32, f32, f32) {
    let (window, range, step) = match *smoothing {
        // exp(−Δ² / 2σ²) is exp(−(Δ / √2σ)²).
        Smoothing::Bilateral(filter) => {
            let range = filter.range * core::f32::consts::SQRT_2;
            (radii(filter.window), range, 0.0)
        }
        Smoothing::NormalAverage(average) => (radii(average.window), 1.0, 0.0),
        Smoothing::NarrowRange(filter) => (radii(filter.window), filter.range, 0.0),
        Smoothing::CurvatureFlow(flow) => (0.0, flow.range, flow.step),
        Smoothing::None | Smoothing::PlaneFit(_) => (0.0, 1.0, 0.0),
    };
    (window, range, UNBOUND, step)
}
