//! Rays through the layers: radiance, transmission and exit ray of every pixel of liquid.

use bevy::{
    asset::load_embedded_asset,
    core_pipeline::FullscreenShader,
    prelude::*,
    render::{
        diagnostic::RecordDiagnostics,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, PipelineCache, RenderPassDescriptor,
            RenderPipelineDescriptor, SamplerBindingType, ShaderStages, SpecializedRenderPipeline,
            TextureSampleType, VertexState,
            binding_types::{sampler, texture_2d, texture_cube},
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::{Shader, ShaderDefVal},
};

use super::{
    bindings::{cleared, common_layout, defs, fragment},
    bodies::ViewBodies,
    layers::{EXIT_FORMAT, LIGHT_FORMAT},
    plan::{MediumTerms, Plan},
};
use crate::settings::{Fresnel, ScreenSpaceFluid, Search};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct RefractKey {
    pub(crate) interfaces: u32,
    pub(crate) bulk: bool,
    pub(crate) spray: bool,
    pub(crate) index_one: bool,
    pub(crate) secant: bool,
    pub(crate) schlick: bool,
    pub(crate) accumulated: bool,
    pub(crate) opaque: bool,
    pub(crate) terms: MediumTerms,
}

impl RefractKey {
    pub(crate) fn new(plan: &Plan, settings: &ScreenSpaceFluid) -> Self {
        Self {
            interfaces: plan.interfaces,
            bulk: plan.bulk,
            spray: plan.spray,
            index_one: plan.index_one,
            secant: plan.interfaces > 1 && settings.search == Search::Secant,
            schlick: !plan.index_one && settings.fresnel == Fresnel::Schlick,
            accumulated: plan.accumulated,
            opaque: plan.opaque,
            terms: plan.terms,
        }
    }

    /// The conditions and numbers that the shader is compiled with.
    pub(crate) fn shader_defs(&self) -> Vec<ShaderDefVal> {
        let mut shader_defs = defs([
            ("BULK_LAYERS", self.bulk),
            ("SPRAY_LAYERS", self.spray),
            ("INDEX_ONE", self.index_one),
            ("SECANT", self.secant),
            ("SCHLICK", self.schlick),
            ("ACCUMULATED", self.accumulated),
            ("OPAQUE", self.opaque),
            ("EXTINCTION", self.terms.extinction),
            ("SCATTERING", self.terms.scattering),
            ("SOURCE", self.terms.source()),
        ]);
        shader_defs.push(ShaderDefVal::UInt("INTERFACES".into(), self.interfaces));
        let both = self.bulk && self.spray;
        shader_defs.push(ShaderDefVal::Bool("BOTH_CLASSES".into(), both));
        shader_defs
    }
}

#[derive(Resource)]
pub(crate) struct RefractPipeline {
    fullscreen: VertexState,
    /// Environment map, its sampler, layers and normals of bulk and spray, diffuse environment
    /// map, thickness.
    pub(crate) layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

pub(crate) fn init_refract_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    fullscreen: Res<FullscreenShader>,
) {
    let unfiltered = || texture_2d(TextureSampleType::Float { filterable: false });
    commands.insert_resource(RefractPipeline {
        fullscreen: fullscreen.to_vertex_state(),
        layout: BindGroupLayoutDescriptor::new(
            "fluid_refract_layout",
            &BindGroupLayoutEntries::sequential(
                ShaderStages::FRAGMENT,
                (
                    texture_cube(TextureSampleType::Float { filterable: true }),
                    sampler(SamplerBindingType::Filtering),
                    unfiltered(),
                    unfiltered(),
                    unfiltered(),
                    unfiltered(),
                    texture_cube(TextureSampleType::Float { filterable: true }),
                    unfiltered(),
                ),
            ),
        ),
        shader: load_embedded_asset!(assets.as_ref(), "refract.wgsl"),
    });
}

impl SpecializedRenderPipeline for RefractPipeline {
    type Key = RefractKey;

    fn specialize(&self, key: RefractKey) -> RenderPipelineDescriptor {
        RenderPipelineDescriptor {
            label: Some("fluid_refract_pipeline".into()),
            layout: vec![common_layout(), self.layout.clone()],
            vertex: self.fullscreen.clone(),
            fragment: Some(fragment(
                &self.shader,
                key.shader_defs(),
                &[LIGHT_FORMAT, LIGHT_FORMAT, EXIT_FORMAT],
                None,
            )),
            ..default()
        }
    }
}

/// The pass: all bodies of the view.
pub(crate) fn refract(
    view: ViewQuery<&ViewBodies>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let bodies = view.into_inner();
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), "fluid_refract");
    for body in bodies.ready() {
        let (Some(pipeline), Some(group)) = (
            cache.get_render_pipeline(body.pipelines.refract),
            &body.groups.refract,
        ) else {
            continue;
        };
        let layers = &body.layers;
        let mut pass = ctx.begin_tracked_render_pass(RenderPassDescriptor {
            label: Some("fluid_refract"),
            color_attachments: &[
                Some(cleared(&layers.radiance.default_view, [0.0; 4])),
                Some(cleared(&layers.transmission.default_view, [0.0; 4])),
                Some(cleared(&layers.exits.default_view, [0.0; 4])),
            ],
            ..default()
        });
        body.set_scissor(&mut pass);
        pass.set_render_pipeline(pipeline);
        body.set_common(&mut pass);
        pass.set_bind_group(1, group, &[]);
        pass.draw(0..3, 0..1);
    }
    span.end(ctx.command_encoder());
}
