//! The order of the stages from splats to picture; all but the last run ahead of Bevy's main pass.

mod bevy_passes;
mod composite;
mod debug_view;
mod frame;
mod lighting;
mod motion;
mod normals;
mod refract;
mod scene_depth;
#[cfg(test)]
mod shader_tests;
mod smooth;
mod splat;
mod stacked;
mod surface;
#[cfg(all(test, feature = "published"))]
mod tests;
mod thickness;

use bevy::{
    core_pipeline::{
        Core3d, Core3dSystems,
        core_3d::{main_opaque_pass_3d, main_transparent_pass_3d},
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
    render::RenderApp,
};

pub use self::{
    frame::{Layers, TextureMemory, splats::GpuSplats, support::LayerBlending},
    refract::{ExitRay, SearchStatus, decode_normal, encode_normal},
    surface::{
        Surface, ViewSurfaces,
        plan::{MediumTerms, Plan, PlanInput, plan},
        reasons::{PlanReports, Skipped, SurfaceReport, ViewReport, Waiting, skipped},
    },
};

/// Names of the passes' time spans, in the order of the passes.
pub(crate) const SPANS: [&str; 9] = [
    scene_depth::SPAN,
    splat::SPAN,
    frame::tiles::SPAN,
    thickness::SPAN,
    smooth::SPAN,
    normals::SPAN,
    refract::SPAN,
    composite::SPAN,
    motion::SPAN,
];

/// The passes of a view, in [`Core3d`], for ordering other passes against them.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub enum FluidPasses {
    /// The opaque scene's nearest and farthest depths over the samples of each pixel are resolved.
    SceneDepth,
    /// Splats are drawn into layers.
    Splat,
    /// Path lengths through the particles are accumulated, if a material requires it.
    Thickness,
    /// The bulk's layers are smoothed.
    Smooth,
    /// Normals not written by smoothing are computed.
    Normals,
    /// Rays are traced through the layers.
    Refract,
    /// The liquid is composited over the opaque scene, and over glass and transparent objects behind
    /// it.
    Composite,
    /// The liquid's motion vectors are written, if the camera has a `MotionVectorPrepass`.
    Motion,
}

/// Draws fluids. Added by [`FluidPlugin`](crate::FluidPlugin).
pub(crate) struct FluidRenderPlugin {
    pub(crate) layer_blending: LayerBlending,
    pub(crate) shortcuts: bool,
}

impl Plugin for FluidRenderPlugin {
    fn build(&self, app: &mut App) {
        if app.get_sub_app(RenderApp).is_none() {
            // No shader is needed, and there may be no assets to hold them.
            app.init_resource::<PlanReports>()
                .init_resource::<TextureMemory>();
            return;
        }
        surface::plugin(app, self.shortcuts, frame::support::can_draw_fluids);
        frame::plugin(app, self.layer_blending);
        lighting::plugin(app);
        scene_depth::plugin(app);
        splat::plugin(app);
        thickness::plugin(app);
        smooth::plugin(app);
        normals::plugin(app);
        refract::plugin(app);
        composite::plugin(app);
        motion::plugin(app);
        debug_view::plugin(app);
        // After all that programs and Bevy do to cameras.
        app.add_systems(Last, stacked::share_targets);
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app.add_systems(
            Core3d,
            (
                (
                    scene_depth::scene_depth.in_set(FluidPasses::SceneDepth),
                    (splat::splat, frame::tiles::mark_tiles)
                        .chain()
                        .in_set(FluidPasses::Splat),
                    thickness::thickness.in_set(FluidPasses::Thickness),
                    smooth::smooth.in_set(FluidPasses::Smooth),
                    normals::normals.in_set(FluidPasses::Normals),
                    refract::refract.in_set(FluidPasses::Refract),
                )
                    .chain()
                    .after(Core3dSystems::Prepass)
                    .before(Core3dSystems::MainPass),
                (
                    composite::take_behind,
                    composite::composite,
                    debug_view::debug_view,
                )
                    .chain()
                    .in_set(FluidPasses::Composite)
                    .in_set(Core3dSystems::MainPass)
                    .after(main_opaque_pass_3d)
                    .before(main_transmissive_pass_3d)
                    .before(main_transparent_pass_3d),
                motion::motion
                    .in_set(FluidPasses::Motion)
                    .in_set(Core3dSystems::MainPass)
                    .after(FluidPasses::Composite)
                    // Glass writes depth as well.
                    .before(main_transmissive_pass_3d)
                    .before(main_transparent_pass_3d),
                composite::give_back
                    .in_set(Core3dSystems::MainPass)
                    .after(main_transmissive_pass_3d)
                    .after(main_transparent_pass_3d),
            ),
        );
        #[cfg(feature = "published")]
        render_app.add_systems(
            Core3d,
            smooth::average_normals
                .after(smooth::smooth)
                .in_set(FluidPasses::Smooth),
        );
    }

    fn finish(&self, app: &mut App) {
        if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
            bevy_passes::order(render_app);
        }
    }
}
