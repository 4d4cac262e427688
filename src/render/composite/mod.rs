//! The liquid over the opaque scene, bodies from far to near.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::{FullscreenShader, core_3d::CORE_3D_DEPTH_FORMAT},
    prelude::*,
    render::{
        diagnostic::RecordDiagnostics,
        render_phase::TrackedRenderPass,
        render_resource::{
            BindGroup, BindGroupLayoutDescriptor, BindGroupLayoutEntries, CompareFunction,
            DepthStencilState, Extent3d, MultisampleState, PipelineCache, RenderPassDescriptor,
            RenderPipeline, RenderPipelineDescriptor, SamplerBindingType, ShaderStages,
            SpecializedRenderPipeline, StoreOp, TextureFormat, TextureSampleType, VertexState,
            binding_types::{sampler, texture_2d, texture_cube, uniform_buffer},
        },
        renderer::{RenderContext, ViewQuery},
        texture::CachedTexture,
        view::{ViewDepthTexture, ViewTarget},
    },
    shader::Shader,
};

use super::{
    bindings::{common_layout, defs, fragment},
    bodies::{Body, ViewBodies},
};
use crate::settings::FluidDebugView;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CompositeKey {
    pub(crate) debug_view: Option<FluidDebugView>,
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    pub(crate) part: CompositePart,
    /// Whether there are other bodies, which may be visible through this one.
    pub(crate) several: bool,
    /// Whether the thickness shown by a debug view is accumulated.
    pub(crate) accumulated: bool,
}

impl CompositeKey {
    /// Whether a pipeline of this key can draw where `other` is wanted: to the same target, with the
    /// same bind groups.
    pub(crate) fn fits(&self, other: &Self) -> bool {
        (self.debug_view, self.format, self.samples)
            == (other.debug_view, other.format, other.samples)
    }
}

/// What is written. If bodies wrote their depth at once, a body painted later would be cut off
/// where it is behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum CompositePart {
    /// Light and depth: the only body, or a debug view.
    Whole,
    /// Light alone.
    Light,
    /// Depth alone, once all bodies' light is there.
    Depth,
    /// Depth alone, where more than half of the background is hidden: transparent objects drawn
    /// later are hidden by dense smoke, but not by thin smoke.
    DenseDepth,
}

impl CompositePart {
    fn depth(self) -> bool {
        self != Self::Light
    }

    fn light(self) -> bool {
        matches!(self, Self::Whole | Self::Light)
    }
}

#[derive(Resource)]
pub(crate) struct CompositePipeline {
    fullscreen: VertexState,
    pub(crate) layout: BindGroupLayoutDescriptor,
    pub(crate) debug_layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
    debug_shader: Handle<Shader>,
}

pub(crate) fn init_composite_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
) {
    let filtered = || texture_2d(TextureSampleType::Float { filterable: true });
    let unfiltered = || texture_2d(TextureSampleType::Float { filterable: false });
    commands.insert_resource(CompositePipeline {
        fullscreen: fullscreen.to_vertex_state(),
        layout: BindGroupLayoutDescriptor::new(
            "fluid_composite_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::FRAGMENT,
                (
                    texture_cube(TextureSampleType::Float { filterable: true }),
                    sampler(SamplerBindingType::Filtering),
                    unfiltered(),
                    unfiltered(),
                    texture_2d(TextureSampleType::Uint),
                    unfiltered(),
                    unfiltered(),
                    filtered(),
                    sampler(SamplerBindingType::Filtering),
                    filtered(),
                ),
            ),
        ),
        debug_layout: BindGroupLayoutDescriptor::new(
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
        shader: load_embedded_asset!(assets.as_ref(), "composite.wgsl"),
        debug_shader: load_embedded_asset!(assets.as_ref(), "debug_view.wgsl"),
    });
}

impl SpecializedRenderPipeline for CompositePipeline {
    type Key = CompositeKey;

    fn specialize(&self, key: CompositeKey) -> RenderPipelineDescriptor {
        let is = |view| key.debug_view == Some(view);
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
            ("DEPTH_ALONE", !key.part.light()),
            ("SEVERAL", key.several),
            ("DENSE", key.part == CompositePart::DenseDepth),
        ]);
        let formats: &[_] = if key.part.light() { &[key.format] } else { &[] };
        let (layout, shader, compare) = match key.debug_view {
            None => (&self.layout, &self.shader, CompareFunction::GreaterEqual),
            Some(_) => (
                &self.debug_layout,
                &self.debug_shader,
                CompareFunction::Always,
            ),
        };
        RenderPipelineDescriptor {
            label: Some("fluid_composite_pipeline".into()),
            layout: vec![common_layout(), layout.clone()],
            vertex: self.fullscreen.clone(),
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                // Transparent objects and later passes are depth-tested against the liquid.
                depth_write_enabled: Some(key.debug_view.is_none() && key.part.depth()),
                depth_compare: Some(compare),
                stencil: default(),
                bias: default(),
            }),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            fragment: Some(fragment(shader, shader_defs, formats, None)),
            ..default()
        }
    }
}

/// The pass: all bodies of the view, each composited over the previous ones.
pub(crate) fn composite(
    view: ViewQuery<(&ViewTarget, &ViewDepthTexture, &ViewBodies)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (target, depth, bodies) = view.into_inner();
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_composite");
    copy_scene(&mut ctx, target, bodies, &bodies.scene_before);
    for body in bodies.ready() {
        let (Some(pipeline), Some(group)) = (
            cache.get_render_pipeline(body.pipelines.composite),
            &body.groups.composite,
        ) else {
            continue;
        };
        copy_scene(&mut ctx, target, bodies, &bodies.scene_color);
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_composite"),
            color_attachments: &[Some(target.get_color_attachment())],
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        paint(&mut pass, body, pipeline, group);
    }
    for body in bodies.ready() {
        let (Some(pipeline), Some(group)) = (
            body.pipelines
                .composite_depth
                .and_then(|id| cache.get_render_pipeline(id)),
            &body.groups.composite,
        ) else {
            continue;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_composite_depth"),
            depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
            ..default()
        });
        paint(&mut pass, body, pipeline, group);
    }
    span.end(ctx.command_encoder());
}

fn paint<'a>(
    pass: &mut TrackedRenderPass<'a>,
    body: &'a Body,
    pipeline: &'a RenderPipeline,
    group: &'a BindGroup,
) {
    body.set_scissor(pass);
    pass.set_render_pipeline(pipeline);
    body.set_common(pass);
    if body.debug {
        pass.set_bind_group(1, group, &[body.depth_range_offset]);
    } else {
        pass.set_bind_group(1, group, &[]);
    }
    pass.draw(0..3, 0..1);
}

/// Copies the current colour, so that rays can look it up while the target is written.
fn copy_scene(
    ctx: &mut RenderContext,
    target: &ViewTarget,
    bodies: &ViewBodies,
    copy: &Option<CachedTexture>,
) {
    let Some(copy) = copy else {
        return;
    };
    // Rays leave the body's own rectangle, so the whole viewport may be needed.
    let region = bodies.viewport;
    let mut from = target.main_texture().as_image_copy();
    from.origin.x = region.min.x;
    from.origin.y = region.min.y;
    let mut to = copy.texture.as_image_copy();
    to.origin = from.origin;
    ctx.command_encoder().copy_texture_to_texture(
        from,
        to,
        Extent3d {
            width: region.width(),
            height: region.height(),
            depth_or_array_layers: 1,
        },
    );
}
