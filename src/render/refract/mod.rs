//! Rays through the layers: radiance, transmission and exit ray of every pixel of liquid.

mod exit;
mod status;

use bevy::{
    asset::{embedded_asset, load_embedded_asset},
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        render_resource::{
            BindGroupLayoutDescriptor, BindGroupLayoutEntries, CachedRenderPipelineId,
            PipelineCache, RenderPipelineDescriptor, ShaderStages, ShaderType,
            SpecializedRenderPipeline, binding_types::uniform_buffer,
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
        EXIT_FORMAT, Frame, FrameLayout, FrameStartup, Gpu, Group, Input, Kept, Layers, Offset,
        Placeholder, RADIANCE_FORMAT, Stage, TRANSMISSION_FORMAT, UniformArray, add_stage, cleared,
        pipelines::{Tiles, defs, fragment, tile_pipeline, unfiltered},
        timed,
    },
    lighting::{LightingLayout, ViewLighting},
    surface::{
        Surface, SurfaceSystems, Variant, ViewSurfaces,
        plan::{MediumTerms, Plan},
    },
};
use crate::settings::{Fresnel, ScreenSpaceFluid, Search};

/// Name of the pass's time span.
pub(crate) const SPAN: &str = "fluid_refract";

/// `Tracing` in `layers.wgsl`.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
struct GpuTracing {
    coarse_samples: u32,
    contact: f32,
}

impl GpuTracing {
    /// For particles of `radius` in view units.
    fn new(settings: &ScreenSpaceFluid, radius: f32) -> Self {
        Self {
            coarse_samples: match settings.search {
                Search::Secant => 0,
                Search::Bracketed { coarse_samples } => coarse_samples,
            },
            contact: settings.contact * radius,
        }
    }
}

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
pub(super) struct RefractPipeline {
    frame: FrameLayout,
    lighting: BindGroupLayoutDescriptor,
    /// Layers and normals of bulk and spray, thickness, and the search's parameters.
    layout: BindGroupLayoutDescriptor,
    shader: Handle<Shader>,
}

#[derive(Component, Default)]
pub(super) struct Refract {
    offset: Offset,
    group: Group,
}

pub(super) fn plugin(app: &mut App) {
    load_shader_library!(app, "inside.wgsl");
    load_shader_library!(app, "layers.wgsl");
    load_shader_library!(app, "track.wgsl");
    load_shader_library!(app, "search.wgsl");
    embedded_asset!(app, "refract.wgsl");
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<UniformArray<GpuTracing>>()
        .add_systems(RenderStartup, init_pipeline.after(FrameStartup))
        .add_systems(
            Render,
            (
                prepare_uniforms.in_set(SurfaceSystems::Resources),
                prepare_groups.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    add_stage::<RefractPipeline>(render_app);
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Refract>();
}

fn init_pipeline(
    mut commands: Commands,
    assets: Res<AssetServer>,
    frame: Res<FrameLayout>,
    lighting: Res<LightingLayout>,
) {
    commands.insert_resource(RefractPipeline {
        frame: frame.clone(),
        lighting: lighting.0.clone(),
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
                    uniform_buffer::<GpuTracing>(true),
                ),
            ),
        ),
        shader: load_embedded_asset!(assets.as_ref(), "refract.wgsl"),
    });
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
    type Pipelines = CachedRenderPipelineId;

    fn pipelines(
        &self,
        variant: &Variant,
        mut request: impl FnMut(RefractKey) -> CachedRenderPipelineId,
    ) -> CachedRenderPipelineId {
        request(RefractKey::new(&variant.plan, &variant.settings))
    }

    fn ids(pipeline: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId> {
        [*pipeline].into_iter()
    }
}

fn prepare_uniforms(
    mut surfaces: Query<(&Surface, &mut Refract)>,
    mut uniforms: ResMut<UniformArray<GpuTracing>>,
    gpu: Gpu,
) {
    uniforms.clear();
    for (surface, mut refract) in &mut surfaces {
        if let Some(variant) = &surface.drawn {
            let radius = surface.uniform.radius;
            refract.offset = uniforms.push(GpuTracing::new(&variant.settings, radius));
        }
    }
    uniforms.write(&gpu);
}

fn prepare_groups(
    mut surfaces: Query<(&Layers, &mut Refract)>,
    pipeline: Res<RefractPipeline>,
    placeholder: Res<Placeholder>,
    uniforms: Res<UniformArray<GpuTracing>>,
    gpu: Gpu,
) {
    for (layers, mut refract) in &mut surfaces {
        let or_nothing = |target| Input::texture_or(target, &placeholder);
        let inputs = [
            or_nothing(&layers.bulk),
            or_nothing(&layers.bulk_normals),
            or_nothing(&layers.spray),
            or_nothing(&layers.spray_normals),
            or_nothing(&layers.thickness),
            uniforms.input(),
        ];
        refract
            .group
            .prepare(&gpu, "fluid_refract", &pipeline.layout, &inputs);
    }
}

/// The pass: all surfaces of the view.
pub(super) fn refract(
    view: ViewQuery<(&ViewSurfaces, &ViewLighting)>,
    surfaces: Query<(&Surface, &Frame, &Layers, &Refract, &Kept<RefractPipeline>)>,
    cache: Res<PipelineCache>,
    mut ctx: RenderContext,
) {
    let (view, lighting) = view.into_inner();
    timed(&mut ctx, SPAN, |ctx| {
        for (surface, frame, layers, refract, pipeline) in surfaces.iter_many(&view.surfaces) {
            let pipeline = pipeline.drawn(surface);
            let (Some(pipeline), Some(group), Some((light, light_offset))) = (
                pipeline.and_then(|&id| cache.get_render_pipeline(id)),
                refract.group.get(),
                lighting.get(),
            ) else {
                continue;
            };
            let targets = [&layers.radiance, &layers.transmission, &layers.exits];
            let targets =
                targets.map(|target| target.as_ref().and_then(|it| cleared(it, [0.0; 4])));
            let mut pass = frame.begin(ctx, SPAN, &targets, None, pipeline);
            pass.set_bind_group(1, group, &[refract.offset.bytes()]);
            pass.set_bind_group(2, light, &light_offset);
            frame.draw_tiles(&mut pass);
        }
    });
}
