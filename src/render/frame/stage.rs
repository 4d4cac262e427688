//! Stages: what makes passes over surfaces, with pipelines that depend on a surface's variant.

use bevy::{
    prelude::*,
    render::{
        GpuResourceAppExt, Render, RenderApp, RenderStartup, RenderSystems,
        diagnostic::RecordDiagnostics,
        render_resource::{
            CachedRenderPipelineId, PipelineCache, RenderPipeline, ShaderType,
            SpecializedRenderPipeline, SpecializedRenderPipelines, encase::internal::WriteInto,
        },
        renderer::RenderContext,
    },
};

use super::{FrameStartup, Gpu, Input, Layers, Offset, Placeholder, Target, UniformArray};
use crate::render::surface::{Surface, SurfaceSystems, Variant, reasons::Waiting};

/// A stage; its resource makes its pipelines.
pub(crate) trait Stage:
    SpecializedRenderPipeline<Key: Send + Sync> + Resource + FromWorld
{
    /// Of its passes.
    const LABEL: &'static str;
    /// A surface's parameters.
    type Uniform: ShaderType + WriteInto + Copy + PartialEq + Send + Sync + 'static;
    /// A surface's bind groups, and textures that no other stage reads.
    type State: Default + Send + Sync + 'static;

    /// The keys of the pipelines that draw a variant, in the order of the draws.
    fn keys(&self, variant: &Variant) -> Vec<Self::Key>;

    /// The key of a pipeline that may be needed soon: requested as well, but not waited for.
    fn ahead(_key: &Self::Key) -> Option<Self::Key> {
        None
    }

    /// `None` without parameters.
    fn uniform(_surface: &Surface) -> Option<Self::Uniform> {
        None
    }

    /// Updates textures and bind groups whose inputs have changed.
    fn prepare(
        &self,
        _state: &mut Self::State,
        _surface: &Surface,
        _layers: &Layers,
        _inputs: &Inputs,
    ) {
    }
}

/// For stages without parameters.
pub(crate) type NoUniform = u32;

/// What bind groups are made of, besides layers.
pub(crate) struct Inputs<'a> {
    pub(crate) gpu: &'a Gpu<'a>,
    /// The stage's parameters.
    pub(crate) uniform: Input<'a>,
    placeholder: &'a Placeholder,
}

impl<'a> Inputs<'a> {
    /// A texture, or "nothing here" where the surface lacks it.
    pub(crate) fn or_nothing(&self, target: &'a Option<Target>) -> Input<'a> {
        self.placeholder.or(target)
    }
}

/// Adds a stage to all surfaces.
pub(crate) fn add_stage<S: Stage>(app: &mut App) {
    let Some(render_app) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    render_app
        .init_gpu_resource::<SpecializedRenderPipelines<S>>()
        .init_gpu_resource::<Uniforms<S>>()
        .add_systems(RenderStartup, init::<S>.after(FrameStartup))
        .add_systems(
            Render,
            (
                request::<S>.in_set(SurfaceSystems::Request),
                prepare_uniforms::<S>.in_set(SurfaceSystems::Resources),
                prepare::<S>.in_set(RenderSystems::PrepareBindGroups),
            ),
        );
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Kept<S>>();
}

fn init<S: Stage>(world: &mut World) {
    let stage = S::from_world(world);
    world.insert_resource(stage);
}

/// What a stage keeps on a surface: its state, and pipelines of the wanted variant and of the one
/// that is drawn meanwhile.
#[derive(Component)]
pub(crate) struct Kept<S: Stage> {
    pub(crate) offset: Offset,
    pub(crate) state: S::State,
    slots: [Option<Slot<S>>; 2],
}

struct Slot<S: Stage> {
    variant: Variant,
    pipelines: Vec<(S::Key, CachedRenderPipelineId)>,
}

impl<S: Stage> Default for Kept<S> {
    fn default() -> Self {
        Self {
            offset: default(),
            state: default(),
            slots: [None, None],
        }
    }
}

impl<S: Stage> Kept<S> {
    fn of(&self, variant: &Variant) -> Option<&Slot<S>> {
        let mut known = self.slots.iter().flatten();
        known.find(|slot| slot.variant == *variant)
    }

