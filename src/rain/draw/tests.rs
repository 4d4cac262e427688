//! Every shader variant composes, validates and makes a pipeline; GPU twins have the right size; a
//! steady frame allocates nothing.

use bevy::{
    core_pipeline::core_3d::Transparent3d,
    ecs::system::IntoSystem,
    prelude::*,
    render::{
        RenderApp,
        render_phase::ViewSortedRenderPhases,
        render_resource::{
            CachedPipelineState, PipelineCache, SpecializedRenderPipeline, TextureFormat,
        },
    },
};
use fluid_stage::{headless_app, settle, step};

use super::{
    RainQuads,
    gpu_types::{DRY_PLANES, GpuQuad, MAX_SHELTERS},
    lattice::STEEPEST,
    pipeline::{RainKey, RainPart, RainPipeline, RainScene},
    prepare::{prepare_rain_bind_groups, queue_rain},
};
use crate::rain::{
    Rain, RainPlugin, RainShelter,
    drops::{INTERCEPT, LARGEST, SMALLEST},
    streaks::{HEIGHT, VARIANTS, WIDTH},
};

#[test]
fn every_part_of_rain_is_made() {
    let mut app = headless_app(UVec2::splat(16), |app| {
        app.add_plugins(RainPlugin::default());
    })
    .unwrap();
    settle(&mut app).unwrap();
    let world = app.sub_app(RenderApp).world();
    let (pipeline, cache) = (
        world.resource::<RainPipeline>(),
        world.resource::<PipelineCache>(),
    );
    let mut ids = Vec::new();
    for part in [RainPart::Backdrop, RainPart::Billboards, RainPart::Drops] {
        for format in [TextureFormat::Rgba16Float, TextureFormat::Rgba8UnormSrgb] {
            for samples in [1, 4] {
                for scene in 0..8 {
                    let scene = RainScene {
                        suns: scene & 1 != 0,
                        lamps: scene & 2 != 0,
                        shelters: scene & 4 != 0,
                    };
                    let key = RainKey {
                        part,
                        format,
                        samples,
                        scene,
                    };
                    ids.push(cache.queue_render_pipeline(pipeline.specialize(key)));
                }
            }
        }
    }
    // An error here names the pipeline and what is wrong with it.
    settle(&mut app).unwrap();
    let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
    for id in ids {
        let state = cache.get_render_pipeline_state(id);
        assert!(matches!(state, CachedPipelineState::Ok(_)), "{state:?}");
    }
}

/// Constants that WGSL repeats from Rust.
#[test]
fn shaders_know_the_same_numbers() {
    let (types, births) = (include_str!("types.wgsl"), include_str!("births.wgsl"));
    for (shader, line) in [
        (types, format!("const VARIANTS: u32 = {VARIANTS}u;")),
        (types, format!("const DRY_PLANES: u32 = {DRY_PLANES}u;")),
        (types, format!("places: array<GpuShelter, {MAX_SHELTERS}>")),
        (types, format!("vec2({WIDTH}.0, {HEIGHT}.0)")),
        (types, format!("const LARGEST: f32 = {LARGEST:.1};")),
        (types, format!("const STEEPEST: f32 = {STEEPEST};")),
        (births, format!("const SMALLEST: f32 = {SMALLEST};")),
        (births, format!("const INTERCEPT: f32 = {INTERCEPT:.1};")),
    ] {
        assert!(shader.contains(&line), "{line}");
    }
    assert_eq!(size_of::<GpuQuad>(), 48);
}

/// With everything that a frame may have: lamps, suns, shelters.
#[test]
fn a_steady_frame_allocates_nothing() {
    let mut app = headless_app(uvec2(64, 48), |app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        });
        let world = app.world_mut();
        world.spawn((Camera3d::default(), Rain::HEAVY));
        world.spawn((PointLight::default(), Transform::from_xyz(0.0, 1.0, -3.0)));
        world.spawn((SpotLight::default(), Transform::from_xyz(1.0, 1.0, -2.0)));
        world.spawn(DirectionalLight::default());
        world.spawn((RainShelter::default(), Transform::from_xyz(2.0, 1.0, -3.0)));
    })
    .unwrap();
    settle(&mut app).unwrap();
    step(&mut app, 2);
    let world = app.sub_app_mut(RenderApp).world_mut();
    let mut queue = IntoSystem::into_system(queue_rain);
    let mut bind = IntoSystem::into_system(prepare_rain_bind_groups);
    queue.initialize(world);
    bind.initialize(world);
    let mut frame = |world: &mut World| {
        for phase in world
            .resource_mut::<ViewSortedRenderPhases<Transparent3d>>()
            .values_mut()
        {
            // As Bevy does between frames.
            phase.clear();
            phase.transient_items.clear();
        }
        queue.run((), world).unwrap();
        bind.run((), world).unwrap();
    };
    frame(world);
    let spent = allocation_counter::measure(|| frame(world));
    let quads: Vec<_> = world.query::<&RainQuads>().iter(world).collect();
    assert!(
        quads
            .iter()
            .all(|quads| quads.len() > 10 && quads.bind_group.is_some())
    );
    assert_eq!(spent.count_total, 0, "{spent:?}");
}
