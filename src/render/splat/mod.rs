//! Ellipsoids into depth layers: one draw per class, both depths from one quadratic.

mod overdraw;

use bevy::{
    asset::load_embedded_asset,
    camera::{MainPassResolutionOverride, Viewport},
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_phase::TrackedRenderPass,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId, ColorWrites,
            CompareFunction, DepthStencilState, LoadOp, Operations, PipelineCache, PrimitiveState,
            PrimitiveTopology, RenderPassDepthStencilAttachment, RenderPassDescriptor,
            RenderPipelineDescriptor, ShaderStages, SpecializedRenderPipeline, StoreOp,
            TextureFormat, VertexState,
            binding_types::{storage_buffer_read_only_sized, texture_depth_2d, uniform_buffer},
        },
        renderer::{RenderContext, ViewQuery},
        texture::CachedTexture,
    },
    shader::Shader,
};

use super::{
    bindings::{MAX_BLEND, NO_LAYERS, SUM_BLEND, cleared, common_layout, defs, fragment},
    bodies::{Body, ViewBodies},
    extract::GpuSplats,
    gpu_types::GpuFluid,
    layers::DEPTH_FORMAT,
    support::LAYER_FORMAT,
};
pub(crate) use overdraw::overdraw;

/// The output of a draw of splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SplatOutput {
    /// Both depths, by a `max` blend.
    Layers,
    /// The nearest front alone, likewise.
    Fronts,
    /// The nearest front, by the depth test.
    FrontDepth,
    /// The farthest back, by the depth test.
    BackDepth,
    /// The number of splats, summed up in a texture of this format.
    Count(TextureFormat),
}

/// A draw of splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SplatKey {
    pub(crate) output: SplatOutput,
    /// Whether some may be cut by the near plane. Usually none is, and without the code for cut
    /// splats the others are drawn in half the time.
    pub(crate) cut: bool,
}

#[derive(Resource)]
pub(crate) struct SplatPipeline {
    pub(crate) shader: Handle<Shader>,
    /// Splats and their fluid's transform.
    pub(crate) fluid_layout: BindGroupLayoutDescriptor,
    pub(crate) merge_layout: BindGroupLayoutDescriptor,
    pub(crate) merge: CachedRenderPipelineId,
}

pub(crate) fn init_splat_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
    cache: Res<PipelineCache>,
) {
    let merge_layout = BindGroupLayoutDescriptor::new(
        "fluid_merge_layout",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::FRAGMENT,
            (texture_depth_2d(), texture_depth_2d()),
        ),
    );
    let merge = cache.queue_render_pipeline(RenderPipelineDescriptor {
        label: Some("fluid_merge_pipeline".into()),
        layout: vec![merge_layout.clone()],
        vertex: fullscreen.to_vertex_state(),
        fragment: Some(fragment(
            &load_embedded_asset!(assets.as_ref(), "merge.wgsl"),
            vec![],
            &[LAYER_FORMAT],
            None,
        )),
        ..default()
    });
    commands.insert_resource(SplatPipeline {
        shader: load_embedded_asset!(assets.as_ref(), "splat.wgsl"),
        fluid_layout: BindGroupLayoutDescriptor::new(
            "fluid_splats_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::VERTEX,
                (
                    storage_buffer_read_only_sized(false, None),
                    uniform_buffer::<GpuFluid>(true),
                ),
            ),
        ),
        merge_layout,
        merge,
    });
}

/// Quads of four corners, one instance per splat.
pub(crate) const SPLAT_QUAD: PrimitiveState = PrimitiveState {
    topology: PrimitiveTopology::TriangleStrip,
    strip_index_format: None,
    front_face: bevy::render::render_resource::FrontFace::Ccw,
    cull_mode: None,
    unclipped_depth: false,
    polygon_mode: bevy::render::render_resource::PolygonMode::Fill,
    conservative: false,
};

impl SpecializedRenderPipeline for SplatPipeline {
    type Key = SplatKey;

