//! Light of the pixels of liquid: their own, and that of the background at the ends of their rays.

use bevy::{
    asset::load_embedded_asset,
    prelude::*,
    render::render_resource::{
        BindGroupLayoutDescriptor, BindGroupLayoutEntries, RenderPipelineDescriptor, ShaderStages,
        SpecializedRenderPipeline, TextureSampleType, binding_types::texture_2d,
    },
    shader::ShaderDefVal,
};

use super::scene::SceneColorLayout;
use crate::render::{
    frame::{
        FrameLayout, Group, Input, Inputs, LIGHT_FORMAT, Layers, NoUniform, Stage,
        pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
    },
    lighting::LightingLayout,
    surface::{Surface, Variant},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ShadeKey {
    /// Whether the view has fog, and an atmosphere.
    pub(crate) fog: bool,
    pub(crate) atmosphere: bool,
    /// Whether there are other surfaces, which may be visible through this one.
    pub(crate) several: bool,
}

impl ShadeKey {
    pub(super) fn of(variant: &Variant) -> Self {
        Self {
            fog: variant.fog,
            atmosphere: variant.atmosphere,
            several: variant.several,
        }
    }

    pub(super) fn shader_defs(&self) -> Vec<ShaderDefVal> {
        defs([
            ("SEVERAL", self.several),
            ("HAZE", self.fog || self.atmosphere),
            ("ATMOSPHERE", self.atmosphere),
        ])
    }
}

#[derive(Resource)]
pub(crate) struct ShadePipeline {
    frame: FrameLayout,
    lighting: BindGroupLayoutDescriptor,
    layout: BindGroupLayoutDescriptor,
    scene: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

impl FromWorld for ShadePipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            lighting: world.resource::<LightingLayout>().0.clone(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_shade_layout",
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
            scene: world.resource::<SceneColorLayout>().0.clone(),
            shader: load_embedded_asset!(world, "shade.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for ShadePipeline {
    type Key = ShadeKey;

    fn specialize(&self, key: ShadeKey) -> RenderPipelineDescriptor {
        let layouts = [&self.layout, &self.lighting, &self.scene].map(Clone::clone);
        tile_pipeline(
            "fluid_shade_pipeline",
            &self.frame,
            layouts,
            Tiles::Liquid,
            fragment(&self.shader, key.shader_defs(), &[LIGHT_FORMAT], None),
        )
    }
}

impl Stage for ShadePipeline {
    const LABEL: &'static str = "fluid_shade";
    type Uniform = NoUniform;
    type State = Group;

    fn keys(&self, variant: &Variant) -> Vec<ShadeKey> {
        vec![ShadeKey::of(variant)]
    }

    fn prepare(&self, group: &mut Group, _: &Surface, layers: &Layers, inputs: &Inputs) {
        let refracted = [
            Input::texture(layers.radiance.as_ref()),
            Input::texture(layers.transmission.as_ref()),
            Input::texture(layers.exits.as_ref()),
            inputs.or_nothing(&layers.bulk),
            inputs.or_nothing(&layers.spray),
        ];
        group.prepare(inputs.gpu, Self::LABEL, &self.layout, &refracted);
    }
}
