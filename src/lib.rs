//! Particle liquids for Bevy, with up to four refractions in screen space.

pub mod material;
pub mod medium;
pub mod particles;
pub mod render;
pub mod schedule;
pub mod settings;
pub mod shape;

use bevy::prelude::*;

pub use crate::{
    material::FluidMaterial,
    medium::Medium,
    particles::{FluidParticles, ShapedFluid},
    render::LayerBlending,
    schedule::FluidSystems,
    settings::{
        Bilateral, FluidDebugView, Fresnel, PlaneFit, PlaneFitForm, Refractions, ScreenSpaceFluid,
        Search, Smoothing, Window,
    },
    shape::SurfaceKernel,
};

/// What most programs need.
pub mod prelude {
    pub use crate::{
        FluidMaterial, FluidParticles, FluidPlugin, FluidSystems, Medium, ScreenSpaceFluid,
        SurfaceKernel,
    };
}

/// Shapes and draws particle fluids.
#[derive(Clone, Copy, Debug, Default)]
pub struct FluidPlugin {
    /// How the depth layers are drawn; leave it at its default unless you test adapters.
    pub layer_blending: LayerBlending,
}

impl Plugin for FluidPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins((
            schedule::plugin,
            particles::plugin,
            render::FluidRenderPlugin {
                layer_blending: self.layer_blending,
            },
        ));
    }
}