    fn specialize(&self, SplatKey { output, cut }: SplatKey) -> RenderPipelineDescriptor {
        let shader_defs = defs([
            (
                "MAX_BLEND",
                matches!(output, SplatOutput::Layers | SplatOutput::Fronts),
            ),
            ("DEPTH_FRONT", output == SplatOutput::FrontDepth),
            ("DEPTH_BACK", output == SplatOutput::BackDepth),
            ("COUNT", matches!(output, SplatOutput::Count(_))),
            ("NONE_CUT", !cut),
        ]);
        let (formats, blend, compare): (&[_], _, _) = match output {
            SplatOutput::Layers | SplatOutput::Fronts => (&[LAYER_FORMAT], MAX_BLEND, None),
            SplatOutput::FrontDepth => (&[], MAX_BLEND, Some(CompareFunction::Greater)),
            SplatOutput::BackDepth => (&[], MAX_BLEND, Some(CompareFunction::Less)),
            SplatOutput::Count(format) => (&[format], SUM_BLEND, None),
        };
        let mut fragment = fragment(&self.shader, shader_defs.clone(), formats, Some(blend));
        if output == SplatOutput::Fronts {
            for target in fragment.targets.iter_mut().flatten() {
                target.write_mask = ColorWrites::RED;
            }
        }
        RenderPipelineDescriptor {
            label: Some("fluid_splat_pipeline".into()),
            layout: vec![common_layout(), self.fluid_layout.clone()],
            vertex: VertexState {
                shader: self.shader.clone(),
                shader_defs,
                entry_point: Some("vertex".into()),
                buffers: vec![],
            },
            primitive: SPLAT_QUAD,
            depth_stencil: compare.map(|compare| DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: default(),
                bias: default(),
            }),
            fragment: Some(fragment),
            ..default()
        }
    }
}

/// The pipelines of a body's splats.
#[derive(Clone, Copy)]
pub(crate) enum SplatPipelines {
    MaxBlend(CachedRenderPipelineId),
    DepthDraws {
        front: CachedRenderPipelineId,
        /// `None` where nothing is seen through the body.
        back: Option<CachedRenderPipelineId>,
        merge: CachedRenderPipelineId,
    },
}

/// The two classes of splats that layers are made of, or all splats.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    Bulk,
    Spray,
    All,
}

/// Draws the splats of one class of all of a body's fluids.
pub(crate) fn draw_splats<'a>(
    pass: &mut TrackedRenderPass<'a>,
    body: &Body,
    class: Class,
    fluids: &'a Query<&GpuSplats>,
) {
    for fluid in &body.fluids {
        let Some((gpu, group)) = fluids
            .get(fluid.entity)
            .ok()
            .and_then(|gpu| Some((gpu, gpu.bind_group.as_ref()?)))
        else {
            continue;
        };
        let range = match class {
            Class::Bulk => fluid.bulk.clone(),
            Class::Spray => fluid.spray.clone(),
            Class::All => 0..fluid.spray.end,
        };
        if !range.is_empty() {
            pass.set_bind_group(1, group, &[gpu.offset]);
            pass.draw(0..4, range);
        }
    }
}

/// The view components that a pass over splats needs.
pub(crate) type SplatView = (
    &'static ExtractedCamera,
    &'static ViewBodies,
    Option<&'static MainPassResolutionOverride>,
);

/// A pass that accumulates a value over splats, into a texture of every body that has one.
pub(crate) struct SplatSum<'a, 'w, 's> {
    /// Label of the pass and of its time span.
    pub(crate) label: &'static str,
    pub(crate) fluids: &'a Query<'w, 's, &'static GpuSplats>,
    pub(crate) cache: &'a PipelineCache,
    pub(crate) classes: &'a [Class],
}

