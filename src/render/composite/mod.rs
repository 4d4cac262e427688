//! The liquid over the opaque scene, surfaces from far to near.

mod pipeline;
mod scene;

use bevy::{
    asset::embedded_asset,
    prelude::*,
    render::{
        render_resource::{CachedRenderPipelineId, PipelineCache, RenderPassDescriptor, StoreOp},
        renderer::{RenderContext, ViewQuery},
        view::{ViewDepthTexture, ViewTarget},
    },
};

pub(super) use self::pipeline::CompositePipeline;
#[cfg(all(test, feature = "published"))]
pub(super) use self::pipeline::{CompositeKey, CompositePart};
use self::scene::SceneColor;
use super::{
    frame::{Frame, Kept, add_stage, timed},
    lighting::ViewLighting,
    surface::{Surface, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_composite";

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "composite.wgsl");
    add_stage::<CompositePipeline>(app);
    scene::plugin(app);
}

type Composited<'a> = (&'a Surface, &'a Frame, &'a Kept<CompositePipeline>);

/// The pass: all surfaces of the view, each composited over the previous ones.
pub(super) fn composite(
    view: ViewQuery<(
        &ViewTarget,
        &ViewDepthTexture,
        &ViewSurfaces,
        &ViewLighting,
        &SceneColor,
    )>,
    surfaces: Query<Composited>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (target, depth, view, lighting, scene) = view.into_inner();
    let drawn = |&(surface, ..): &Composited| {
        let variant = surface.drawn.as_ref();
        variant.is_some_and(|variant| variant.debug_view.is_none())
    };
    let surfaces = || surfaces.iter_many(&view.surfaces).filter(drawn);
    if surfaces().next().is_none() {
        return;
    }
    timed(&mut ctx, SPAN, |ctx| {
        let mut changed = view.viewport;
        scene.keep(ctx, target, changed);
        for surface in surfaces() {
            let Some(pipeline) = surface.2.id(surface.0, |key| key.part.light()) else {
                continue;
            };
            // Rays leave the surface's own rectangle, so all that has changed may be needed.
            scene.copy(ctx, target, changed, &cache);
            changed = surface.1.camera_rect();
            let pass = RenderPassDescriptor {
                label: Some(SPAN),
                color_attachments: &[Some(target.get_color_attachment())],
                depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                ..default()
            };
            paint(
                ctx,
                pass,
                surface,
                pipeline,
                (lighting, scene, target),
                &cache,
            );
        }
        for surface in surfaces() {
            if let Some(pipeline) = surface.2.id(surface.0, |key| !key.part.light()) {
                let pass = RenderPassDescriptor {
                    label: Some("fluid_composite_depth"),
                    depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                    ..default()
                };
                paint(
                    ctx,
                    pass,
                    surface,
                    pipeline,
                    (lighting, scene, target),
                    &cache,
                );
            }
        }
    });
}

fn paint(
    ctx: &mut RenderContext,
    pass: RenderPassDescriptor,
    (_, frame, kept): Composited,
    pipeline: CachedRenderPipelineId,
    (lighting, scene, target): (&ViewLighting, &SceneColor, &ViewTarget),
    cache: &PipelineCache,
) {
    let (Some(pipeline), Some(group), Some((light, light_offset)), Some(scene)) = (
        cache.get_render_pipeline(pipeline),
        kept.state.get(),
        lighting.get(),
        scene.group(target),
    ) else {
        return;
    };
    let mut pass = ctx.begin_tracked_render_pass(pass);
    frame.enter(&mut pass, pipeline);
    pass.set_bind_group(1, group, &[]);
    pass.set_bind_group(2, light, &light_offset);
    pass.set_bind_group(3, scene, &[]);
    frame.draw_tiles(&mut pass);
}
