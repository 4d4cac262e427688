//! How often each pixel is drawn to, for the debug view that shows it.

use bevy::{
    prelude::*,
    render::renderer::{RenderContext, ViewQuery},
};

use super::{
    super::{
        frame::{
            Frame, Kept, Layers,
            splats::{Class, Splats},
        },
        surface::{Surface, ViewSurfaces},
    },
    pipeline::SplatPipeline,
};

/// Counts the splats that the layers of all surfaces are made of.
pub(in super::super) fn overdraw(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<SplatPipeline>)>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    for (surface, frame, layers, pipeline) in surfaces.iter_many(&view.into_inner().surfaces) {
        let pipelines = pipeline.drawn(surface);
        if let Some(pipeline) = pipelines.and_then(|pipelines| pipelines.overdraw) {
            let classes = [Class::Bulk, Class::Spray];
            let surface = (surface, frame);
            splats.sum(
                &mut ctx,
                "fluid_overdraw",
                surface,
                &layers.overdraw,
                pipeline,
                &classes,
            );
        }
    }
}
