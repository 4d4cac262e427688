//! Which pipelines a body's passes need.

use bevy::{
    ecs::system::SystemParam,
    platform::collections::HashMap,
    prelude::*,
    render::render_resource::{CachedRenderPipelineId, PipelineCache, SpecializedRenderPipelines},
};

use super::{
    composite::{CompositeKey, CompositePart, CompositePipeline},
    grouping::Member,
    normals::{BulkNormals, NormalSource, NormalsPipeline},
    plan::Plan,
    refract::{RefractKey, RefractPipeline},
    smooth::{SmoothPipeline, SmoothSteps},
    splat::{SplatKey, SplatOutput, SplatPipeline, SplatPipelines},
    support::FluidSupport,
    thickness::ThicknessPipeline,
};
use crate::settings::{FluidDebugView, ScreenSpaceFluid, Smoothing};

/// The pipelines of a body's passes.
pub(crate) struct BodyPipelines {
    pub(crate) splat: SplatPipelines,
    pub(crate) thickness: Option<CachedRenderPipelineId>,
    /// For the debug view that shows it.
    pub(crate) overdraw: Option<CachedRenderPipelineId>,
    pub(crate) smooth: Vec<CachedRenderPipelineId>,
    pub(crate) bulk_normals: BulkNormals,
    pub(crate) spray_normals: Option<CachedRenderPipelineId>,
    pub(crate) refract: CachedRenderPipelineId,
    pub(crate) composite: CachedRenderPipelineId,
    /// For bodies whose light and depth are written separately.
    pub(crate) composite_depth: Option<CachedRenderPipelineId>,
}

impl BodyPipelines {
    /// Whether all of them are compiled.
    pub(crate) fn ready(&self, cache: &PipelineCache) -> bool {
        let splat: &[_] = match &self.splat {
            SplatPipelines::MaxBlend(id) => &[*id],
            SplatPipelines::DepthDraws { front, back, merge } => {
                &[*front, *merge, back.unwrap_or(*front)]
            }
        };
        splat
            .iter()
            .chain(&self.thickness)
            .chain(&self.overdraw)
            .chain(&self.smooth)
            .chain(self.bulk_normals.pipelines())
            .chain(&self.spray_normals)
            .chain([&self.refract, &self.composite])
            .chain(&self.composite_depth)
            .all(|&id| cache.get_render_pipeline(id).is_some())
    }
}

/// All that decides which pipelines a body needs.
#[derive(Clone, Copy)]
pub(crate) struct Variant {
    pub(crate) plan: Plan,
    pub(crate) settings: ScreenSpaceFluid,
    pub(crate) composite: CompositeKey,
}

/// The pipelines of all passes, by key.
#[derive(SystemParam)]
pub(crate) struct Pipelines<'w, 's> {
    /// The variant that each fluid of each view was last drawn in, by view and fluid, and whether
    /// this frame has drawn it.
    last_drawn: Local<'s, HashMap<(Entity, Entity), (Variant, bool)>>,
    cache: Res<'w, PipelineCache>,
    splat: Res<'w, SplatPipeline>,
    splats: ResMut<'w, SpecializedRenderPipelines<SplatPipeline>>,
    thickness: Res<'w, ThicknessPipeline>,
    thicknesses: ResMut<'w, SpecializedRenderPipelines<ThicknessPipeline>>,
    smooth: Res<'w, SmoothPipeline>,
    smooths: ResMut<'w, SpecializedRenderPipelines<SmoothPipeline>>,
    normals: Res<'w, NormalsPipeline>,
    normalses: ResMut<'w, SpecializedRenderPipelines<NormalsPipeline>>,
    refract: Res<'w, RefractPipeline>,
    refracts: ResMut<'w, SpecializedRenderPipelines<RefractPipeline>>,
    composite: Res<'w, CompositePipeline>,
    composites: ResMut<'w, SpecializedRenderPipelines<CompositePipeline>>,
}

