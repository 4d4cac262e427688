//! Debug views: intermediate results in place of the liquid.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT,
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
            CompareFunction, DepthStencilState, MultisampleState, PipelineCache,
            RenderPassDescriptor, RenderPipelineDescriptor, ShaderStages,
            SpecializedRenderPipeline, StoreOp, TextureFormat, TextureSampleType,
            binding_types::{texture_2d, uniform_buffer},
        },
        renderer::{RenderContext, ViewQuery},
        view::{ViewDepthTexture, ViewTarget},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, FrameStartup, Gpu, Group, Input, Kept, Layers, Offset, Placeholder,
        Stage, UniformArray, add_stage,
        pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
    },
    surface::{Surface, SurfaceSystems, Variant, ViewSurfaces},
};
use crate::settings::FluidDebugView;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct DebugKey {
    pub(super) debug_view: FluidDebugView,
    pub(super) format: TextureFormat,
    pub(super) samples: u32,
    /// Whether the thickness that is shown is accumulated.
    pub(super) accumulated: bool,
}

#[derive(Resource)]
pub(super) struct DebugPipeline {
    frame: FrameLayout,
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

#[derive(Component, Default)]
pub(super) struct DebugGroup {
    offset: Offset,
    group: Group,
}

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "debug_view.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<UniformArray<Vec4>>()
        .add_systems(RenderStartup, init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            (
                prepare_ranges.in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    add_stage::<DebugPipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, DebugGroup>();
}

fn init_pipeline(mut commands: Commands, assets: Res<AssetServer>, frame: Res<FrameLayout>) {
    commands.insert_resource(DebugPipeline {
        frame: frame.clone(),
        layout: BindGroupLayoutDescriptor::new(
            "fluid_debug_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::FRAGMENT,
                (
                    unfiltered(),
                    unfiltered(),
                    unfiltered(),
                    unfiltered(),
                    texture_2d(TextureSampleType::Uint),
                    uniform_buffer::<Vec4>(true),
                    unfiltered(),
                ),
            ),
        ),
        shader: load_embedded_asset!(assets.as_ref(), "debug_view.wgsl"),
    });
}

impl SpecializedRenderPipeline for DebugPipeline {
    type Key = DebugKey;

    fn specialize(&self, key: DebugKey) -> RenderPipelineDescriptor {
        let is = |view| key.debug_view == view;
        let shader_defs = defs([
            ("BULK_FRONT", is(FluidDebugView::BulkFront)),
            ("BULK_BACK", is(FluidDebugView::BulkBack)),
            ("SPRAY_FRONT", is(FluidDebugView::SprayFront)),
            ("SPRAY_BACK", is(FluidDebugView::SprayBack)),
            ("NORMALS", is(FluidDebugView::Normals)),
            ("INTERFACES", is(FluidDebugView::Interfaces)),
            ("STATUS", is(FluidDebugView::Status)),
            ("CLASSES", is(FluidDebugView::Classes)),
            ("THICKNESS", is(FluidDebugView::Thickness)),
            ("ACCUMULATED", key.accumulated),
            ("EXIT_RAY", is(FluidDebugView::ExitRay)),
            ("OVERDRAW", is(FluidDebugView::Overdraw)),
        ]);
        RenderPipelineDescriptor {
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                depth_write_enabled: Some(false),
                depth_compare: Some(CompareFunction::Always),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            ..tile_pipeline(
                "fluid_debug_pipeline",
                &self.frame,
                [self.layout.clone()],
                Tiles::AllInCamera,
                fragment(&self.shader, shader_defs, &[key.format], None),
            )
        }
    }
}

impl Stage for DebugPipeline {
    type Pipelines = Option<CachedRenderPipelineId>;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(DebugKey) -> CachedRenderPipelineId,
    ) -> Self::Pipelines {
        let debug_view = variant.debug_view?;
        Some(request(DebugKey {
            debug_view,
            format: variant.format,
            samples: variant.samples,
            accumulated: variant.plan.accumulated && debug_view == FluidDebugView::Thickness,
        }))
    }

    fn ids(pipeline: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        pipeline.iter().copied()
    }
}

fn prepare_ranges(
    mut surfaces: Query<(&Surface, &mut DebugGroup)>,
    mut uniforms: ResMut<UniformArray<Vec4>>,
    gpu: Gpu,
) {
    uniforms.clear();
    for (surface, mut debug) in &mut surfaces {
        debug.offset = uniforms.push(surface.depths.extend(0.0).extend(0.0));
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut surfaces: Query<(&Surface, &Layers, &mut DebugGroup)>,
    pipeline: Res<DebugPipeline>,
    placeholder: Res<Placeholder>,
    uniforms: Res<UniformArray<Vec4>>,
    gpu: Gpu,
) {
    for (surface, layers, mut debug) in &mut surfaces {
        if surface.wanted.debug_view.is_none() {
            continue;
        }
        let or_nothing = |target| Input::texture_or(target, &placeholder);
        let amounts = if layers.overdraw.is_some() {
            &layers.overdraw
        } else {
            &layers.thickness
        };
        let inputs = [
            or_nothing(&layers.bulk),
            or_nothing(&layers.bulk_normals),
            or_nothing(&layers.spray),
            or_nothing(&layers.spray_normals),
            Input::texture(layers.exits.as_ref()),
            uniforms.input(),
            or_nothing(amounts),
        ];
        debug
            .group
            .prepare(&gpu, "fluid_debug_view", &pipeline.layout, &inputs);
    }
}

/// The pass: all surfaces of a view that has a debug view.
pub(super) fn debug_view(
    view: ViewQuery<(&ViewTarget, &ViewDepthTexture, &ViewSurfaces)>,
    surfaces: Query<(&Surface, &Frame, &DebugGroup, &Kept<DebugPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (target, depth, view) = view.into_inner();
    for (surface, frame, debug, pipeline) in surfaces.iter_many(&view.surfaces) {
        let pipeline = pipeline.drawn(surface).copied().flatten();
        let (Some(pipeline), Some(group)) = (
            pipeline.and_then(|id| cache.get_render_pipeline(id)),
            debug.group.get(),
        ) else {
            continue;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_debug_view"),
            color_attachments: &[Some(target.get_color_attachment())],
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        frame.enter(&mut pass, pipeline);
        pass.set_bind_group(1, group, &[debug.offset.bytes()]);
        frame.draw_tiles(&mut pass);
    }
}
