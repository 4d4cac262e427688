//! Every shader variant that a setting can require composes, validates and makes a pipeline.

use bevy::{
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            CachedPipelineState, PipelineCache, SpecializedComputePipeline,
            SpecializedRenderPipeline, TextureFormat,
        },
    },
    shader::ShaderDefVal,
};
use fluid_stage::{headless_app, settle};

use super::{
    composite::{
        CompositeKey, CompositePart, CompositePipeline, RaysKey, RaysPipeline, ShadeKey,
        ShadePipeline,
    },
    debug_view::{DebugKey, DebugPipeline},
    frame::Stage,
    motion::{MotionKey, MotionPipeline},
    normals::{NormalSource, NormalsPipeline},
    refract::{RefractKey, RefractPipeline},
    smooth::{AveragePipeline, SmoothPipeline, steps::steps},
    splat::{SplatKey, SplatOutput, SplatPipeline},
    surface::{
        Variant,
        plan::{MediumTerms, PlanInput, plan},
    },
    thickness::ThicknessPipeline,
};
use crate::{
    FluidPlugin,
    material::FluidMaterial,
    settings::{
        Bilateral, FluidDebugView, NarrowRange, PlaneFit, PlaneFitForm, ScreenSpaceFluid, Smoothing,
    },
};

const BOTH: [bool; 2] = [false, true];

/// All pairs, `a` first.
fn pairs<A: Copy, B: Copy>(a: &[A], b: &[B]) -> Vec<(A, B)> {
    a.iter()
        .flat_map(|&a| b.iter().map(move |&b| (a, b)))
        .collect()
}

/// Requests pipelines in an app's render world and asserts that all of them are made.
fn assert_made<Id>(
    ask: impl FnOnce(&World) -> Vec<Id>,
    state: impl Fn(&PipelineCache, Id) -> &CachedPipelineState,
) {
    let mut app = headless_app(UVec2::splat(16), |app| {
        app.add_plugins(FluidPlugin::default());
    })
    .unwrap();
    // Pipelines made without a request, such as the merge of two depths.
    settle(&mut app).unwrap();
    let ids = ask(app.sub_app(RenderApp).world());
    // An error here names the pipeline and what is wrong with it.
    settle(&mut app).unwrap();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    assert!(!ids.is_empty());
    for id in ids {
        let state = state(cache, id);
        assert!(matches!(state, CachedPipelineState::Ok(_)), "{state:?}");
    }
}

fn assert_variants<P: SpecializedRenderPipeline + Resource>(keys: Vec<P::Key>) {
    let ask = |world: &World| {
        let (pipeline, cache) = (world.resource::<P>(), world.resource::<PipelineCache>());
        keys.into_iter()
            .map(|key| cache.queue_render_pipeline(pipeline.specialize(key)))
            .collect()
    };
    assert_made(ask, PipelineCache::get_render_pipeline_state);
}

#[test]
fn every_splat_output_is_made() {
    let outputs = [
        SplatOutput::Layers,
        SplatOutput::Fronts,
        SplatOutput::FrontDepth,
        SplatOutput::BackDepth,
        SplatOutput::Count(TextureFormat::R32Float),
        SplatOutput::Count(TextureFormat::R16Float),
        SplatOutput::Coverage,
    ];
    let keys = pairs(&pairs(&outputs, &BOTH), &BOTH);
    let keys = keys.into_iter().map(|((output, cut), covers)| SplatKey {
        output,
        cut,
        covers: match output {
            SplatOutput::Layers | SplatOutput::Fronts => covers,
            _ => output == SplatOutput::Coverage,
        },
    });
    assert_variants::<SplatPipeline>(keys.collect());
}

#[test]
fn every_source_of_normals_is_made() {
    assert_variants::<NormalsPipeline>(vec![NormalSource::Depth, NormalSource::Ellipsoids]);
    assert_variants::<AveragePipeline>([None].into_iter().chain((1..=8).map(Some)).collect());
}

