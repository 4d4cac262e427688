//! Rays through the layers: radiance, transmission and exit ray of every pixel of liquid.

mod exit;
mod status;

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, PipelineCache,
            RenderPipelineDescriptor, ShaderStages, SpecializedRenderPipeline,
        },
        renderer::{RenderContext, ViewQuery},
    },
    shader::{ShaderDefVal, load_shader_library},
};

pub use self::{
    exit::{ExitRay, decode_normal, encode_normal},
    status::SearchStatus,
};
use super::{
    frame::{
        EXIT_FORMAT, Frame, FrameLayout, Group, Inputs, Kept, Layers, NoUniform, RADIANCE_FORMAT,
        Stage, TRANSMISSION_FORMAT, add_stage, cleared,
        pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
        timed,
    },
    lighting::{LightingLayout, ViewLighting},
    surface::{
        Surface, Variant, ViewSurfaces,
        plan::{MediumTerms, Plan},
    },
};
use crate::settings::{Fresnel, ScreenSpaceFluid, Search};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_refract";

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
        let mut shader_defs = layer_defs(self.bulk, self.spray);
        shader_defs.extend(defs([
            ("INDEX_ONE", self.index_one),
            ("SECANT", self.secant),
            ("SCHLICK", self.schlick),
            ("ACCUMULATED", self.accumulated),
            ("OPAQUE", self.opaque),
            ("EXTINCTION", self.terms.extinction),
            ("SCATTERING", self.terms.scattering),
            ("SOURCE", self.terms.source()),
        ]));
        shader_defs.push(ShaderDefVal::UInt("INTERFACES".into(), self.interfaces));
        let both = self.bulk && self.spray;
        shader_defs.push(ShaderDefVal::Bool("BOTH_CLASSES".into(), both));
        shader_defs
    }
}

/// For shaders that read layers: which of them there are.
pub(crate) fn layer_defs(bulk: bool, spray: bool) -> Vec<ShaderDefVal> {
    defs([("BULK_LAYERS", bulk), ("SPRAY_LAYERS", spray)])
}

#[derive(Resource)]
pub(super) struct RefractPipeline {
    frame: FrameLayout,
    lighting: BindGroupLayoutDescriptor,
    /// Layers and normals of bulk and spray, and thickness.
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

pub(super) fn plugin(app: &mut App) {
    load_shader_library!(app, "inside.wgsl");
    load_shader_library!(app, "layers.wgsl");
    load_shader_library!(app, "track.wgsl");
    load_shader_library!(app, "search.wgsl");
    load_shader_library!(app, "trace.wgsl");
    embedded_asset!(app, "refract.wgsl");
    add_stage::<RefractPipeline>(app);
}

impl FromWorld for RefractPipeline {
    fn from_world(world: &mut World) -> Self {
        Self {
            frame: world.resource::<FrameLayout>().clone(),
            lighting: world.resource::<LightingLayout>().0.clone(),
            layout: BindGroupLayoutDescriptor::new(
                "fluid_refract_layout",
                &BindGroupLayoutEntries::sequential(
                    ShaderStages::FRAGMENT,
                    (
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                        unfiltered(),
                    ),
                ),
            ),
            shader: load_embedded_asset!(world, "refract.wgsl"),
        }
    }
}

impl SpecializedRenderPipeline for RefractPipeline {
    type Key = RefractKey;

    fn specialize(&self, key: RefractKey) -> RenderPipelineDescriptor {
        tile_pipeline(
            "fluid_refract_pipeline",
            &self.frame,
            [self.layout.clone(), self.lighting.clone()],
            Tiles::Liquid,
            fragment(
                &self.shader,
                key.shader_defs(),
                &[RADIANCE_FORMAT, TRANSMISSION_FORMAT, EXIT_FORMAT],
                None,
            ),
        )
    }
}

impl Stage for RefractPipeline {
    const LABEL: &'static str = SPAN;
    type Uniform = NoUniform;
    type State = Group;

    fn keys(&self, variant: &Variant) -> Vec<RefractKey> {
        vec![RefractKey::new(&variant.plan, &variant.settings)]
    }

    fn prepare(&self, group: &mut Group, _: &Surface, layers: &Layers, inputs: &Inputs) {
        let traced = [
            inputs.or_nothing(&layers.bulk),
            inputs.or_nothing(&layers.bulk_normals),
            inputs.or_nothing(&layers.spray),
            inputs.or_nothing(&layers.spray_normals),
            inputs.or_nothing(&layers.thickness),
        ];
        group.prepare(inputs.gpu, SPAN, &self.layout, &traced);
    }
}

/// The pass: all surfaces of the view.
pub(super) fn refract(
    view: ViewQuery<(&ViewSurfaces, &ViewLighting)>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Kept<RefractPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (view, lighting) = view.into_inner();
    timed(&mut ctx, SPAN, |ctx| {
        for (surface, frame, layers, kept) in surfaces.iter_many(&view.surfaces) {
            let (Some(pipeline), Some(group), Some((light, light_offset))) =
                (kept.only(surface, &cache), kept.state.get(), lighting.get())
            else {
                continue;
            };
            let targets = [&layers.radiance, &layers.transmission, &layers.exits];
            let targets =
                targets.map(|target| target.as_ref().and_then(|it| cleared(it, [0.0; 4])));
            let mut pass = frame.begin(ctx, SPAN, &targets, None, pipeline);
            pass.set_bind_group(1, group, &[]);
            pass.set_bind_group(2, light, &light_offset);
            frame.draw_tiles(&mut pass);
        }
    });
}
