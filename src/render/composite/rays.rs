//! More rays through the pixels of liquid whose neighbours part.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedComputePipelineId,
            ComputePassDescriptor, ComputePipelineDescriptor, PipelineCache, ShaderStages,
            SpecializedComputePipeline, SpecializedComputePipelines, StorageTextureAccess,
            binding_types::texture_storage_2d,
        },
        renderer::RenderContext,
    },
    shader::ShaderDefVal,
};

use super::{scene::SceneColorLayout, shade::ShadeKey};
use crate::{
    render::{
        frame::{
            Frame, FrameLayout, FrameStartup, Gpu, Group, Input, Layers, Placeholder,
            RADIANCE_FORMAT,
            pipelines::{tile_size, unfiltered},
        },
        lighting::{LightingLayout, ViewLighting},
        refract::RefractKey,
        surface::{Surface, SurfaceSystems, Variant, reasons::Waiting},
    },
    settings::Antialiasing,
};

const LABEL: &str = "fluid_rays";

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RaysKey {
    /// Through each of those pixels, besides the first.
    pub(crate) count: u32,
    pub(crate) refract: RefractKey,
    pub(crate) background: ShadeKey,
}

impl RaysKey {
    /// `None` without rays. Accumulated media have none, whose thickness would be in the place of the
    /// light.
    pub(crate) fn of(variant: &Variant) -> Option<Self> {
        match variant.plan.antialiasing {
            Antialiasing::Full { rays: count } if count > 0 => Some(Self {
                count,
                refract: RefractKey::new(&variant.plan, &variant.settings),
                background: ShadeKey::of(variant),
            }),
            _ => None,
        }
    }
}

#[derive(Resource)]
pub(crate) struct RaysPipeline {
    layouts: [BindGroupLayoutDescriptor; 4],
    shader: Handle<Shader>,
}

/// What a surface needs for its rays.
#[derive(Component, Default)]
pub(crate) struct Rays {
    pipeline: Option<CachedComputePipelineId>,
    group: Group,
}

pub(super) fn plugin(app: &mut App) {
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<SpecializedComputePipelines<RaysPipeline>>()
        .add_systems(RenderStartup, init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            (
                request.in_set(SurfaceSystems::Request),
                prepare.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Rays>();
}

fn init_pipeline(
    mut commands: Commands,
    frame: Res<FrameLayout>,
    lighting: Res<LightingLayout>,
    scene: Res<SceneColorLayout>,
    assets: Res<AssetServer>,
) {
    let own = BindGroupLayoutDescriptor::new(
        "fluid_rays_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                unfiltered(),
                unfiltered(),
                unfiltered(),
                unfiltered(),
                unfiltered(),
                texture_storage_2d(RADIANCE_FORMAT, StorageTextureAccess::WriteOnly),
            ),
        ),
    );
    commands.insert_resource(RaysPipeline {
        layouts: [
            frame.layout.clone(),
            own,
            lighting.0.clone(),
            scene.0.clone(),
        ],
        shader: load_embedded_asset!(assets.as_ref(), "rays.wgsl"),
    });
}

impl SpecializedComputePipeline for RaysPipeline {
    type Key = RaysKey;

    fn specialize(&self, key: RaysKey) -> ComputePipelineDescriptor {
        let mut shader_defs = key.refract.shader_defs();
        shader_defs.extend(key.background.shader_defs());
        shader_defs.push(ShaderDefVal::UInt("RAYS".into(), key.count));
        shader_defs.push(tile_size());
        ComputePipelineDescriptor {
            label: Some("fluid_rays_pipeline".into()),
            layout: self.layouts.to_vec(),
            shader: self.shader.clone(),
            shader_defs,
            entry_point: Some("trace_more".into()),
            zero_initialize_workgroup_memory: true,
            ..default()
        }
    }
}

/// Requests the pipelines, and makes surfaces wait until they are compiled.
fn request(
    mut surfaces: Query<&mut Surface>,
    stage: Res<RaysPipeline>,
    mut specialized: ResMut<SpecializedComputePipelines<RaysPipeline>>,
    cache: Res<PipelineCache>,
) {
    for mut surface in &mut surfaces {
        let Some(wanted) = RaysKey::of(&surface.wanted) else {
            continue;
        };
        let wanted = specialized.specialize(&cache, &stage, wanted);
        if cache.get_compute_pipeline(wanted).is_none() {
            let state = cache.get_compute_pipeline_state(wanted);
            surface.waiting = Some(Waiting::new(LABEL, state));
        }
    }
}

fn prepare(
    mut surfaces: Query<(&Surface, &Layers, &mut Rays)>,
    stage: Res<RaysPipeline>,
    mut specialized: ResMut<SpecializedComputePipelines<RaysPipeline>>,
    placeholder: Res<Placeholder>,
    gpu: Gpu,
) {
    for (surface, layers, mut rays) in &mut surfaces {
        let key = surface.drawn.as_ref().and_then(RaysKey::of);
        rays.pipeline = key.map(|key| specialized.specialize(&gpu.cache, &stage, key));
        if rays.pipeline.is_some() {
            let inputs = [
                placeholder.or(&layers.bulk),
                placeholder.or(&layers.bulk_normals),
                placeholder.or(&layers.spray),
                placeholder.or(&layers.spray_normals),
                Input::texture(layers.light.as_ref()),
                Input::texture(layers.radiance.as_ref()),
            ];
            let [_, own, ..] = &stage.layouts;
            rays.group.prepare(&gpu, LABEL, own, &inputs);
        } else {
            // It would keep textures alive.
            rays.group = default();
        }
    }
}

impl Rays {
    /// Traces them, once the light of all pixels is known, and writes their mean in place of the
    /// radiance.
    pub(super) fn trace(
        &self,
        ctx: &mut RenderContext,
        (frame, layers): (&Frame, &Layers),
        (lighting, scene): (&ViewLighting, &BindGroup),
        cache: &PipelineCache,
    ) {
        let pipeline = self.pipeline.and_then(|id| cache.get_compute_pipeline(id));
        let (Some(pipeline), Some(group), Some((lighting, offset))) =
            (pipeline, self.group.get(), lighting.get())
        else {
            return;
        };
        let encoder = ctx.command_encoder();
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(LABEL),
            ..default()
        });
        pass.set_pipeline(pipeline);
        frame.bind(&mut pass);
        pass.set_bind_group(1, group, &[]);
        pass.set_bind_group(2, lighting, &offset);
        pass.set_bind_group(3, scene, &[]);
        let tiles = layers.tile_count();
        pass.dispatch_workgroups(tiles.x, tiles.y, 1);
    }
}