/// Every kind of smoothing with every number of taps; twice over, for the last pass may differ, and once.
fn smoothings() -> impl Iterator<Item = Smoothing> {
    (1..=8).flat_map(|half_taps| {
        let fit = |form| {
            Smoothing::PlaneFit(PlaneFit {
                form,
                half_taps,
                iterations: 2,
                ..default()
            })
        };
        [
            fit(PlaneFitForm::TotalLeastSquares),
            fit(PlaneFitForm::DeviceDepth),
            fit(PlaneFitForm::Separable),
            Smoothing::PlaneFit(PlaneFit {
                half_taps,
                iterations: 1,
                ..default()
            }),
            Smoothing::Bilateral(Bilateral {
                half_taps,
                iterations: 2,
                ..default()
            }),
            Smoothing::NarrowRange(NarrowRange {
                half_taps,
                iterations: 2,
                ..default()
            }),
            Smoothing::CurvatureFlow(default()),
        ]
    })
}

#[test]
fn every_smoothing_is_made() {
    let steps = smoothings().flat_map(|smoothing| steps(&smoothing));
    assert_variants::<SmoothPipeline>(steps.collect());
}

/// Bulk and spray traced through a medium that has no terms.
const TRACED: RefractKey = RefractKey {
    interfaces: 4,
    bulk: true,
    spray: true,
    index_one: false,
    secant: false,
    schlick: false,
    accumulated: false,
    opaque: false,
    terms: MediumTerms {
        extinction: false,
        scattering: false,
        emission: false,
    },
};

#[test]
fn every_refraction_is_made() {
    let classes = [(true, false), (false, true), (true, true)];
    let bent = pairs(&pairs(&[0, 1, 2, 4], &classes), &pairs(&BOTH, &BOTH));
    let bent =
        bent.into_iter().map(
            |((interfaces, (bulk, spray)), (secant, schlick))| RefractKey {
                interfaces,
                bulk,
                spray,
                secant,
                schlick,
                ..TRACED
            },
        );
    let straight = classes.map(|(bulk, spray)| RefractKey {
        interfaces: 0,
        bulk,
        spray,
        index_one: true,
        ..TRACED
    });
    assert_variants::<RefractPipeline>(bent.chain(straight).collect());
}

#[test]
fn every_medium_is_made() {
    let terms = pairs(&BOTH, &pairs(&BOTH, &BOTH));
    let terms = terms
        .into_iter()
        .map(|(extinction, (scattering, emission))| MediumTerms {
            extinction,
            scattering,
            emission,
        });
    let one = RefractKey {
        interfaces: 1,
        ..TRACED
    };
    let straight = RefractKey {
        interfaces: 0,
        index_one: true,
        ..TRACED
    };
    let surfaces = [
        TRACED,
        one,
        straight,
        RefractKey {
            opaque: true,
            ..one
        },
        RefractKey {
            opaque: true,
            ..straight
        },
        RefractKey {
            accumulated: true,
            ..straight
        },
    ];
    let surfaces = surfaces.into_iter();
    let keys = terms.flat_map(|terms| surfaces.clone().map(move |key| RefractKey { terms, ..key }));
    assert_variants::<RefractPipeline>(keys.collect());
}

const WATER: PlanInput = PlanInput {
    in_view: true,
    near_plane_cuts: false,
    bulk: 1,
    interior: 0,
    spray: 1,
    radius: 0.1,
    material: FluidMaterial::CLEAR_WATER,
    shortcuts: true,
    scene_depth: true,
    motion_vectors: false,
    settings: ScreenSpaceFluid::DEFAULT,
};

#[test]
fn a_medium_without_terms_costs_nothing() {
    let key = |material| {
        let plan = plan(&PlanInput { material, ..WATER }).unwrap();
        RefractKey::new(&plan, &WATER.settings)
    };
    assert_eq!(key(FluidMaterial::CLEAR_WATER), TRACED);
    // The shader's definitions are the same as before media were introduced.
    let defs: [ShaderDefVal; 4] = [
        "BULK_LAYERS".into(),
        "SPRAY_LAYERS".into(),
        ShaderDefVal::UInt("INTERFACES".into(), 4),
        ShaderDefVal::Bool("BOTH_CLASSES".into(), true),
    ];
    assert_eq!(TRACED.shader_defs(), defs);
    assert_ne!(key(FluidMaterial::WATER), TRACED);
}

