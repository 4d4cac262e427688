//! Normals not written by smoothing: the bulk's from depth, the spray's from its ellipsoids.

use bevy::{
    asset::load_embedded_asset,
    camera::Viewport,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroup, BindGroupEntries, BindGroupLayoutDescriptor, CachedRenderPipelineId,
            PipelineCache, RenderPassDescriptor, RenderPipelineDescriptor,
            SpecializedRenderPipeline, TextureView, VertexState,
        },
        renderer::{RenderContext, RenderDevice, ViewQuery},
        texture::CachedTexture,
    },
    shader::{Shader, ShaderDefVal},
};

use super::{
    bindings::{MAX_BLEND, cleared, common_layout, fragment, one_texture_layout},
    bodies::Body,
    extract::GpuSplats,
    layers::NORMAL_FORMAT,
    splat::{Class, SPLAT_QUAD, SplatPipeline, SplatView, draw_splats},
};

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum NormalSource {
    /// The smaller one-sided differences of a layer.
    Depth,
    /// The ellipsoids that made the layer.
    Ellipsoids,
    /// The mean of other normals.
    Average { half_taps: u32 },
}

/// How the bulk gets its normals.
#[derive(Clone, Copy)]
pub(crate) enum BulkNormals {
    /// Smoothing has written them.
    Smoothed,
    Depth(CachedRenderPipelineId),
    Averaged {
        splats: CachedRenderPipelineId,
        average: CachedRenderPipelineId,
    },
}

impl BulkNormals {
    pub(crate) fn pipelines(&self) -> impl Iterator<Item = &CachedRenderPipelineId> {
        let (first, second) = match self {
            Self::Smoothed => (None, None),
            Self::Depth(pipeline) => (Some(pipeline), None),
            Self::Averaged { splats, average } => (Some(splats), Some(average)),
        };
        first.into_iter().chain(second)
    }
}

#[derive(Resource)]
pub(crate) struct NormalsPipeline {
    fullscreen: VertexState,
    layout: BindGroupLayoutDescriptor,
    fluid_layout: BindGroupLayoutDescriptor,
    depth_normals: Handle<Shader>,
    splat_normals: Handle<Shader>,
    average_normals: Handle<Shader>,
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
        splat_normals: load_embedded_asset!(assets.as_ref(), "splat_normals.wgsl"),
        average_normals: load_embedded_asset!(assets.as_ref(), "average_normals.wgsl"),
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
            NormalSource::Average { half_taps } => RenderPipelineDescriptor {
                label: Some("fluid_average_normals_pipeline".into()),
                layout: vec![common, self.layout.clone(), self.layout.clone()],
                vertex: self.fullscreen.clone(),
                fragment: Some(fragment(
                    &self.average_normals,
                    vec![ShaderDefVal::Int("HALF_TAPS".into(), half_taps as i32)],
                    &[NORMAL_FORMAT],
                    None,
                )),
                ..default()
            },
            NormalSource::Ellipsoids => RenderPipelineDescriptor {
                label: Some("fluid_splat_normals_pipeline".into()),
                layout: vec![common, self.fluid_layout.clone(), self.layout.clone()],
                vertex: VertexState {
                    shader: self.splat_normals.clone(),
                    shader_defs: shader_defs.clone(),
                    entry_point: Some("vertex".into()),
                    buffers: vec![],
                },
                primitive: SPLAT_QUAD,
                // If two ellipsoids made the same pixel, either normal is valid.
                fragment: Some(fragment(
                    &self.splat_normals,
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
    view: ViewQuery<SplatView>,
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
        let (layers, groups) = (&body.layers, &body.groups);
        let mut draw = NormalsDraw {
            body,
            viewport: viewport.as_ref(),
            cache: &cache,
            ctx: &mut ctx,
        };
        match body.pipelines.bulk_normals {
            BulkNormals::Smoothed => {}
            BulkNormals::Depth(pipeline) => {
                draw.fullscreen(pipeline, &layers.bulk_normals, [&groups.bulk_layers, &None]);
            }
            BulkNormals::Averaged { splats, average } => {
                if let Some(target) = &layers.splat_normals {
                    draw.splats(splats, target, &groups.bulk_layers, Class::Bulk, &fluids);
                    let inputs = [&groups.bulk_layers, &groups.splat_normals];
                    draw.fullscreen(average, &layers.bulk_normals, inputs);
                }
            }
        }
        if let Some(pipeline) = body.pipelines.spray_normals {
            let (target, input) = (&layers.spray_normals, &groups.spray_layers);
            draw.splats(pipeline, target, input, Class::Spray, &fluids);
        }
    }
    span.end(ctx.command_encoder());
}

struct NormalsDraw<'a, 'w, 's> {
    body: &'a Body,
    viewport: Option<&'a Viewport>,
    cache: &'a PipelineCache,
    ctx: &'a mut RenderContext<'w, 's>,
}

impl NormalsDraw<'_, '_, '_> {
    /// A pass over all pixels, with up to two inputs.
    fn fullscreen(
        &mut self,
        pipeline: CachedRenderPipelineId,
        target: &CachedTexture,
        inputs: [&Option<BindGroup>; 2],
    ) {
        let Some(pipeline) = self.cache.get_render_pipeline(pipeline) else {
            return;
        };
        let mut pass = self.ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_normals"),
            color_attachments: &[Some(cleared(&target.default_view, [0.0; 4]))],
            ..default()
        });
        self.body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        self.body.set_common(&mut pass);
        for (group, index) in inputs.into_iter().flatten().zip(1..) {
            pass.set_bind_group(index, group, &[]);
        }
        pass.draw(0..3, 0..1);
    }

    /// The splats of a class once more, over their layers.
    fn splats(
        &mut self,
        pipeline: CachedRenderPipelineId,
        target: &CachedTexture,
        layers: &Option<BindGroup>,
        class: Class,
        fluids: &Query<&GpuSplats>,
    ) {
        let (Some(pipeline), Some(group)) = (self.cache.get_render_pipeline(pipeline), layers)
        else {
            return;
        };
        let mut pass = self.ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_splat_normals"),
            color_attachments: &[Some(cleared(&target.default_view, [-2.0; 4]))],
            ..default()
        });
        if let Some(viewport) = self.viewport {
            pass.set_camera_viewport(viewport);
        }
        self.body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        self.body.set_common(&mut pass);
        pass.set_bind_group(2, group, &[]);
        draw_splats(&mut pass, self.body, class, fluids);
    }
}
