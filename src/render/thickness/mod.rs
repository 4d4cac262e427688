//! The way through bodies that bend no light, summed up over their particles.

use bevy::{
    asset::load_embedded_asset,
    camera::{MainPassResolutionOverride, Viewport},
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroupLayoutDescriptor, PipelineCache, RenderPassDescriptor,
            RenderPipelineDescriptor, SpecializedRenderPipeline, TextureFormat, VertexState,
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::Shader,
};

use super::{
    bindings::{SUM_BLEND, cleared, common_layout, defs, fragment},
    bodies::ViewBodies,
    extract::GpuSplats,
    splat::{Class, SPLAT_QUAD, SplatPipeline, draw_splats},
};

#[derive(Resource)]
pub(crate) struct ThicknessPipeline {
    shader: Handle<Shader>,
    splats: BindGroupLayoutDescriptor,
}

/// Needs the layout of the splats.
pub(crate) fn init_thickness_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    splat: Res<SplatPipeline>,
) {
    commands.insert_resource(ThicknessPipeline {
        shader: load_embedded_asset!(assets.as_ref(), "thickness.wgsl"),
        splats: splat.fluid_layout.clone(),
    });
}

impl SpecializedRenderPipeline for ThicknessPipeline {
    /// What sums are kept in.
    type Key = TextureFormat;

    fn specialize(&self, format: TextureFormat) -> RenderPipelineDescriptor {
        // Metres are asked for, which pixels and device depth do not tell.
        let shader_defs = defs([("VIEW_SPACE", true)]);
        RenderPipelineDescriptor {
            label: Some("fluid_thickness_pipeline".into()),
            layout: vec![common_layout(), self.splats.clone()],
            vertex: VertexState {
                shader: self.shader.clone(),
                shader_defs: shader_defs.clone(),
                entry_point: Some("vertex".into()),
                buffers: vec![],
            },
            primitive: SPLAT_QUAD,
            fragment: Some(fragment(
                &self.shader,
                shader_defs,
                &[format],
                Some(SUM_BLEND),
            )),
            ..default()
        }
    }
}

/// The pass: all bodies that ask for it.
pub(crate) fn thickness(
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
    let span = recorder.time_span(ctx.command_encoder(), "fluid_thickness");
    for body in bodies.ready() {
        let (Some(target), Some(pipeline)) = (
            &body.layers.thickness,
            body.pipelines
                .thickness
                .and_then(|id| cache.get_render_pipeline(id)),
        ) else {
            continue;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_thickness"),
            color_attachments: &[Some(cleared(&target.default_view, [0.0; 4]))],
            ..default()
        });
        if let Some(viewport) = &viewport {
            pass.set_camera_viewport(viewport);
        }
        body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        body.set_common(&mut pass);
        draw_splats(&mut pass, body, Class::All, &fluids);
    }
    span.end(ctx.command_encoder());
}
