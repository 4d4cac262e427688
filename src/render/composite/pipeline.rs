//! Pipelines of the composite.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, CompareFunction, MultisampleState,
        RenderPipelineDescriptor, SamplerBindingType, ShaderStages, SpecializedRenderPipeline,
        TextureFormat, TextureSampleType,
        binding_types::{sampler, texture_2d},
    },
};

use super::SPAN;
use crate::render::{
    frame::{
        FrameLayout, Group, Input, Inputs, Layers, NoUniform, Stage,
        pipelines::{Tiles, defs, depth_state, fragment, tile_pipeline, unfiltered},
    },
    lighting::LightingLayout,
    surface::{Surface, Variant},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CompositeKey {
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    pub(crate) part: CompositePart,
    /// Whether the view has fog, and an atmosphere.
    pub(crate) fog: bool,
    pub(crate) atmosphere: bool,
    /// Whether there are other surfaces, which may be visible through this one.
    pub(crate) several: bool,
}

/// What is written. If surfaces wrote their depth at once, one painted later would be cut off
/// where it is behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum CompositePart {
    /// Light and depth: the only surface.
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
    /// The scene's colour as it is, and as it was before any surface.
    pub(super) scene: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

impl FromWorld for CompositePipeline {
    fn from_world(world: &mut World) -> Self {
        let filtered = || texture_2d(TextureSampleType::Float { filterable: true });
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
                        texture_2d(TextureSampleType::Uint),
                        unfiltered(),
                        unfiltered(),
                    ),
                ),
            ),
            scene: BindGroupLayoutDescriptor::new(
                "fluid_scene_color_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (
                        filtered(),
                        filtered(),
                        sampler(SamplerBindingType::Filtering),
                    ),
                ),
            ),
            shader: load_embedded_asset!(world, "composite.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for CompositePipeline {
    type Key = CompositeKey;

    fn specialize(&self, key: CompositeKey) -> RenderPipelineDescriptor {
        let shader_defs = defs([
            ("DEPTH_ALONE", !key.part.light()),
            ("SEVERAL", key.several),
            ("HAZE", key.fog || key.atmosphere),
            ("ATMOSPHERE", key.atmosphere),
            ("DENSE", key.part == CompositePart::DenseDepth),
        ]);
        let formats: &[_] = if key.part.light() { &[key.format] } else { &[] };
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
        let parts: &[_] = match (variant.plan.index_one, variant.several) {
            (true, _) => &[CompositePart::Light, CompositePart::DenseDepth],
            (false, true) => &[CompositePart::Light, CompositePart::Depth],
            (false, false) => &[CompositePart::Whole],
        };
        let key = |&part| CompositeKey {
            format: variant.format,
            samples: variant.samples,
            part,
            fog: variant.fog,
            atmosphere: variant.atmosphere,
            several: variant.several,
        };
        parts.iter().map(key).collect()
    }

    fn prepare(&self, group: &mut Group, _: &Surface, layers: &Layers, inputs: &Inputs) {
        let refracted = [
            Input::texture(layers.radiance.as_ref()),
            Input::texture(layers.transmission.as_ref()),
            Input::texture(layers.exits.as_ref()),
            inputs.or_nothing(&layers.bulk),
            inputs.or_nothing(&layers.spray),
        ];
        group.prepare(inputs.gpu, SPAN, &self.layout, &refracted);
    }
}