impl Pipelines<'_, '_> {
    /// The variant to draw a body in, and its pipelines: the last one while those of the wanted one
    /// are being compiled, so that the liquid does not vanish meanwhile.
    pub(crate) fn choose(
        &mut self,
        view: Entity,
        members: &[Member],
        wanted: Variant,
        support: &FluidSupport,
    ) -> (Variant, BodyPipelines) {
        let mut chosen = (wanted, self.of(&wanted, support));
        if !chosen.1.ready(&self.cache) {
            let known = |member: &Member| self.last_drawn.get(&(view, member.entity));
            let last = members.iter().find_map(known).map(|(variant, _)| *variant);
            match last.filter(|last| last.composite.fits(&wanted.composite)) {
                Some(last) => chosen = (last, self.of(&last, support)),
                None => return chosen,
            }
        }
        for member in members {
            self.last_drawn
                .insert((view, member.entity), (chosen.0, true));
        }
        chosen
    }

    /// Forgets what this frame has not drawn.
    pub(crate) fn end_frame(&mut self) {
        self.last_drawn
            .retain(|_, (_, drawn)| core::mem::take(drawn));
    }

    /// Requests both forms at once, so that neither has to be waited for when the near plane enters
    /// a body.
    fn splat(&mut self, output: SplatOutput, cut: bool) -> CachedRenderPipelineId {
        let [whole, any] = [false, true].map(|cut| {
            let key = SplatKey { output, cut };
            self.splats.specialize(&self.cache, &self.splat, key)
        });
        if cut { any } else { whole }
    }

    fn normals(&mut self, source: NormalSource) -> CachedRenderPipelineId {
        self.normalses
            .specialize(&self.cache, &self.normals, source)
    }

    fn composite(&mut self, key: CompositeKey) -> CachedRenderPipelineId {
        self.composites
            .specialize(&self.cache, &self.composite, key)
    }

    /// All pipelines that a variant of a body requires.
    fn of(&mut self, variant: &Variant, support: &FluidSupport) -> BodyPipelines {
        let Variant {
            plan,
            settings,
            composite,
        } = *variant;
        let steps = SmoothSteps::new(&plan.smoothing);
        let splat = if support.max_blend {
            let output = if plan.backs() {
                SplatOutput::Layers
            } else {
                SplatOutput::Fronts
            };
            SplatPipelines::MaxBlend(self.splat(output, plan.cut))
        } else {
            SplatPipelines::DepthDraws {
                front: self.splat(SplatOutput::FrontDepth, plan.cut),
                back: plan
                    .backs()
                    .then(|| self.splat(SplatOutput::BackDepth, plan.cut)),
                merge: self.splat.merge,
            }
        };
        let bulk_normals = match plan.smoothing {
            // Without refraction no normals are needed.
            _ if !plan.bulk || plan.index_one || steps.yields_normals() => BulkNormals::Smoothed,
            Smoothing::NormalAverage(average) => BulkNormals::Averaged {
                splats: self.normals(NormalSource::Ellipsoids),
                average: self.normals(NormalSource::Average {
                    half_taps: average.half_taps.clamp(1, 8),
                }),
            },
            _ => BulkNormals::Depth(self.normals(NormalSource::Depth)),
        };
        let refract = RefractKey::new(&plan, &settings);
        let thickness = plan.accumulated.then(|| {
            let format = support.thickness_format;
            self.thicknesses
                .specialize(&self.cache, &self.thickness, format)
        });
        let counted = composite.debug_view == Some(FluidDebugView::Overdraw);
        let overdraw =
            counted.then(|| self.splat(SplatOutput::Count(support.thickness_format), plan.cut));
        BodyPipelines {
            splat,
            thickness,
            overdraw,
            smooth: steps.pipelines(&self.cache, &mut self.smooths, &self.smooth),
            bulk_normals,
            spray_normals: (plan.spray && !plan.index_one)
                .then(|| self.normals(NormalSource::Ellipsoids)),
            refract: self
                .refracts
                .specialize(&self.cache, &self.refract, refract),
            composite: self.composite(composite),
            composite_depth: (composite.part == CompositePart::Light).then(|| {
                self.composite(CompositeKey {
                    part: if plan.index_one {
                        CompositePart::DenseDepth
                    } else {
                        CompositePart::Depth
                    },
                    ..composite
                })
            }),
        }
    }
}
