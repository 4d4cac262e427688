//! The liquid over the opaque scene, surfaces from far to near.

mod pipeline;
mod scene;

use bevy::{
    asset::embedded_asset,
    prelude::*,
    render::{
        Render, RenderApp, RenderStartup, RenderSystems,
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
    frame::{Frame, FrameStartup, Gpu, Group, Input, Kept, Layers, Placeholder, add_stage, timed},
    lighting::ViewLighting,
    surface::{Surface, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_composite";

/// What refraction has left on a surface.
#[derive(Component, Default)]
pub(super) struct Composite(Group);

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "composite.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .add_systems(RenderStartup, pipeline::init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            prepare_groups.in_set(RenderSystems::PrepareBindGroups),
        );
    add_stage::<CompositePipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Composite>();
    scene::plugin(render_app);
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut Composite)>,
    pipeline: Res<CompositePipeline>,
    placeholder: Res<Placeholder>,
    gpu: Gpu,
) {
    for (layers, mut composite) in &mut surfaces {
        let inputs = [
            Input::texture(layers.radiance.as_ref()),
            Input::texture(layers.transmission.as_ref()),
            Input::texture(layers.exits.as_ref()),
            Input::texture_or(&layers.bulk, &placeholder),
            Input::texture_or(&layers.spray, &placeholder),
        ];
        composite
            .0
            .prepare(&gpu, "fluid_composite", &pipeline.layout, &inputs);
    }
}

type Composited<'a> = (
    &'a Surface,
    &'a Frame,
    &'a Composite,
    &'a Kept<CompositePipeline>,
);

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
            let Some(pipelines) = surface.3.drawn(surface.0) else {
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
                pipelines.light,
                (lighting, scene, target),
                &cache,
            );
        }
        for surface in surfaces() {
            let pipelines = surface.3.drawn(surface.0);
            if let Some(pipeline) = pipelines.and_then(|it| it.depth) {
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
    (_, frame, composite, _): Composited,
    pipeline: CachedRenderPipelineId,
    (lighting, scene, target): (&ViewLighting, &SceneColor, &ViewTarget),
    cache: &PipelineCache,
) {
    let (Some(pipeline), Some(group), Some((light, light_offset)), Some(scene)) = (
        cache.get_render_pipeline(pipeline),
        composite.0.get(),
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
