//! Normals that smoothing has not written: the bulk's from depth, the spray's from its ellipsoids.

use bevy::{
    asset::load_embedded_asset,
    camera::{MainPassResolutionOverride, Viewport},
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, CachedRenderPipelineId,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor,
            SpecializedRenderPipeline, TextureView, VertexState,
        },
        renderer::{RenderContext, RenderDevice, ViewQuery},
    },
    shader::Shader,
};

use super::{
    bindings::{MAX_BLEND, cleared, common_layout, fragment, one_texture_layout},
    bodies::ViewBodies,
    extract::GpuSplats,
    layers::NORMAL_FORMAT,
    splat::{Class, SPLAT_QUAD, SplatPipeline, draw_splats},
};

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum NormalSource {
    /// The smaller one-sided differences of a layer.
    Depth,
    /// The ellipsoids that made the layer.
    Ellipsoids,
}

#[derive(Resource)]
pub(crate) struct NormalsPipeline {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    fluid_layout: BindGroupLayoutDescriptor,
    depth_normals: Handle<Shader>,
    spray_normals: Handle<Shader>,
}

pub(crate) fn init_normals_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
    splat: Res<SplatPipeline>,
) {
    commands.insert_resource(NormalsPipeline {
        fullscreen: fullscreen.to_vertex_state(),
        layout: one_texture_layout("fluid_normals_layout"),
        fluid_layout: splat.fluid_layout.clone(),
        depth_normals: load_embedded_asset!(assets.as_ref(), "depth_normals.wgsl"),
        spray_normals: load_embedded_asset!(assets.as_ref(), "spray_normals.wgsl"),
    });
}

impl NormalsPipeline {
    pub(crate) fn bind_group(
        &self,
        device: &RenderDevice,
        cache: &PipelineCache,
        layers: &TextureView,
    ) -> BindGroup {
        let layout = cache.get_bind_group_layout(&self.layout);
        device.create_bind_group("fluid_normals", &layout, &BindGroupEntries::single(layers))
    }
}

impl SpecializedRenderPipeline for NormalsPipeline {
    type Key = NormalSource;

    fn specialize(&self, source: NormalSource) -> RenderPipelineDescriptor {
        let shader_defs = vec![];
        let common = common_layout();
        match source {
            NormalSource::Depth => RenderPipelineDescriptor {
                label: Some("fluid_depth_normals_pipeline".into()),
                layout: vec![common, self.layout.clone()],
                vertex: self.fullscreen.clone(),
                fragment: Some(fragment(
                    &self.depth_normals,
                    shader_defs,
                    &[NORMAL_FORMAT],
                    None,
                )),
                ..default()
            },
            NormalSource::Ellipsoids => RenderPipelineDescriptor {
                label: Some("fluid_spray_normals_pipeline".into()),
                layout: vec![common, self.fluid_layout.clone(), self.layout.clone()],
                vertex: VertexState {
                    shader: self.spray_normals.clone(),
                    shader_defs: shader_defs.clone(),
                    entry_point: Some("vertex".into()),
                    buffers: vec![],
                },
                primitive: SPLAT_QUAD,
                // Two ellipsoids that made the same pixel: either normal will do.
                fragment: Some(fragment(
                    &self.spray_normals,
                    shader_defs,
                    &[NORMAL_FORMAT],
                    Some(MAX_BLEND),
                )),
                ..default()
            },
        }
    }
}

/// The pass: normals of all bodies.
pub(crate) fn normals(
    view: ViewQuery<(
        &ExtractedCamera,
        &ViewBodies,
        Option<&MainPassResolutionOverride>,
    )>,
    fluids: Query<&GpuSplats>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (camera, bodies, resolution) = view.into_inner();
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_normals");
    for body in bodies.ready() {
        let pipeline = |id: Option<CachedRenderPipelineId>| cache.get_render_pipeline(id?);
        if let (Some(pipeline), Some(group)) = (
            pipeline(body.pipelines.bulk_normals),
            &body.groups.bulk_normals,
        ) {
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("fluid_depth_normals"),
                color_attachments: &[Some(cleared(
                    &body.layers.bulk_normals.default_view,
                    [0.0; 4],
                ))],
                ..default()
            });
            body.set_scissor(&mut pass);
            pass.set_render_pipeline(pipeline);
            body.set_common(&mut pass);
            pass.set_bind_group(1, group, &[]);
            pass.draw(0..3, 0..1);
        }
        if let (Some(pipeline), Some(group)) = (
            pipeline(body.pipelines.spray_normals),
            &body.groups.spray_normals,
        ) {
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some("fluid_spray_normals"),
                color_attachments: &[Some(cleared(
                    &body.layers.spray_normals.default_view,
                    [-2.0; 4],
                ))],
                ..default()
            });
            if let Some(viewport) = &viewport {
                pass.set_camera_viewport(viewport);
            }
            body.set_scissor(&mut pass);
            pass.set_render_pipeline(pipeline);
            body.set_common(&mut pass);
            pass.set_bind_group(2, group, &[]);
            draw_splats(&mut pass, body, Class::Spray, &fluids);
        }
    }
    span.end(ctx.command_encoder());
}
