//! Smoothing of the bulk's layers, which removes the bumps of single particles.

#[cfg(feature = "published")]
mod average;
mod pipeline;
#[cfg(feature = "published")]
mod published;
pub(crate) mod steps;

use bevy::{
    prelude::*,
    render::{
        render_resource::{CachedRenderPipelineId, PipelineCache},
        renderer::{RenderContext, ViewQuery},
    },
};

#[cfg(feature = "published")]
pub(super) use self::average::{AveragePipeline, average_normals};
pub(super) use self::pipeline::SmoothPipeline;
use self::steps::{Buffer, Step};
use super::{
    frame::{Frame, Group, Kept, Layers, Target, add_stage, cleared, pipelines::NO_LAYERS, timed},
    surface::{Surface, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_smooth";

/// "Nothing here" as bits: [`NO_LAYERS`] in a texture of integers.
const NO_SLOPES: [f32; 4] = [0.0, 0xc000_0000_u32 as f32, 0.0, 0.0];

/// A bind group for each texture that is read.
#[derive(Default)]
pub(crate) struct Smooth {
    layers: Group,
    scratch: Group,
    slopes: Group,
}

pub(super) fn plugin(app: &mut App) {
    pipeline::load_shaders(app);
    add_stage::<SmoothPipeline>(app);
    #[cfg(feature = "published")]
    {
        published::embed_shaders(app);
        add_stage::<AveragePipeline>(app);
    }
}

impl Smooth {
    fn group(&self, buffer: Buffer) -> &Group {
        match buffer {
            Buffer::Layers => &self.layers,
            Buffer::Scratch => &self.scratch,
            Buffer::Slopes => &self.slopes,
        }
    }
}

fn target(layers: &Layers, buffer: Buffer) -> Option<&Target> {
    match buffer {
        Buffer::Layers => layers.bulk.as_ref(),
        Buffer::Scratch => layers.scratch.as_ref(),
        Buffer::Slopes => layers.exits.as_ref(),
    }
}

/// The pass: the bulk of all surfaces.
pub(super) fn smooth(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<SmoothPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, kept) in surfaces {
            for (step, pipeline) in kept.pipelines(surface) {
                record(ctx, (frame, layers, kept), step, *pipeline, &cache);
            }
        }
    });
}

fn record(
    ctx: &mut RenderContext,
    (frame, layers, kept): (&Frame, &Layers, &Kept<SmoothPipeline>),
    step: &Step,
    pipeline: CachedRenderPipelineId,
    cache: &PipelineCache,
) {
    let (Some(pipeline), Some(group), Some(to)) = (
        cache.get_render_pipeline(pipeline),
        kept.state.group(step.from).get(),
        target(layers, step.to),
    ) else {
        return;
    };
    let nothing = if step.to == Buffer::Slopes {
        NO_SLOPES
    } else {
        NO_LAYERS
    };
    let normals = layers.bulk_normals.as_ref().filter(|_| step.normals);
    let targets = [
        cleared(to, nothing),
        normals.and_then(|normals| cleared(normals, [0.0; 4])),
    ];
    let targets = &targets[..1 + usize::from(normals.is_some())];
    let mut pass = frame.begin(ctx, SPAN, targets, None, pipeline);
    pass.set_bind_group(1, group, &[kept.offset.bytes()]);
    frame.draw_tiles(&mut pass);
}
