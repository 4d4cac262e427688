//! Ellipsoids into depth layers: one draw per class, both depths from one quadratic.

mod depth_draws;
mod overdraw;
mod pipeline;

use bevy::{
    asset::embedded_asset,
    prelude::*,
    render::{
        RenderApp, RenderStartup,
        render_resource::{
            CachedRenderPipelineId, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

#[cfg(all(test, feature = "published"))]
pub(super) use self::pipeline::{SplatKey, SplatOutput};
use self::{
    depth_draws::{DepthDraws, DepthTextures},
    pipeline::LayerDraws,
};
pub(super) use self::{overdraw::overdraw, pipeline::SplatPipeline};
use super::{
    frame::{
        Frame, FrameStartup, Kept, Layers, add_stage, cleared,
        pipelines::NO_LAYERS,
        splats::{Class, Splats},
        timed,
    },
    surface::{Surface, ViewSurfaces, plan::Plan},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_splat";

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "splat.wgsl");
    embedded_asset!(app, "merge.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app.add_systems(RenderStartup, pipeline::init_pipeline.after(FrameStartup));
    add_stage::<SplatPipeline>(render_app);
    depth_draws::plugin(render_app);
}

/// The pass: splats of all surfaces into their layers.
pub(super) fn splat(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(
        &Surface,
        &Frame,
        &Layers,
        &DepthTextures,
        &Kept<SplatPipeline>,
    )>,
    depth_draws: Res<DepthDraws>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, textures, pipelines) in surfaces {
            let (Some(plan), Some(pipelines)) = (surface.plan(), pipelines.drawn(surface)) else {
                continue;
            };
            for (class, target) in [
                (Class::Bulk, layers.splatted()),
                (Class::Spray, &layers.spray),
            ] {
                let Some(target) = target else {
                    continue;
                };
                let draw = ClassDraw {
                    surface,
                    frame,
                    plan,
                    splats: &splats,
                    class,
                };
                match &pipelines.layers {
                    LayerDraws::MaxBlend(id) => {
                        draw.record(ctx, cleared(target, NO_LAYERS), None, *id);
                    }
                    LayerDraws::DepthDraws { front, back } => {
                        depth_draws.record(ctx, &draw, textures, target, [Some(*front), *back]);
                    }
                }
            }
        }
    });
}

/// The splats of one class of a surface.
struct ClassDraw<'a, 'w, 's> {
    surface: &'a Surface,
    frame: &'a Frame,
    plan: &'a Plan,
    splats: &'a Splats<'w, 's>,
    class: Class,
}

impl ClassDraw<'_, '_, '_> {
    /// A pass with one attachment.
    fn record(
        &self,
        ctx: &mut RenderContext,
        color: Option<RenderPassColorAttachment>,
        depth: Option<RenderPassDepthStencilAttachment>,
        pipeline: CachedRenderPipelineId,
    ) {
        if let Some(pipeline) = self.splats.cache.get_render_pipeline(pipeline) {
            let colors = [color];
            let colors = if colors[0].is_some() {
                &colors[..]
            } else {
                &[]
            };
            let mut pass = self.frame.begin(ctx, SPAN, colors, depth, pipeline);
            self.splats
                .draw(&mut pass, self.surface, self.plan, self.class);
        }
    }
}
