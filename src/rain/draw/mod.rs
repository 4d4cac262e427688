//! From voxels to picture: a few items in Bevy's transparent phase for each view with rain.

mod buffers;
mod command;
mod extract;
mod gpu_types;
mod lattice;
mod lights;
mod pipeline;
mod prepare;
mod quads;
mod shelters;
#[cfg(test)]
mod tests;
mod view;

use bevy::{
    asset::embedded_asset,
    core_pipeline::{
        Core3d, Core3dSystems,
        core_3d::{
            Transparent3d, main_opaque_pass_3d, main_transparent_pass_3d,
            prepare_core_3d_depth_textures,
        },
    },
    pbr::main_transmissive_pass_3d,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_phase::{AddRenderCommand, sort_phase_system},
        render_resource::SpecializedRenderPipelines,
        sync_component::SyncComponentPlugin,
    },
    shader::load_shader_library,
};

pub use self::quads::RainQuads;
use super::{bake::LostDevices, settings::Rain};
use crate::{fog::FogShaderPlugin, render::FluidPasses};

/// It needs the renderer.
pub(crate) struct RainDrawPlugin;

impl Plugin for RainDrawPlugin {
    fn build(&self, app: &mut App) {
        FogShaderPlugin::add(app);
        load_shader_library!(app, "types.wgsl");
        load_shader_library!(app, "births.wgsl");
        load_shader_library!(app, "common.wgsl");
        embedded_asset!(app, "backdrop.wgsl");
        embedded_asset!(app, "billboards.wgsl");
        embedded_asset!(app, "drops.wgsl");
        app.add_plugins(SyncComponentPlugin::<Rain>::default());
        let lost_devices = app.world().resource::<LostDevices>().clone();
        let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
            return;
        };
        render_app
            .insert_resource(lost_devices)
            .init_resource::<extract::Shelters>()
            .init_gpu_resource::<SpecializedRenderPipelines<pipeline::RainPipeline>>()
            .add_render_command::<Transparent3d, command::DrawRain>()
            .add_systems(
                RenderStartup,
                (pipeline::init_rain_pipeline, buffers::init_rain_buffers),
            )
            .add_systems(
                ExtractSchedule,
                (extract::extract_rain, extract::extract_shelters),
            )
            .add_systems(
                Render,
                (
                    // After everything else is queued: rain is cut into shells only where it is not
                    // alone.
                    prepare::queue_rain
                        .in_set(RenderSystems::PhaseSort)
                        .before(sort_phase_system::<Transparent3d>),
                    prepare::allow_depth_copies
                        .in_set(RenderSystems::PrepareResources)
                        .before(prepare_core_3d_depth_textures),
                    prepare::prepare_rain.in_set(RenderSystems::PrepareResources),
                    prepare::prepare_rain_bind_groups.in_set(RenderSystems::PrepareBindGroups),
                ),
            )
            .add_systems(
                Core3d,
                (
                    // For what is drawn before the liquid.
                    command::copy_scene_depth_behind_liquid
                        .after(main_opaque_pass_3d)
                        .before(FluidPasses::Composite),
                    command::copy_scene_depth
                        .after(main_transmissive_pass_3d)
                        .after(FluidPasses::Composite)
                        .before(main_transparent_pass_3d),
                )
                    .in_set(Core3dSystems::MainPass),
            );
    }
}
