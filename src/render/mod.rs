//! The render passes from splats to picture; all but the last run ahead of Bevy's main pass.

mod bind_groups;
mod bindings;
mod bodies;
mod bounds;
pub(crate) mod composite;
mod exit;
mod extract;
mod gpu_types;
mod grouping;
mod layers;
mod lighting;
mod normals;
mod pipelines;
mod plan;
mod refract;
mod scene_depth;
mod scene_textures;
#[cfg(test)]
mod shader_tests;
mod skipped;
mod smooth;
mod splat;
mod support;
#[cfg(test)]
mod tests;
mod thickness;

use bevy::{
    asset::embedded_asset,
    core_pipeline::{
        Core3d, Core3dSystems,
        core_3d::{main_opaque_pass_3d, main_transparent_pass_3d},
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        extract_component::ExtractComponentPlugin, render_resource::SpecializedRenderPipelines,
        sync_component::SyncComponentPlugin,
    },
    shader::load_shader_library,
};

pub use self::{
    bodies::{Body, ViewBodies},
    exit::{ExitRay, decode_normal, encode_normal},
    extract::{ExtractedFluid, GpuSplats, ViewSurroundings},
    gpu_types::SearchStatus,
    layers::Layers,
    plan::{MediumTerms, Plan, PlanInput, plan},
    skipped::{BodyReport, PlanReports, Skipped, ViewReport, skipped},
    support::LayerBlending,
};
use crate::{
    settings::{FluidDebugView, ScreenSpaceFluid},
    source::particles::FluidParticles,
};

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
    /// The liquid is composited over the opaque scene.
    Composite,
}

/// Draws fluids. Added by [`FluidPlugin`](crate::FluidPlugin).
pub(crate) struct FluidRenderPlugin {
    pub(crate) layer_blending: LayerBlending,
    pub(crate) shortcuts: bool,
}

impl Plugin for FluidRenderPlugin {
    fn build(&self, app: &mut App) {
        load_shader_library!(app, "types.wgsl");
        load_shader_library!(app, "bindings.wgsl");
        load_shader_library!(app, "functions.wgsl");
        load_shader_library!(app, "straight.wgsl");
        load_shader_library!(app, "track.wgsl");
        load_shader_library!(app, "slopes.wgsl");
        load_shader_library!(app, "medium.wgsl");
        load_shader_library!(app, "optics.wgsl");
        load_shader_library!(app, "splat/ellipsoid.wgsl");
        load_shader_library!(app, "smooth/window.wgsl");
        load_shader_library!(app, "refract/inside.wgsl");
        load_shader_library!(app, "refract/layers.wgsl");
        load_shader_library!(app, "refract/search.wgsl");
        embedded_asset!(app, "scene_depth/resolve.wgsl");
        embedded_asset!(app, "splat/splat.wgsl");
        embedded_asset!(app, "splat/merge.wgsl");
        embedded_asset!(app, "thickness/thickness.wgsl");
        embedded_asset!(app, "smooth/plane_fit.wgsl");
        embedded_asset!(app, "smooth/plane_fit_tls.wgsl");
        embedded_asset!(app, "smooth/bilateral.wgsl");
        embedded_asset!(app, "smooth/narrow_range.wgsl");
        embedded_asset!(app, "smooth/curvature_flow.wgsl");
        embedded_asset!(app, "normals/average_normals.wgsl");
        embedded_asset!(app, "normals/depth_normals.wgsl");
        embedded_asset!(app, "normals/splat_normals.wgsl");
        embedded_asset!(app, "refract/refract.wgsl");
        embedded_asset!(app, "composite/composite.wgsl");
        embedded_asset!(app, "composite/debug_view.wgsl");
        let reports = PlanReports::default();
        app.insert_resource(reports.clone());

        // Synced components need a renderer, if only to be despawned.
        if app.get_sub_app(RenderApp).is_some() {
            app.add_plugins((
                ExtractComponentPlugin::<ScreenSpaceFluid>::default(),
                ExtractComponentPlugin::<FluidDebugView>::default(),
                SyncComponentPlugin::<FluidParticles>::default(),
            ));
        }
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(reports)
            .insert_resource(support::WantedBlending(self.layer_blending))
            .insert_resource(support::Shortcuts(self.shortcuts))
            .init_resource::<extract::FluidLights>()
            .init_gpu_resource::<bodies::FluidUniforms>()
            .init_gpu_resource::<SpecializedRenderPipelines<splat::SplatPipeline>>()
            .init_gpu_resource::<SpecializedRenderPipelines<thickness::ThicknessPipeline>>()
            .init_gpu_resource::<SpecializedRenderPipelines<smooth::SmoothPipeline>>()
            .init_gpu_resource::<SpecializedRenderPipelines<normals::NormalsPipeline>>()
            .init_gpu_resource::<SpecializedRenderPipelines<refract::RefractPipeline>>()
            .init_gpu_resource::<SpecializedRenderPipelines<composite::CompositePipeline>>()
            .add_systems(
                RenderStartup,
                (
                    support::init_support,
                    extract::forget_buffers,
                    scene_textures::init_placeholders,
                    scene_depth::init_scene_depth_pipelines,
                    (
                        splat::init_splat_pipeline,
                        (
                            thickness::init_thickness_pipeline,
                            normals::init_normals_pipeline,
                        ),
                    )
                        .chain(),
                    smooth::init_smooth_pipeline,
                    refract::init_refract_pipeline,
                    composite::init_composite_pipeline,
                ),
            )
            .add_systems(
                ExtractSchedule,
                (extract::extract_fluids, extract::extract_lights),
            )
            .add_systems(
                Render,
                (
                    (
                        extract::upload_splats,
                        bodies::prepare_fluids,
                        bodies::prepare_bodies,
                    )
                        .chain()
                        .in_set(RenderSystems::PrepareResources)
                        .after(bevy::render::view::prepare_view_uniforms),
                    (
                        bind_groups::prepare_splat_bind_groups,
                        bind_groups::prepare_body_bind_groups,
                    )
                        .in_set(RenderSystems::PrepareBindGroups),
                ),
            )
            // The passes, in order.
            .add_systems(
                Core3d,
                (
                    (
                        scene_depth::scene_depth.in_set(FluidPasses::SceneDepth),
                        (splat::splat, splat::overdraw)
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
                    composite::composite
                        .in_set(FluidPasses::Composite)
                        .in_set(Core3dSystems::MainPass)
                        .after(main_opaque_pass_3d)
                        .after(main_transmissive_pass_3d)
                        .before(main_transparent_pass_3d),
                ),
            );
    }
}
