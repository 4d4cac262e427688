//! The accumulated path length through surfaces without refraction.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        render_resource::{RenderPipelineDescriptor, SpecializedRenderPipeline, TextureFormat},
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, Kept, Layers, NoUniform, Stage, add_stage,
        pipelines::{SUM_BLEND, defs, fragment},
        splats::{Class, SplatLayouts, SplatPass, Splats, splat_pipeline},
        support::FluidSupport,
        timed,
    },
    surface::{Surface, Variant, ViewSurfaces},
};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_thickness";

#[derive(Resource)]
pub(super) struct ThicknessPipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    format: TextureFormat,
    shader: Handle<Shader>,
}

pub(super) fn plugin(app: &mut App) {
    embedded_asset!(app, "thickness.wgsl");
    add_stage::<ThicknessPipeline>(app);
}

impl FromWorld for ThicknessPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            splats: world.resource::<SplatLayouts>().clone(),
            format: world.resource::<FluidSupport>().thickness_format,
            shader: load_embedded_asset!(world, "thickness.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for ThicknessPipeline {
    /// Format of the sums.
    type Key = TextureFormat;

    fn specialize(&self, format: TextureFormat) -> RenderPipelineDescriptor {
        // Path lengths are in metres, which needs view space.
        let shader_defs = defs([("VIEW_SPACE", true)]);
        let label = "fluid_thickness_pipeline";
        let sum = fragment(
            &self.shader,
            shader_defs.clone(),
            &[format],
            Some(SUM_BLEND),
        );
        splat_pipeline(label, &self.frame, &self.splats, [], shader_defs, sum)
    }
}

impl Stage for ThicknessPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    type State = ();

    fn keys(&self, variant: &Variant) -> Vec<TextureFormat> {
        let format = variant.plan.accumulated.then_some(self.format);
        format.into_iter().collect()
    }
}

/// The pass: all surfaces that need it.
pub(super) fn thickness(
    view: ViewQuery<&ViewSurfaces>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<ThicknessPipeline>)>,
    splats: Splats,
    mut ctx: RenderContext,
) {
    timed(&mut ctx, SPAN, |ctx| {
        let surfaces = surfaces.iter_many(&view.into_inner().surfaces);
        for (surface, frame, layers, kept) in surfaces {
            let pipeline = kept.id(surface, |_| true);
            let pass = SplatPass::sum(SPAN, &layers.thickness, pipeline);
            splats.record(ctx, (surface, frame), pass, &[Class::All]);
        }
    });
}