#[test]
fn every_thickness_is_made() {
    assert_variants::<ThicknessPipeline>(vec![TextureFormat::R32Float, TextureFormat::R16Float]);
}

#[test]
fn every_composite_is_made() {
    let formats = [TextureFormat::Rgba16Float, TextureFormat::Rgba8UnormSrgb];
    let parts = [
        CompositePart::Whole,
        CompositePart::Light,
        CompositePart::Depth,
        CompositePart::DenseDepth,
    ];
    let resolved = [None, Some(0), Some(4)];
    let keys = pairs(&pairs(&parts, &formats), &pairs(&[1, 4], &BOTH));
    let keys = pairs(&keys, &resolved).into_iter().map(
        |(((part, format), (samples, covers)), resolve)| CompositeKey {
            format,
            samples,
            part,
            covers,
            bulk: covers,
            spray: true,
            resolve,
        },
    );
    assert_variants::<CompositePipeline>(keys.collect());
}

#[test]
fn every_shading_is_made() {
    let haze = [(false, false), (true, false), (true, true)];
    let keys = pairs(&haze, &BOTH).into_iter();
    let keys = keys.map(|((fog, atmosphere), several)| ShadeKey {
        fog,
        atmosphere,
        several,
    });
    assert_variants::<ShadePipeline>(keys.collect());
}

#[test]
fn every_ray_is_made() {
    let classes = [(true, false), (false, true), (true, true)];
    let keys = pairs(&pairs(&[0, 1, 4], &classes), &BOTH);
    let keys = keys
        .into_iter()
        .map(|((interfaces, (bulk, spray)), all)| RaysKey {
            count: 2 + interfaces,
            refract: RefractKey {
                interfaces,
                bulk,
                spray,
                terms: MediumTerms {
                    extinction: all,
                    scattering: all,
                    emission: all,
                },
                ..TRACED
            },
            background: ShadeKey {
                fog: all,
                atmosphere: all,
                several: all,
            },
        });
    let ask = |world: &World| {
        let pipeline = world.resource::<RaysPipeline>();
        let cache = world.resource::<PipelineCache>();
        let made = keys.map(|key| cache.queue_compute_pipeline(pipeline.specialize(key)));
        made.collect()
    };
    assert_made(ask, PipelineCache::get_compute_pipeline_state);
}

#[test]
fn every_motion_is_made() {
    let splats = BOTH.map(|cut| MotionKey::Splats { cut });
    let camera = [1, 4].map(|samples| MotionKey::ToCamera { samples });
    assert_variants::<MotionPipeline>([splats, camera].concat());
}

/// Neither pipelines nor textures are made for cameras that do not ask for motion vectors.
#[test]
fn motion_vectors_cost_nothing_unless_asked_for() {
    let mut app = headless_app(UVec2::splat(16), |app| {
        app.add_plugins(FluidPlugin::default());
    })
    .unwrap();
    settle(&mut app).unwrap();
    let stage = app.sub_app(RenderApp).world().resource::<MotionPipeline>();
    let keys = |motion_vectors| {
        let input = PlanInput {
            motion_vectors,
            ..WATER
        };
        stage.keys(&Variant {
            plan: plan(&input).unwrap(),
            settings: input.settings,
            debug_view: None,
            format: TextureFormat::Rgba16Float,
            samples: 4,
            scene_depth: true,
            fog: false,
            atmosphere: false,
            several: false,
        })
    };
    assert_eq!(keys(false), []);
    let asked = [
        MotionKey::Splats { cut: false },
        MotionKey::ToCamera { samples: 4 },
    ];
    assert_eq!(keys(true), asked);
}

#[test]
fn every_debug_view_is_made() {
    let formats = [TextureFormat::Rgba16Float, TextureFormat::Rgba8UnormSrgb];
    let keys = pairs(&pairs(&FluidDebugView::ALL, &formats), &[1, 4]);
    let keys = keys
        .into_iter()
        .map(|((debug_view, format), samples)| DebugKey {
            debug_view,
            format,
            samples,
            accumulated: samples == 4 && debug_view == FluidDebugView::Thickness,
        });
    assert_variants::<DebugPipeline>(keys.collect());
}
