//! Pipelines of the composite.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, CompareFunction, MultisampleState,
        RenderPipelineDescriptor, ShaderStages, SpecializedRenderPipeline, TextureFormat,
    },
    shader::ShaderDefVal,
};

use super::{SPAN, scene::SceneColorLayout};
use crate::render::{
    frame::{
        FrameLayout, Group, Input, Inputs, Layers, NoUniform, Stage,
        pipelines::{Tiles, defs, depth_state, fragment, tile_pipeline, unfiltered},
    },
    lighting::LightingLayout,
    refract::layer_defs,
    surface::{Surface, Variant},
};
use crate::settings::Antialiasing;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CompositeKey {
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    pub(crate) part: CompositePart,
    /// Whether pixels that the liquid covers in part are blended with the background.
    pub(crate) covers: bool,
    /// Whether there are bulk and spray.
    pub(crate) bulk: bool,
    pub(crate) spray: bool,
    /// The light of pixels is averaged whose neighbours differ: over them, and over so many rays.
    pub(crate) resolve: Option<u32>,
}

/// What is written. If surfaces wrote their depth at once, one painted later would be cut off
/// where it is behind; and pixels that are hardly covered have light, but no depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum CompositePart {
    /// Light and depth: the only surface, with hard edges.
    Whole,
    /// Light alone.
    Light,
    /// Depth alone, once all surfaces' light is there.
    Depth,
    /// Depth alone, where more than half of the background is hidden: transparent objects drawn
    /// later are hidden by dense smoke, but not by thin smoke.
    DenseDepth,
}

impl CompositePart {
    fn depth(self) -> bool {
        self != Self::Light
    }

    pub(super) fn light(self) -> bool {
        matches!(self, Self::Whole | Self::Light)
    }
}

#[derive(Resource)]
pub(crate) struct CompositePipeline {
    frame: FrameLayout,
    lighting: BindGroupLayoutDescriptor,
    layout: BindGroupLayoutDescriptor,
    scene: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

impl FromWorld for CompositePipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            lighting: world.resource::<LightingLayout>().0.clone(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_composite_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                    ),
                ),
            ),
            scene: world.resource::<SceneColorLayout>().0.clone(),
            shader: load_embedded_asset!(world, "composite.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for CompositePipeline {
    type Key = CompositeKey;

    fn specialize(&self, key: CompositeKey) -> RenderPipelineDescriptor {
        let mut shader_defs = defs([
            ("DEPTH_ALONE", !key.part.light()),
            ("COVERAGE", key.covers),
            ("DENSE", key.part == CompositePart::DenseDepth),
        ]);
        shader_defs.extend(layer_defs(key.bulk, key.spray));
        if let Some(rays) = key.resolve {
            shader_defs.extend(defs([("RESOLVE", true), ("MORE_RAYS", rays > 0)]));
            shader_defs.push(ShaderDefVal::UInt("RAYS".into(), rays));
        }
        let formats: &[_] = if key.part.light() { &[key.format] } else { &[] };
        // The scene's colour is group 3 for all that reads it; light is read by those before.
        let layouts = [&self.layout, &self.lighting, &self.scene].map(Clone::clone);
        RenderPipelineDescriptor {
            // Transparent objects and later passes are depth-tested against the liquid.
            depth_stencil: depth_state(key.part.depth(), CompareFunction::GreaterEqual),
            multisample: MultisampleState {
                count: key.samples,
                ..default()
            },
            ..tile_pipeline(
                "fluid_composite_pipeline",
                &self.frame,
                layouts,
                Tiles::LiquidInCamera,
                fragment(&self.shader, shader_defs, formats, None),
            )
        }
    }
}

impl Stage for CompositePipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    type State = Group;

    fn keys(&self, variant: &Variant) -> Vec<CompositeKey> {
        let covers = variant.plan.antialiasing.covers();
        let parts: &[_] = match (variant.plan.index_one, variant.several || covers) {
            (true, _) => &[CompositePart::Light, CompositePart::DenseDepth],
            (false, true) => &[CompositePart::Light, CompositePart::Depth],
            (false, false) => &[CompositePart::Whole],
        };
        let key = |&part| CompositeKey {
            format: variant.format,
            samples: variant.samples,
            part,
            covers,
            bulk: variant.plan.bulk,
            spray: variant.plan.spray,
            resolve: match variant.plan.antialiasing {
                Antialiasing::Full { rays } if part.light() => Some(rays),
                _ => None,
            },
        };
        parts.iter().map(key).collect()
    }

    fn prepare(&self, group: &mut Group, _: &Surface, layers: &Layers, inputs: &Inputs) {
        let lit = [
            inputs.or_nothing(&layers.bulk),
            Input::texture(layers.radiance.as_ref()),
            inputs.or_nothing(&layers.spray),
            Input::texture(layers.transmission.as_ref()),
            Input::texture(layers.light.as_ref()),
            inputs.or_nothing(&layers.coverage),
        ];
        group.prepare(inputs.gpu, SPAN, &self.layout, &lit);
    }
}
