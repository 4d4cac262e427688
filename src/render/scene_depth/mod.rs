//! The opaque scene's depth, resolved once per pixel because many rays sample it.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
            CachedRenderPipelineId, PipelineCache, RenderPassDescriptor, RenderPipeline,
            RenderPipelineDescriptor, ShaderStages, TextureFormat, TextureView,
            binding_types::{texture_depth_2d, texture_depth_2d_multisampled},
        },
        renderer::{RenderContext, RenderDevice, ViewQuery},
    },
};

use super::{
    bindings::{cleared, defs, fragment},
    bodies::ViewBodies,
};

/// (nearest, farthest) of a pixel's samples, in device depth.
pub(crate) const SCENE_DEPTH_FORMAT: TextureFormat = TextureFormat::Rg32Float;

/// For views without and with multisampling.
#[derive(Resource)]
pub(crate) struct SceneDepthPipelines {
    layouts: [BindGroupLayoutDescriptor; 2],
    pipelines: [CachedRenderPipelineId; 2],
}

pub(crate) fn init_scene_depth_pipelines(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
    cache: Res<PipelineCache>,
) {
    let layouts = [false, true].map(|multisampled| {
        let texture = if multisampled {
            texture_depth_2d_multisampled()
        } else {
            texture_depth_2d()
        };
        BindGroupLayoutDescriptor::new(
            "fluid_scene_depth_layout",
            &BindGroupLayoutEntries::single(ShaderStages::FRAGMENT, texture),
        )
    });
    let shader = load_embedded_asset!(assets.as_ref(), "resolve.wgsl");
    let pipelines = [false, true].map(|multisampled| {
        cache.queue_render_pipeline(RenderPipelineDescriptor {
            label: Some("fluid_scene_depth_pipeline".into()),
            layout: vec![layouts[usize::from(multisampled)].clone()],
            vertex: fullscreen.to_vertex_state(),
            fragment: Some(fragment(
                &shader,
                defs([("MULTISAMPLED", multisampled)]),
                &[SCENE_DEPTH_FORMAT],
                None,
            )),
            ..default()
        })
    });
    commands.insert_resource(SceneDepthPipelines { layouts, pipelines });
}

impl SceneDepthPipelines {
    pub(crate) fn pipeline<'a>(
        &self,
        cache: &'a PipelineCache,
        multisampled: bool,
    ) -> Option<&'a RenderPipeline> {
        cache.get_render_pipeline(self.pipelines[usize::from(multisampled)])
    }

    pub(crate) fn bind_group(
        &self,
        device: &RenderDevice,
        cache: &PipelineCache,
        multisampled: bool,
        depth: &TextureView,
    ) -> BindGroup {
        device.create_bind_group(
            "fluid_scene_depth",
            &cache.get_bind_group_layout(&self.layouts[usize::from(multisampled)]),
            &BindGroupEntries::single(depth),
        )
    }
}

/// The pass: once a view, if it sees a body.
pub(crate) fn scene_depth(
    view: ViewQuery<&ViewBodies>,
    pipelines: Res<SceneDepthPipelines>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let view = view.into_inner();
    let pipeline = pipelines.pipeline(&cache, view.multisampled);
    let (Some(pipeline), Some(group)) = (pipeline, &view.scene_depth_group) else {
        return;
    };
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
        label: Some("fluid_scene_depth"),
        color_attachments: &[Some(cleared(&view.scene_depth.default_view, [0.0; 4]))],
        ..default()
    });
    let span = recorder.pass_span(&mut pass, "fluid_scene_depth");
    let URect { min, max } = view.viewport;
    pass.set_scissor_rect(min.x, min.y, max.x - min.x, max.y - min.y);
    pass.set_render_pipeline(pipeline);
    pass.set_bind_group(0, group, &[]);
    pass.draw(0..3, 0..1);
    span.end(&mut pass);
}
