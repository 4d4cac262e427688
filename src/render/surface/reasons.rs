//! Reasons for the work that plans leave out, reported, for the main world.

use std::sync::{
    Arc, Mutex, MutexGuard, PoisonError,
    atomic::{AtomicBool, Ordering},
};

use bevy::{
    ecs::system::SystemParam,
    prelude::*,
    render::{render_resource::CachedPipelineState, sync_world::MainEntity},
    shader::ShaderCacheError,
};

use super::plan::{PlanInput, plan};
use crate::{material::FluidMaterial, settings::Smoothing};

/// Work that was skipped for a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Skipped {
    /// The skipped work, such as "search".
    pub work: &'static str,
    /// The reason, such as "nothing is seen through it".
    pub why: &'static str,
}

/// All work that [`plan`] leaves out for a surface in a view, in the order of the passes.
pub fn skipped(input: &PlanInput) -> Vec<Skipped> {
    let Some(plan) = plan(input) else {
        let why = if input.in_view {
            "there is nothing to draw"
        } else {
            "it is out of view"
        };
        return vec![Skipped {
            work: "everything",
            why,
        }];
    };
    let unsmoothed = input.settings.smoothing == Smoothing::None;
    let traced = !plan.opaque && !plan.index_one;
    let summed_up = "thickness is summed up over particles";
    [
        (
            input.interior > 0 && !plan.interior,
            "interior particles",
            "no ray starts among them",
        ),
        (
            !plan.cut,
            "cutting splats open",
            "the near plane meets none",
        ),
        (!plan.bulk, "bulk layers", "no particle is bulk"),
        (!plan.spray, "spray layers", "no particle is spray"),
        (plan.accumulated, "back layers", summed_up),
        (plan.opaque, "back layers", "nothing is seen through it"),
        (!plan.bulk, "smoothing", "no particle is bulk"),
        (
            plan.bulk && unsmoothed && !plan.accumulated,
            "smoothing",
            "the camera wants none",
        ),
        (plan.bulk && plan.accumulated, "smoothing", summed_up),
        (
            plan.index_one,
            "normals, reflection",
            "an index of 1 bends nothing",
        ),
        (plan.index_one, "search", "an index of 1 bends nothing"),
        (
            plan.opaque && !plan.index_one,
            "search",
            "nothing is seen through it",
        ),
        (
            traced && !input.scene_depth,
            "refraction",
            "the camera has no DepthPrepass",
        ),
        (
            traced && input.scene_depth && plan.interfaces <= 1,
            "search",
            "the camera wants one refraction at most",
        ),
        (
            !plan.terms.extinction,
            "extinction",
            "its medium takes no light",
        ),
        (
            !plan.terms.scattering,
            "scattering",
            "its medium scatters none",
        ),
        (
            !plan.terms.emission,
            "emission",
            "its medium does not shine",
        ),
        (
            !plan.motion_vectors,
            "motion vectors",
            "the camera has no MotionVectorPrepass",
        ),
    ]
    .into_iter()
    .filter(|(left_out, ..)| *left_out)
    .map(|(_, work, why)| Skipped { work, why })
    .collect()
}

/// Pipelines that are missing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Waiting {
    /// The stage whose pipelines are missing, by the label of its passes.
    pub stage: &'static str,
    /// Whether they cannot be made, as the log says, rather than being compiled.
    pub failed: bool,
}

impl Waiting {
    pub(crate) fn new(stage: &'static str, pipeline: &CachedPipelineState) -> Self {
        let failed = match pipeline {
            // The shader may still be loaded.
            CachedPipelineState::Err(error) => !matches!(
                error,
                ShaderCacheError::ShaderNotLoaded(_)
                    | ShaderCacheError::ShaderImportNotYetAvailable
            ),
            _ => false,
        };
        Self { stage, failed }
    }
}

/// The plan for a surface in a view.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceReport {
    /// The surface's material.
    pub material: FluidMaterial,
    /// The fluids that form the surface.
    pub fluids: Vec<Entity>,
    /// The skipped work.
    pub skipped: Vec<Skipped>,
    /// What it waited for in the last frame; meanwhile it is drawn as it was before, if at all.
    pub waiting: Option<Waiting>,
    /// The fraction of the view's pixels that its passes are confined to, 0..=1.
    pub covered: f32,
}

/// The plans for a camera's surfaces, from far to near.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewReport {
    /// The camera in the main world.
    pub camera: Entity,
    /// From far to near, including surfaces that are skipped entirely.
    pub surfaces: Vec<SurfaceReport>,
}

/// Reports of plans from the render world, on request.
///
/// A report is available a frame or two after [`PlanReports::ask`]; without a request none is made.
/// Inserted by [`FluidPlugin`](crate::FluidPlugin).
#[derive(Resource, Clone, Debug, Default)]
pub struct PlanReports(Arc<LetterBox>);

#[derive(Debug, Default)]
struct LetterBox {
    asked: AtomicBool,
    views: Mutex<Vec<ViewReport>>,
}

impl PlanReports {
    /// Requests a report of the next frame.
    pub fn ask(&self) {
        self.0.asked.store(true, Ordering::Relaxed);
    }