    /// The pipelines to draw with, by their keys; none while the surface is not drawn.
    pub(crate) fn pipelines(&self, surface: &Surface) -> &[(S::Key, CachedRenderPipelineId)] {
        let slot = surface.drawn.as_ref().and_then(|drawn| self.of(drawn));
        slot.map_or(&[], |slot| &slot.pipelines)
    }

    /// The first pipeline to draw with whose key is wanted.
    pub(crate) fn id(
        &self,
        surface: &Surface,
        is_wanted: impl Fn(&S::Key) -> bool,
    ) -> Option<CachedRenderPipelineId> {
        let mut pipelines = self.pipelines(surface).iter();
        pipelines.find(|(key, _)| is_wanted(key)).map(|(_, id)| *id)
    }

    /// The pipeline of a stage that draws with one.
    pub(crate) fn only<'a>(
        &self,
        surface: &Surface,
        cache: &'a PipelineCache,
    ) -> Option<&'a RenderPipeline> {
        cache.get_render_pipeline(self.id(surface, |_| true)?)
    }
}

/// Requests pipelines of new variants, and makes surfaces wait until those are compiled.
fn request<S: Stage>(
    mut surfaces: Query<(&mut Surface, &mut Kept<S>)>,
    stage: Res<S>,
    mut specialized: ResMut<SpecializedRenderPipelines<S>>,
    mut cache: ResMut<PipelineCache>,
) {
    for (mut surface, mut kept) in &mut surfaces {
        let needed = [Some(surface.wanted), surface.drawn];
        for variant in needed.into_iter().flatten() {
            if kept.of(&variant).is_some() {
                continue;
            }
            let first = kept.slots[0].as_ref().map(|slot| slot.variant);
            let spare = usize::from(first.is_some() && needed.contains(&first));
            let mut request = |key| specialized.specialize(&cache, &stage, key);
            let mut pipelines = Vec::new();
            for key in stage.keys(&variant) {
                S::ahead(&key).map(&mut request);
                pipelines.push((key.clone(), request(key)));
            }
            kept.slots[spare] = Some(Slot { variant, pipelines });
        }
        let vanishes = surface.vanishes();
        let wanted = kept.of(&surface.wanted);
        for (_, id) in wanted.iter().flat_map(|slot| &slot.pipelines) {
            if vanishes {
                cache.block_on_render_pipeline(*id);
            }
            if cache.get_render_pipeline(*id).is_none() {
                surface.waiting =
                    Some(Waiting::new(S::LABEL, cache.get_render_pipeline_state(*id)));
            }
        }
    }
}

/// A stage's parameters of all surfaces.
#[derive(Resource)]
struct Uniforms<S: Stage>(UniformArray<S::Uniform>);

impl<S: Stage> Default for Uniforms<S> {
    fn default() -> Self {
        Self(default())
    }
}

fn prepare_uniforms<S: Stage>(
    mut surfaces: Query<(&Surface, &mut Kept<S>)>,
    mut uniforms: ResMut<Uniforms<S>>,
    gpu: Gpu,
) {
    let Uniforms(uniforms) = &mut *uniforms;
    uniforms.clear();
    for (surface, mut kept) in &mut surfaces {
        if let Some(uniform) = S::uniform(surface) {
            kept.offset = uniforms.push(uniform);
        }
    }
    uniforms.write(&gpu);
}

fn prepare<S: Stage>(
    mut surfaces: Query<(&Surface, &Layers, &mut Kept<S>)>,
    stage: Res<S>,
    uniforms: Res<Uniforms<S>>,
    placeholder: Res<Placeholder>,
    gpu: Gpu,
) {
    for (surface, layers, mut kept) in &mut surfaces {
        let inputs = Inputs {
            gpu: &gpu,
            uniform: uniforms.0.input(),
            placeholder: &placeholder,
        };
        stage.prepare(&mut kept.state, surface, layers, &inputs);
    }
}

/// Times what a pass records, under its label.
pub(crate) fn timed(
    ctx: &mut RenderContext,
    label: &'static str,
    record: impl FnOnce(&mut RenderContext),
) {
    let recorder = ctx.diagnostic_recorder();
    let recorder = recorder.as_deref();
    let span = recorder.time_span(ctx.command_encoder(), label);
    record(ctx);
    span.end(ctx.command_encoder());
}
