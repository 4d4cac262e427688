//! How often each pixel is drawn to, for the debug view that shows it.

use bevy::{
    camera::{MainPassResolutionOverride, Viewport},
    prelude::*,
    render::{
        camera::ExtractedCamera,
        diagnostic::RecordDiagnostics,
        render_resource::{PipelineCache, RenderPassDescriptor},
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    super::{bindings::cleared, bodies::ViewBodies, extract::GpuSplats},
    Class, draw_splats,
};

/// The pass: counts the splats that the layers of all bodies are made of.
pub(crate) fn overdraw(
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
    if bodies.ready().all(|body| body.layers.overdraw.is_none()) {
        return;
    }
    let viewport = Viewport::from_viewport_and_override(camera.viewport.as_ref(), resolution);
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_overdraw");
    for body in bodies.ready() {
        let (Some(target), Some(pipeline)) = (
            &body.layers.overdraw,
            body.pipelines
                .overdraw
                .and_then(|id| cache.get_render_pipeline(id)),
        ) else {
            continue;
        };
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_overdraw"),
            color_attachments: &[Some(cleared(&target.default_view, [0.0; 4]))],
            ..default()
        });
        if let Some(viewport) = &viewport {
            pass.set_camera_viewport(viewport);
        }
        body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        body.set_common(&mut pass);
        draw_splats(&mut pass, body, Class::Bulk, &fluids);
        draw_splats(&mut pass, body, Class::Spray, &fluids);
    }
    span.end(ctx.command_encoder());
}
