//! Stages: what makes passes over surfaces, with pipelines that depend on a surface's variant.

use bevy::{
    app::SubApp,
    prelude::*,
    render::{
        GpuResourceAppExt, Render,
        diagnostic::RecordDiagnostics,
        render_resource::{
            CachedRenderPipelineId, PipelineCache, SpecializedRenderPipeline,
            SpecializedRenderPipelines,
        },
        renderer::RenderContext,
    },
};

use crate::render::surface::{Surface, SurfaceSystems, Variant};

/// A stage; its resource makes its pipelines.
pub(crate) trait Stage: SpecializedRenderPipeline<Key: Send + Sync> + Resource {
    /// All pipelines for one variant of a surface.
    type Pipelines: Send + Sync + 'static;

    /// Requests the pipelines of a variant, each by its key.
    fn pipelines(
        &self,
        variant: &Variant,
        request: impl FnMut(Self::Key) -> CachedRenderPipelineId,
    ) -> Self::Pipelines;

    /// All of them, to tell whether they are compiled.
    fn ids(pipelines: &Self::Pipelines) -> impl Iterator<Item = CachedRenderPipelineId>;
}

/// Gives a stage's pipelines to all surfaces.
pub(crate) fn add_stage<S: Stage>(render_app: &mut SubApp) {
    render_app
        .init_gpu_resource::<SpecializedRenderPipelines<S>>()
        .add_systems(Render, request::<S>.in_set(SurfaceSystems::Request));
    let world = render_app.world_mut();
    world.register_required_components::<Surface, Kept<S>>();
}

/// A stage's pipelines on a surface: of the wanted variant, and of the one that is drawn meanwhile.
#[derive(Component)]
pub(crate) struct Kept<S: Stage>([Option<(Variant, S::Pipelines)>; 2]);

impl<S: Stage> Default for Kept<S> {
    fn default() -> Self {
        Self([None, None])
    }
}

impl<S: Stage> Kept<S> {
    fn of(&self, variant: &Variant) -> Option<&S::Pipelines> {
        let mut known = self.0.iter().flatten();
        known.find(|(it, _)| it == variant).map(|(_, of)| of)
    }

    /// The pipelines to draw with; `None` while the surface is not drawn.
    pub(crate) fn drawn(&self, surface: &Surface) -> Option<&S::Pipelines> {
        self.of(surface.drawn.as_ref()?)
    }
}

/// Requests pipelines of new variants, and makes surfaces wait until those are compiled.
fn request<S: Stage>(
    mut surfaces: Query<(&mut Surface, &mut Kept<S>)>,
    stage: Res<S>,
    mut specialized: ResMut<SpecializedRenderPipelines<S>>,
    cache: Res<PipelineCache>,
) {
    for (mut surface, mut kept) in &mut surfaces {
        let needed = [Some(surface.wanted), surface.drawn];
        for variant in needed.into_iter().flatten() {
            if kept.of(&variant).is_some() {
                continue;
            }
            let is_needed = |slot: &Option<(Variant, _)>| {
                let variant = slot.as_ref().map(|(variant, _)| *variant);
                variant.is_some() && needed.contains(&variant)
            };
            let spare = usize::from(is_needed(&kept.0[0]));
            let pipelines =
                stage.pipelines(&variant, |key| specialized.specialize(&cache, &stage, key));
            kept.0[spare] = Some((variant, pipelines));
        }
        let compiled =
            |pipelines| S::ids(pipelines).all(|id| cache.get_render_pipeline(id).is_some());
        if !kept.of(&surface.wanted).is_some_and(compiled) {
            surface.waiting = true;
        }
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
