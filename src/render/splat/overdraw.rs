//! How often each pixel is drawn to, for the debug view that shows it.

use bevy::{
    prelude::*,
    render::{
        render_resource::PipelineCache,
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{super::extract::GpuSplats, Class, SplatSum, SplatView};

/// The pass: counts the splats that the layers of all bodies are made of.
pub(crate) fn overdraw(
    view: ViewQuery<SplatView>,
    fluids: Query<&'static GpuSplats>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let view = view.into_inner();
    if view.1.ready().all(|body| body.layers.overdraw.is_none()) {
        return;
    }
    let sum = SplatSum {
        label: "fluid_overdraw",
        fluids: &fluids,
        cache: &cache,
        classes: &[Class::Bulk, Class::Spray],
    };
    sum.draw(view, &mut ctx, |body| {
        Some((body.layers.overdraw.as_ref()?, body.pipelines.overdraw?))
    });
}
