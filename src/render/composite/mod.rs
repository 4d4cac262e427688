//! The liquid over the opaque scene, surfaces from far to near.

mod behind;
mod pipeline;
mod rays;
mod scene;
mod shade;

use bevy::{
    asset::embedded_asset,
    camera::MainPassResolutionOverride,
    core_pipeline::{core_3d::Transparent3d, prepass::ViewPrepassTextures},
    pbr::{ScreenSpaceTransmission, ViewTransmissionTexture},
    prelude::*,
    render::{
        Render, RenderApp, RenderSystems,
        camera::ExtractedCamera,
        render_phase::{AddRenderCommand, sort_phase_system},
        render_resource::{
            BindGroup, CachedRenderPipelineId, PipelineCache, RenderPassDescriptor, StoreOp,
        },
        renderer::{RenderContext, ViewQuery},
        view::{ViewDepthTexture, ViewTarget},
    },
    shader::load_shader_library,
};

pub(super) use self::behind::{give_back, take_behind};
use self::{
    behind::{BehindLiquid, ViewItems},
    rays::Rays,
    scene::SceneColor,
};
pub(super) use self::{pipeline::CompositePipeline, shade::ShadePipeline};
#[cfg(all(test, feature = "published"))]
pub(super) use self::{
    pipeline::{CompositeKey, CompositePart},
    rays::{RaysKey, RaysPipeline},
    shade::ShadeKey,
};
use super::{
    frame::{Frame, Kept, Layers, add_stage, cleared, timed},
    lighting::ViewLighting,
    surface::{Surface, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_composite";

pub(super) fn plugin(app: &mut App) {
    load_shader_library!(app, "background.wgsl");
    load_shader_library!(app, "lit.wgsl");
    load_shader_library!(app, "resolve.wgsl");
    embedded_asset!(app, "shade.wgsl");
    embedded_asset!(app, "rays.wgsl");
    embedded_asset!(app, "composite.wgsl");
    add_stage::<ShadePipeline>(app);
    add_stage::<CompositePipeline>(app);
    scene::plugin(app);
    rays::plugin(app);
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        render_app
            .init_resource::<BehindLiquid>()
            .add_render_command::<Transparent3d, behind::DrawNothing>()
            .add_systems(
                Render,
                behind::mark_ends
                    .in_set(RenderSystems::PhaseSort)
                    .before(sort_phase_system::<Transparent3d>),
            );
    }
}

type Composited<'a> = (
    &'a Surface,
    &'a Frame,
    &'a Layers,
    &'a Kept<ShadePipeline>,
    &'a Kept<CompositePipeline>,
    &'a Rays,
);

/// The pass: all surfaces of the view, each composited over the previous ones.
pub(super) fn composite(
    world: &World,
    view: ViewQuery<(
        &ExtractedCamera,
        &ViewTarget,
        &ViewDepthTexture,
        Option<(&ScreenSpaceTransmission, &ViewTransmissionTexture)>,
        Option<&MainPassResolutionOverride>,
        Option<&ViewPrepassTextures>,
        &ViewSurfaces,
        &ViewLighting,
        &SceneColor,
    )>,
    surfaces: Query<Composited>,
    behind: Res<BehindLiquid>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let entity = view.entity();
    let (camera, target, depth, transmission, resolution, prepass, view, lighting, scene) =
        view.into_inner();
    let items = ViewItems {
        world,
        entity,
        camera,
        target,
        depth,
        resolution,
        transmission,
    };
    let drawn = |&(surface, ..): &Composited| {
        let variant = surface.drawn.as_ref();
        variant.is_some_and(|variant| variant.debug_view.is_none())
    };
    timed(&mut ctx, SPAN, |ctx| {
        let mut changed = view.viewport;
        let mut any = false;
        for (index, surface) in surfaces.iter_many(&view.surfaces).enumerate() {
            if behind.draw(ctx, &items, index) {
                changed = view.viewport;
            }
            if !drawn(&surface) {
                continue;
            }
            if !any {
                scene.keep(ctx, target, view.viewport);
                any = true;
            }
            // Rays leave the surface's own rectangle, so all that has changed may be needed.
            scene.copy(ctx, target, changed, &cache);
            changed = surface.1.camera_rect();
            let Some(scene) = scene.group(target) else {
                continue;
            };
            shade(ctx, surface, (lighting, scene), &cache);
            let place = (surface.1, surface.2);
            surface.5.trace(ctx, place, (lighting, scene), &cache);
            let pass = RenderPassDescriptor {
                label: Some(SPAN),
                color_attachments: &[Some(target.get_color_attachment())],
                depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                ..default()
            };
            let kept = surface.4.id(surface.0, |key| key.part.light());
            paint(ctx, pass, surface, kept, (lighting, scene), &cache);
        }
        for surface in surfaces.iter_many(&view.surfaces).filter(drawn) {
            let kept = surface.4.id(surface.0, |key| !key.part.light());
            if let (Some(_), Some(scene)) = (kept, scene.group(target)) {
                let pass = RenderPassDescriptor {
                    label: Some("fluid_composite_depth"),
                    depth_stencil_attachment: Some(depth.get_attachment(StoreOp::Store)),
                    ..default()
                };
                paint(ctx, pass, surface, kept, (lighting, scene), &cache);
            }
        }
        // Transparency that is independent of order, decals and soft particles read the prepass's
        // depth, and must find the liquid in it.
        if any && let Some(prepass) = prepass.and_then(|textures| textures.depth.as_ref()) {
            ctx.command_encoder().copy_texture_to_texture(
                depth.texture.as_image_copy(),
                prepass.texture.texture.as_image_copy(),
                depth.texture.size(),
            );
        }
    });
}

/// The light of a surface's pixels.
fn shade(
    ctx: &mut RenderContext,
    (surface, frame, layers, kept, ..): Composited,
    (lighting, scene): (&ViewLighting, &BindGroup),
    cache: &PipelineCache,
) {
    let (Some(pipeline), Some(group), Some((lighting, offset)), Some(target)) = (
        kept.only(surface, cache),
        kept.state.get(),
        lighting.get(),
        &layers.light,
    ) else {
        return;
    };
    let targets = [cleared(target, [0.0, 0.0, 0.0, -1.0])];
    let mut pass = frame.begin(ctx, "fluid_shade", &targets, None, pipeline);
    pass.set_bind_group(1, group, &[]);
    pass.set_bind_group(2, lighting, &offset);
    pass.set_bind_group(3, scene, &[]);
    frame.draw_tiles(&mut pass);
}

/// That light, or its depth, into the camera's targets.
fn paint(
    ctx: &mut RenderContext,
    pass: RenderPassDescriptor,
    (_, frame, _, _, kept, _): Composited,
    pipeline: Option<CachedRenderPipelineId>,
    (lighting, scene): (&ViewLighting, &BindGroup),
    cache: &PipelineCache,
) {
    let pipeline = pipeline.and_then(|id| cache.get_render_pipeline(id));
    let (Some(pipeline), Some(group), Some((lighting, offset))) =
        (pipeline, kept.state.get(), lighting.get())
    else {
        return;
    };
    let mut pass = ctx.begin_tracked_render_pass(pass);
    frame.enter(&mut pass, pipeline);
    pass.set_bind_group(1, group, &[]);
    pass.set_bind_group(2, lighting, &offset);
    pass.set_bind_group(3, scene, &[]);
    frame.draw_tiles(&mut pass);
}
