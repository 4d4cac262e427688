//! The accumulated path length through surfaces without refraction.

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        RenderApp, RenderStartup,
        render_resource::{
            CachedRenderPipelineId, RenderPipelineDescriptor, SpecializedRenderPipeline,
            TextureFormat,
        },
        renderer::{RenderContext, ViewQuery},
    },
};

use super::{
    frame::{
        Frame, FrameLayout, FrameStartup, Kept, Layers, Stage, add_stage,
        pipelines::{SUM_BLEND, defs, fragment},
        splats::{Class, SplatLayouts, Splats, splat_pipeline},
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
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app.add_systems(RenderStartup, init_pipeline.after(FrameStartup));
    add_stage::<ThicknessPipeline>(render_app);
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    splats: Res<SplatLayouts>,
    support: Res<FluidSupport>,
) {
    commands.insert_resource(ThicknessPipeline {
        frame: frame.clone(),
        splats: splats.clone(),
        format: support.thickness_format,
        shader: load_embedded_asset!(assets.as_ref(), "thickness.wgsl"),
    });
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
    type Pipelines = Option<CachedRenderPipelineId>;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(TextureFormat) -> CachedRenderPipelineId,
    ) -> Option<CachedRenderPipelineId> {
        variant.plan.accumulated.then(|| request(self.format))
    }

    fn ids(pipeline: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        pipeline.iter().copied()
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
        for (surface, frame, layers, pipeline) in surfaces {
            if let Some(Some(pipeline)) = pipeline.drawn(surface) {
                let (surface, target) = ((surface, frame), &layers.thickness);
                splats.sum(ctx, SPAN, surface, target, *pipeline, &[Class::All]);
            }
        }
    });
}
