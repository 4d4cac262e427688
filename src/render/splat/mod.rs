//! Ellipsoids into depth layers: one draw per class, both depths from one quadratic.

mod depth_draws;
mod pipeline;

use bevy::{
    asset::embedded_asset,
    prelude::*,
    render::{
        render_resource::LoadOp,
        renderer::{RenderContext, ViewQuery},
    },
};

#[cfg(all(test, feature = "published"))]
pub(super) use self::pipeline::SplatKey;
pub(super) use self::pipeline::{SplatOutput, SplatPipeline};
use super::{
    frame::{
        Frame, Kept, Layers, add_stage, cleared,
        pipelines::NO_LAYERS,
        splats::{Class, SplatPass, Splats},
        timed,
    },
    surface::{Surface, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_splat";

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "splat.wgsl");
    embedded_asset!(app, "merge.wgsl");
    add_stage::<SplatPipeline>(app);
}

/// The pass: splats of all surfaces into their layers.
pub(super) fn splat(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<SplatPipeline>)>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, kept) in surfaces {
            let mut coverage = layers
                .coverage
                .as_ref()
                .and_then(|it| cleared(it, [0.0; 4]));
            let id = |output| kept.id(surface, |key| key.output == output);
            let of = (surface, frame);
            for (class, target) in [
                (Class::Bulk, layers.splatted()),
                (Class::Spray, &layers.spray),
            ] {
                let Some(target) = target else {
                    continue;
                };
                let blended = id(SplatOutput::Layers).or(id(SplatOutput::Fronts));
                if blended.is_some() {
                    let pass = SplatPass {
                        label: SPAN,
                        pipeline: blended,
                        color: cleared(target, NO_LAYERS),
                        coverage: coverage.clone(),
                        ..default()
                    };
                    splats.record(ctx, of, pass, &[class]);
                    // The next class adds to it.
                    if let Some(coverage) = &mut coverage {
                        coverage.ops.load = LoadOp::Load;
                    }
                } else {
                    let depths = [SplatOutput::FrontDepth, SplatOutput::BackDepth];
                    let pipelines = (depths.map(id), id(SplatOutput::Merge));
                    kept.state
                        .record(ctx, (&splats, class), of, target, pipelines);
                }
            }
            let pass = SplatPass {
                label: SPAN,
                pipeline: id(SplatOutput::Coverage),
                color: coverage,
                ..default()
            };
            splats.record(ctx, of, pass, &[Class::Bulk, Class::Spray]);
            // For the debug view that shows it.
            let counted = kept.id(surface, |key| matches!(key.output, SplatOutput::Count(_)));
            let pass = SplatPass::sum(SPAN, &layers.overdraw, counted);
            splats.record(ctx, of, pass, &[Class::Bulk, Class::Spray]);
        }
    });
}
