//! Pipelines that draw splats into layers.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::render_resource::{
        CachedRenderPipelineId, ColorWrites, CompareFunction, DepthStencilState,
        RenderPipelineDescriptor, SpecializedRenderPipeline, TextureFormat,
    },
};

use super::{
    super::{
        frame::{
            FrameLayout, Stage,
            pipelines::{MAX_BLEND, SUM_BLEND, defs, fragment},
            splats::{SplatLayouts, splat_pipeline},
            support::{FluidSupport, LAYER_FORMAT},
        },
        surface::Variant,
    },
    depth_draws::DEPTH_FORMAT,
};
use crate::settings::FluidDebugView;

/// The output of a draw of splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum SplatOutput {
    /// Both depths, by a `max` blend.
    Layers,
    /// The nearest front alone, likewise.
    Fronts,
    /// The nearest front, by the depth test.
    FrontDepth,
    /// The farthest back, by the depth test.
    BackDepth,
    /// The number of splats, summed up in a texture of this format.
    Count(TextureFormat),
}

/// A draw of splats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SplatKey {
    pub(crate) output: SplatOutput,
    /// Whether some may be cut by the near plane. Usually none is, and without the code for cut
    /// splats the others are drawn in half the time.
    pub(crate) cut: bool,
}

#[derive(Resource)]
pub(crate) struct SplatPipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    max_blend: bool,
    sum_format: TextureFormat,
    shader: Handle<Shader>,
}

pub(super) fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    splats: Res<SplatLayouts>,
    support: Res<FluidSupport>,
) {
    commands.insert_resource(SplatPipeline {
        frame: frame.clone(),
        splats: splats.clone(),
        max_blend: support.max_blend,
        sum_format: support.thickness_format,
        shader: load_embedded_asset!(assets.as_ref(), "splat.wgsl"),
    });
}

impl SpecializedRenderPipeline for SplatPipeline {
    type Key = SplatKey;

    fn specialize(&self, SplatKey { output, cut }: SplatKey) -> RenderPipelineDescriptor {
        let shader_defs = defs([
            (
                "MAX_BLEND",
                matches!(output, SplatOutput::Layers | SplatOutput::Fronts),
            ),
            ("DEPTH_FRONT", output == SplatOutput::FrontDepth),
            ("DEPTH_BACK", output == SplatOutput::BackDepth),
            ("COUNT", matches!(output, SplatOutput::Count(_))),
            ("NONE_CUT", !cut),
        ]);
        let (formats, blend, compare): (&[_], _, _) = match output {
            SplatOutput::Layers | SplatOutput::Fronts => (&[LAYER_FORMAT], MAX_BLEND, None),
            SplatOutput::FrontDepth => (&[], MAX_BLEND, Some(CompareFunction::Greater)),
            SplatOutput::BackDepth => (&[], MAX_BLEND, Some(CompareFunction::Less)),
            SplatOutput::Count(format) => (&[format], SUM_BLEND, None),
        };
        let mut fragment = fragment(&self.shader, shader_defs.clone(), formats, Some(blend));
        if output == SplatOutput::Fronts {
            for target in fragment.targets.iter_mut().flatten() {
                target.write_mask = ColorWrites::RED;
            }
        }
        RenderPipelineDescriptor {
            depth_stencil: compare.map(|compare| DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: default(),
                bias: default(),
            }),
            ..splat_pipeline(
                "fluid_splat_pipeline",
                &self.frame,
                &self.splats,
                [],
                shader_defs,
                fragment,
            )
        }
    }
}

/// The pipelines of a surface's layers.
pub(crate) struct SplatPipelines {
    pub(super) layers: LayerDraws,
    /// For the debug view that shows it.
    pub(super) overdraw: Option<CachedRenderPipelineId>,
}

pub(super) enum LayerDraws {
    MaxBlend(CachedRenderPipelineId),
    DepthDraws {
        front: CachedRenderPipelineId,
        /// `None` where nothing is seen through the surface.
        back: Option<CachedRenderPipelineId>,
    },
}

impl Stage for SplatPipeline {
    type Pipelines = SplatPipelines;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(SplatKey) -> CachedRenderPipelineId,
    ) -> SplatPipelines {
        let plan = &variant.plan;
        // Both forms at once, so that neither has to be waited for when the near plane enters.
        let mut draw = |output| {
            let [whole, any] = [false, true].map(|cut| request(SplatKey { output, cut }));
            if plan.cut { any } else { whole }
        };
        let layers = match (self.max_blend, plan.backs()) {
            (true, true) => LayerDraws::MaxBlend(draw(SplatOutput::Layers)),
            (true, false) => LayerDraws::MaxBlend(draw(SplatOutput::Fronts)),
            (false, backs) => LayerDraws::DepthDraws {
                front: draw(SplatOutput::FrontDepth),
                back: backs.then(|| draw(SplatOutput::BackDepth)),
            },
        };
        let counted = variant.debug_view == Some(FluidDebugView::Overdraw);
        SplatPipelines {
            layers,
            overdraw: counted.then(|| draw(SplatOutput::Count(self.sum_format))),
        }
    }

    fn ids(pipelines: &SplatPipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        let (first, second) = match pipelines.layers {
            LayerDraws::MaxBlend(id) => (id, None),
            LayerDraws::DepthDraws { front, back } => (front, back),
        };
        [first].into_iter().chain(second).chain(pipelines.overdraw)
    }
}