impl SplatSum<'_, '_, '_> {
    /// `sum` picks a body's texture and the pipeline that draws to it.
    pub(crate) fn draw(
        &self,
        (camera, bodies, resolution): (
            &ExtractedCamera,
            &ViewBodies,
            Option<&MainPassResolutionOverride>,
        ),
        ctx: &mut RenderContext,
        sum: impl Fn(&Body) -> Option<(&CachedTexture, CachedRenderPipelineId)>,
    ) {
        let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
        let recorder = ctx.diagnostic_recorder();
        let recorder = recorder.as_deref();
        let span = recorder.time_span(ctx.command_encoder(), self.label);
        for body in bodies.ready() {
            let Some((target, pipeline)) = sum(body)
                .and_then(|(target, id)| Some((target, self.cache.get_render_pipeline(id)?)))
            else {
                continue;
            };
            let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                label: Some(self.label),
                color_attachments: &[Some(cleared(&target.default_view, [0.0; 4]))],
                ..default()
            });
            if let Some(viewport) = &viewport {
                pass.set_camera_viewport(viewport);
            }
            body.set_scissor(&mut pass);
            pass.set_render_pipeline(pipeline);
            body.set_common(&mut pass);
            for &class in self.classes {
                draw_splats(&mut pass, body, class, self.fluids);
            }
        }
        span.end(ctx.command_encoder());
    }
}

/// The pass: splats of all bodies into their layers.
pub(crate) fn splat(
    view: ViewQuery<SplatView>,
    fluids: Query<&GpuSplats>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (camera, bodies, resolution) = view.into_inner();
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_splat");
    for body in bodies.ready() {
        for (there, class, layers) in [
            (body.plan.bulk, Class::Bulk, &body.layers.bulk[0]),
            (body.plan.spray, Class::Spray, &body.layers.spray),
        ] {
            if there {
                let draw = ClassDraw {
                    body,
                    class,
                    layers,
                    viewport: viewport.as_ref(),
                };
                draw.execute(&mut ctx, &cache, &fluids);
            }
        }
    }
    span.end(ctx.command_encoder());
}

struct ClassDraw<'a> {
    body: &'a Body,
    class: Class,
    layers: &'a CachedTexture,
    viewport: Option<&'a Viewport>,
}

impl ClassDraw<'_> {
    fn execute(&self, ctx: &mut RenderContext, cache: &PipelineCache, fluids: &Query<&GpuSplats>) {
        match (self.body.pipelines.splat, &self.body.layers.depths) {
            (SplatPipelines::MaxBlend(pipeline), _) => {
                let pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                    label: Some("fluid_splat"),
                    color_attachments: &[Some(cleared(&self.layers.default_view, NO_LAYERS))],
                    ..default()
                });
                self.draw(pass, pipeline, cache, fluids);
            }
            (SplatPipelines::DepthDraws { front, back, merge }, Some([near, far])) => {
                for (texture, pipeline, clear) in [(near, Some(front), 0.0), (far, back, 1.0)] {
                    let pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
                        label: Some("fluid_splat_depth"),
                        depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                            view: &texture.default_view,
                            depth_ops: Some(Operations {
                                load: LoadOp::Clear(clear),
                                store: StoreOp::Store,
                            }),
                            stencil_ops: None,
                        }),
                        ..default()
                    });
                    // Cleared, but empty without a pipeline.
                    if let Some(pipeline) = pipeline {
                        self.draw(pass, pipeline, cache, fluids);
                    }
                }
                self.merge(ctx, merge, cache);
            }
            (SplatPipelines::DepthDraws { .. }, None) => {}
        }
    }

    fn draw<'a>(
        &'a self,
        mut pass: TrackedRenderPass<'a>,
        pipeline: CachedRenderPipelineId,
        cache: &'a PipelineCache,
        fluids: &'a Query<&GpuSplats>,
    ) {
        let Some(pipeline) = cache.get_render_pipeline(pipeline) else {
            return;
        };
        if let Some(viewport) = self.viewport {
            pass.set_camera_viewport(viewport);
        }
        self.body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        self.body.set_common(&mut pass);
        draw_splats(&mut pass, self.body, self.class, fluids);
    }

    fn merge(&self, ctx: &mut RenderContext, id: CachedRenderPipelineId, cache: &PipelineCache) {
        let (Some(pipeline), Some(group)) =
            (cache.get_render_pipeline(id), &self.body.groups.merge)
        else {
            return;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_merge"),
            color_attachments: &[Some(cleared(&self.layers.default_view, NO_LAYERS))],
            ..default()
        });
        self.body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        pass.draw(0..3, 0..1);
    }
}
