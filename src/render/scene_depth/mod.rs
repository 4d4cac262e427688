//! The opaque scene's depth in multisampled views, resolved once per pixel because many rays
//! sample it.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    core_pipeline::{FullscreenShader, prepass::ViewPrepassTextures},
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor, ShaderStages,
            binding_types::{texture_depth_2d_multisampled, uniform_buffer},
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    frame::{
        Frame, Gpu, GpuFrame, Group, Input, SCENE_DEPTH_FORMAT, SceneDepth, UniformArray, cleared,
        pipelines::fragment, timed,
    },
    surface::{Surface, SurfaceSystems, ViewSurfaces, reasons::Waiting},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_scene_depth";

#[derive(Resource)]
pub(super) struct ResolvePipeline {
    layout: BindGroupLayoutDescriptor,
    id: CachedRenderPipelineId,
}

#[derive(Component, Default)]
pub(super) struct ResolveGroup(Group);

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "resolve.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .add_systems(RenderStartup, init_pipeline)
        .add_systems(
            Render,
            (
                wait_for_pipeline.in_set(SurfaceSystems::Request),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<ViewSurfaces, ResolveGroup>();
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
    cache: Res<PipelineCache>,
) {
    let layout = BindGroupLayoutDescriptor::new(
        "fluid_scene_depth_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT,
            (
                texture_depth_2d_multisampled(),
                uniform_buffer::<GpuFrame>(true),
            ),
        ),
    );
    let shader = load_embedded_asset!(assets.as_ref(), "resolve.wgsl");
    let id = cache.queue_render_pipeline(RenderPipelineDescriptor {
        label: Some("fluid_scene_depth_pipeline".into()),
        layout: vec![layout.clone()],
        vertex: fullscreen.to_vertex_state(),
        fragment: Some(fragment(&shader, vec![], &[SCENE_DEPTH_FORMAT], None)),
        ..default()
    });
    commands.insert_resource(ResolvePipeline { layout, id });
}

fn wait_for_pipeline(
    mut surfaces: Query<&mut Surface>,
    pipeline: Res<ResolvePipeline>,
    cache: Res<PipelineCache>,
) {
    if cache.get_render_pipeline(pipeline.id).is_some() {
        return;
    }
    for mut surface in &mut surfaces {
        if surface.wanted.samples > 1 && surface.wanted.scene_depth {
            surface.waiting = Some(Waiting::new(
                SPAN,
                cache.get_render_pipeline_state(pipeline.id),
            ));
        }
    }
}

fn prepare_groups(
    mut views: Query<(&ViewSurfaces, &ViewPrepassTextures, &mut ResolveGroup)>,
    pipeline: Res<ResolvePipeline>,
    frames: Res<UniformArray<GpuFrame>>,
    gpu: Gpu,
) {
    for (view, prepass, mut group) in &mut views {
        if let Some(depth) = prepass.depth_view().filter(|_| view.resolves_depth()) {
            let inputs = [Input::view(depth), frames.input()];
            group
                .0
                .prepare(&gpu, "fluid_scene_depth", &pipeline.layout, &inputs);
        }
    }
}

/// The pass: once a view, if it sees a surface.
pub(super) fn scene_depth(
    view: ViewQuery<(&ViewSurfaces, &SceneDepth, &ResolveGroup)>,
    frames: Query<&Frame>,
    pipeline: Res<ResolvePipeline>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (view, scene_depth, group) = view.into_inner();
    // Any surface's frame tells where the view is.
    if !view.resolves_depth() {
        return;
    }
    let (Some(frame), Some(target), Some(group), Some(pipeline)) = (
        frames.iter_many(&view.surfaces).next(),
        &scene_depth.resolved,
        group.0.get(),
        cache.get_render_pipeline(pipeline.id),
    ) else {
        return;
    };
    timed(&mut ctx, SPAN, |ctx| {
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some(SPAN),
            color_attachments: &[cleared(target, [0.0; 4])],
            ..default()
        });
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, group, &[frame.frame_offset()]);
        pass.draw(0..3, 0..1);
    });
}
