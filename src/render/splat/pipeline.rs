//! Pipelines that draw splats into layers.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::render_resource::{
        ColorWrites, CompareFunction, RenderPipelineDescriptor, SpecializedRenderPipeline,
        TextureFormat,
    },
};

use super::{
    super::{
        frame::{
            COVERAGE_FORMAT, FrameLayout, Inputs, Layers, NoUniform, Stage,
            pipelines::{MAX_BLEND, SUM_BLEND, defs, depth_state, fragment},
            splats::{SplatLayouts, splat_pipeline},
            support::{FluidSupport, LAYER_FORMAT},
        },
        surface::{Surface, Variant},
    },
    SPAN,
    depth_draws::{DepthTextures, Merge},
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
    /// Both depths, from two textures of them.
    Merge,
    /// The coverage alone.
    Coverage,
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
    /// Whether the coverage is written with depths.
    pub(crate) covers: bool,
}

#[derive(Resource)]
pub(crate) struct SplatPipeline {
    frame: FrameLayout,
    splats: SplatLayouts,
    max_blend: bool,
    sum_format: TextureFormat,
    shader: Handle<Shader>,
    merge: Merge,
}

impl FromWorld for SplatPipeline {
    fn from_world(world: &mut World) -> Self {
        let support = world.resource::<FluidSupport>();
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            splats: world.resource::<SplatLayouts>().clone(),
            max_blend: support.max_blend,
            sum_format: support.thickness_format,
            shader: load_embedded_asset!(world, "splat.wgsl"),
            merge: Merge::from_world(world),
        }
    }
}

impl SpecializedRenderPipeline for SplatPipeline {
    type Key = SplatKey;

    fn specialize(&self, key: SplatKey) -> RenderPipelineDescriptor {
        let SplatKey {
            output,
            cut,
            covers,
        } = key;
        let shader_defs = defs([
            (
                "MAX_BLEND",
                matches!(output, SplatOutput::Layers | SplatOutput::Fronts),
            ),
            ("DEPTH_FRONT", output == SplatOutput::FrontDepth),
            ("DEPTH_BACK", output == SplatOutput::BackDepth),
            ("COUNT", matches!(output, SplatOutput::Count(_))),
            ("NONE_CUT", !cut),
            ("COVERAGE", covers),
            ("COVERAGE_ALONE", output == SplatOutput::Coverage),
        ]);
        let (formats, blend, compare): (&[_], _, _) = match output {
            SplatOutput::Layers | SplatOutput::Fronts => {
                let formats = &[LAYER_FORMAT, COVERAGE_FORMAT];
                (&formats[..1 + usize::from(covers)], MAX_BLEND, None)
            }
            SplatOutput::Coverage => (&[COVERAGE_FORMAT], MAX_BLEND, None),
            SplatOutput::FrontDepth => (&[], MAX_BLEND, Some(CompareFunction::Greater)),
            SplatOutput::BackDepth => (&[], MAX_BLEND, Some(CompareFunction::Less)),
            SplatOutput::Count(format) => (&[format], SUM_BLEND, None),
            SplatOutput::Merge => return self.merge.descriptor(),
        };
        let mut fragment = fragment(&self.shader, shader_defs.clone(), formats, Some(blend));
        if output == SplatOutput::Fronts
            && let Some(Some(layers)) = fragment.targets.first_mut()
        {
            layers.write_mask = ColorWrites::RED;
        }
        RenderPipelineDescriptor {
            depth_stencil: compare.and_then(|compare| depth_state(true, compare)),
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

impl Stage for SplatPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    type State = DepthTextures;

    fn keys(&self, variant: &Variant) -> Vec<SplatKey> {
        let plan = &variant.plan;
        let layers: &[_] = match (self.max_blend, plan.backs()) {
            (true, true) => &[SplatOutput::Layers],
            (true, false) => &[SplatOutput::Fronts],
            (false, true) => &[SplatOutput::FrontDepth, SplatOutput::BackDepth],
            (false, false) => &[SplatOutput::FrontDepth],
        };
        let merge = (!self.max_blend).then_some(SplatOutput::Merge);
        let covers = plan.antialiasing.covers();
        let coverage = (covers && !self.max_blend).then_some(SplatOutput::Coverage);
        let counted = variant.debug_view == Some(FluidDebugView::Overdraw);
        let count = counted.then_some(SplatOutput::Count(self.sum_format));
        let outputs = layers.iter().copied().chain(merge);
        let outputs = outputs.chain(coverage).chain(count);
        let key = |output| SplatKey {
            output,
            cut: plan.cut && output != SplatOutput::Merge,
            covers: covers
                && matches!(
                    output,
                    SplatOutput::Layers | SplatOutput::Fronts | SplatOutput::Coverage
                ),
        };
        outputs.map(key).collect()
    }

    /// The near plane may cut splats at any time.
    fn ahead(key: &SplatKey) -> Option<SplatKey> {
        let splats = key.output != SplatOutput::Merge;
        splats.then_some(SplatKey {
            cut: !key.cut,
            ..*key
        })
    }

    fn prepare(&self, textures: &mut DepthTextures, _: &Surface, layers: &Layers, inputs: &Inputs) {
        if !self.max_blend {
            textures.prepare(&self.merge, layers, inputs.gpu);
        }
    }
}