    /// The latest report; empty if none was requested.
    pub fn latest(&self) -> Vec<ViewReport> {
        self.views().clone()
    }

    fn views(&self) -> MutexGuard<'_, Vec<ViewReport>> {
        self.0.views.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new report, if one was requested.
    fn begin(&self) -> Option<Vec<ViewReport>> {
        self.0.asked.swap(false, Ordering::Relaxed).then(Vec::new)
    }

    fn end(&self, report: Option<Vec<ViewReport>>) {
        if let Some(report) = report {
            *self.views() = report;
        }
    }
}

/// Writes the reports, in the render world.
#[derive(SystemParam)]
pub(crate) struct Reporter<'w, 's> {
    reports: Res<'w, PlanReports>,
    main_entities: Query<'w, 's, &'static MainEntity>,
}

impl Reporter<'_, '_> {
    /// A new report, if one was requested.
    pub(crate) fn begin(&self) -> Option<Vec<ViewReport>> {
        self.reports.begin()
    }

    pub(crate) fn end(&self, report: Option<Vec<ViewReport>>) {
        self.reports.end(report);
    }

    /// The report about a surface formed by fluids of the render world.
    pub(crate) fn surface(
        &self,
        input: &PlanInput,
        fluids: impl Iterator<Item = Entity>,
        waiting: Option<Waiting>,
        rect: Option<URect>,
        view_size: UVec2,
    ) -> SurfaceReport {
        let pixels = |size: UVec2| size.x as f32 * size.y as f32;
        let covered = rect.map_or(0.0, |it| pixels(it.size()));
        SurfaceReport {
            material: input.material,
            fluids: fluids
                .filter_map(|fluid| Some(self.main_entities.get(fluid).ok()?.id()))
                .collect(),
            skipped: skipped(input),
            waiting,
            covered: covered / pixels(view_size).max(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{Refractions, ScreenSpaceFluid};

    const POOL: PlanInput = PlanInput {
        in_view: true,
        near_plane_cuts: true,
        bulk: 100,
        interior: 50,
        spray: 3,
        radius: 0.05,
        material: FluidMaterial::WATER,
        shortcuts: true,
        scene_depth: true,
        motion_vectors: true,
        settings: ScreenSpaceFluid::DEFAULT,
    };

    fn words(input: PlanInput) -> Vec<&'static str> {
        skipped(&input).iter().map(|it| it.work).collect()
    }

    #[test]
    fn water_all_around_the_eye_only_spares_the_terms_it_lacks() {
        assert_eq!(words(POOL), ["scattering", "emission"]);
        let unplanned = PlanInput {
            shortcuts: false,
            ..POOL
        };
        assert!(words(unplanned).is_empty());
    }

    #[test]
    fn every_shortcut_has_its_word() {
        let smoke = PlanInput {
            near_plane_cuts: false,
            spray: 0,
            material: FluidMaterial::SMOKE,
            ..POOL
        };
        assert_eq!(
            words(smoke),
            [
                "interior particles",
                "cutting splats open",
                "spray layers",
                "back layers",
                "smoothing",
                "normals, reflection",
                "search",
                "emission"
            ]
        );
        let milk = PlanInput {
            bulk: 0,
            interior: 0,
            material: FluidMaterial::MILK,
            ..POOL
        };
        assert_eq!(
            words(milk),
            [
                "bulk layers",
                "back layers",
                "smoothing",
                "search",
                "emission"
            ]
        );
        let mut plain = POOL;
        plain.settings.smoothing = Smoothing::None;
        plain.settings.refractions = Refractions::One;
        assert_eq!(
            words(plain),
            ["smoothing", "search", "scattering", "emission"]
        );
    }

    #[test]
    fn a_missing_prepass_is_named() {
        let blind = PlanInput {
            scene_depth: false,
            ..POOL
        };
        assert_eq!(words(blind), ["refraction", "scattering", "emission"]);
    }

    #[test]
    fn motion_vectors_that_nobody_asks_for_are_named() {
        let still = PlanInput {
            motion_vectors: false,
            ..POOL
        };
        assert_eq!(words(still), ["scattering", "emission", "motion vectors"]);
    }

    #[test]
    fn nothing_drawn_is_everything_skipped() {
        let why = |input: PlanInput| {
            let [all] = skipped(&input)[..] else {
                panic!("there is one line")
            };
            assert_eq!(all.work, "everything");
            all.why
        };
        let behind = PlanInput {
            in_view: false,
            ..POOL
        };
        assert_eq!(why(behind), "it is out of view");
        let empty = PlanInput {
            bulk: 0,
            interior: 0,
            spray: 0,
            ..POOL
        };
        assert_eq!(why(empty), "there is nothing to draw");
    }

    #[test]
    fn reports_are_made_when_asked_for_alone() {
        let reports = PlanReports::default();
        assert_eq!(reports.begin(), None);
        reports.ask();
        let mut report = reports.begin().unwrap();
        report.push(ViewReport {
            camera: Entity::PLACEHOLDER,
            surfaces: vec![],
        });
        reports.end(Some(report));
        assert_eq!(reports.begin(), None);
        reports.end(None);
        assert_eq!(reports.latest().len(), 1);
    }
}
