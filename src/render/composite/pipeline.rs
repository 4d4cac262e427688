//! Pipelines of the composite.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT,
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId, CompareFunction,
        DepthStencilState, MultisampleState, RenderPipelineDescriptor, SamplerBindingType,
        ShaderStages, SpecializedRenderPipeline, TextureFormat, TextureSampleType,
        binding_types::{sampler, texture_2d},
    },
};

use crate::render::{
    frame::{
        FrameLayout, Stage,
        pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
    },
    lighting::LightingLayout,
    surface::Variant,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct CompositeKey {
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    pub(crate) part: CompositePart,
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

    fn light(self) -> bool {
        matches!(self, Self::Whole | Self::Light)
    }
}

#[derive(Resource)]
pub(crate) struct CompositePipeline {
    frame: FrameLayout,
    lighting: BindGroupLayoutDescriptor,
    pub(super) layout: BindGroupLayoutDescriptor,
    /// The scene's colour as it is, and as it was before any surface.
    pub(super) scene: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

pub(super) fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    lighting: Res<LightingLayout>,
) {
    let filtered = || texture_2d(TextureSampleType::Float { filterable: true });
    commands.insert_resource(CompositePipeline {
        frame: frame.clone(),
        lighting: lighting.0.clone(),
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
        shader: load_embedded_asset!(assets.as_ref(), "composite.wgsl"),
    });
}

impl SpecializedRenderPipeline for CompositePipeline {
    type Key = CompositeKey;

    fn specialize(&self, key: CompositeKey) -> RenderPipelineDescriptor {
        let shader_defs = defs([
            ("DEPTH_ALONE", !key.part.light()),
            ("SEVERAL", key.several),
            ("DENSE", key.part == CompositePart::DenseDepth),
        ]);
        let formats: &[_] = if key.part.light() { &[key.format] } else { &[] };
        let layouts = [&self.layout, &self.lighting, &self.scene].map(Clone::clone);
        RenderPipelineDescriptor {
            depth_stencil: Some(DepthStencilState {
                format: CORE_3D_DEPTH_FORMAT,
                // Transparent objects and later passes are depth-tested against the liquid.
                depth_write_enabled: Some(key.part.depth()),
                depth_compare: Some(CompareFunction::GreaterEqual),
                stencil: default(),
                bias: default(),
            }),
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

/// The pipelines of a surface.
pub(crate) struct CompositePipelines {
    pub(super) light: CachedRenderPipelineId,
    /// Where light and depth are written separately.
    pub(super) depth: Option<CachedRenderPipelineId>,
}

impl Stage for CompositePipeline {
    type Pipelines = CompositePipelines;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(CompositeKey) -> CachedRenderPipelineId,
    ) -> CompositePipelines {
        let plan = &variant.plan;
        let mut part = |part| {
            request(CompositeKey {
                format: variant.format,
                samples: variant.samples,
                part,
                several: variant.several,
            })
        };
        let (light, depth) = match (plan.index_one, variant.several) {
            (true, _) => (CompositePart::Light, Some(CompositePart::DenseDepth)),
            (false, true) => (CompositePart::Light, Some(CompositePart::Depth)),
            (false, false) => (CompositePart::Whole, None),
        };
        CompositePipelines {
            light: part(light),
            depth: depth.map(part),
        }
    }

    fn ids(pipelines: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        [pipelines.light].into_iter().chain(pipelines.depth)
    }
}
