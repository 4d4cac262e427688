//! Programs without a renderer, as servers and unit tests are: sources move, fluids are shaped, and
//! what is missing is named.

use std::{path::Path, thread, time::Duration};

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{
    diagnostics::FluidDiagnosticsPlugin,
    emitter::EmittedParticles,
    inspector::{FluidInspector, FluidInspectorPlugin},
    particles::ShapedFluid,
    prelude::*,
    rain::{BakedStreaks, RainShelter},
    recording::WrittenFrames,
    render::PlanReports,
};
use fluid_stage::{ball, log};

fn finished(app: &mut App) {
    app.finish();
    app.cleanup();
}

/// All plugins at once, without transforms, assets or diagnostics of Bevy's.
fn app() -> App {
    log::listen();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        FluidPlugins,
        FluidDiagnosticsPlugin,
        FluidInspectorPlugin::default(),
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(
        10,
    )));
    finished(&mut app);
    app
}

#[test]
fn emitters_emit_and_their_particles_are_shaped() {
    let mut app = app();
    let hose = app.world_mut().spawn(ParticleEmitter::jet(4000.0, 4.0));
    let hose = hose.id();
    for _ in 0..10 {
        app.update();
    }
    let world = app.world();
    let emitted = world.get::<EmittedParticles>(hose).unwrap().len();
    assert!((300..=400).contains(&emitted), "{emitted}");
    let shaped = world.get::<ShapedFluid>(hose).unwrap();
    let count = shaped.bulk() + shaped.interior() + shaped.spray();
    assert_eq!(count as usize, emitted);
}

#[test]
fn liquids_are_simulated_among_solids() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().mode = SalvaMode::Lockstep;
    let world = app.world_mut();
    let water = FluidParticles::new(ball(0.2, 0.05), 0.025);
    let place = Transform::from_xyz(0.0, 1.0, 0.0);
    let water = world.spawn((water, SalvaFluid::WATER, place)).id();
    world.spawn(SalvaBoundary::tank(Vec3::ONE));
    let body = SalvaBody::new(Cuboid::from_length(0.2), 400.0);
    let body = world.spawn((body, Transform::from_xyz(0.0, 2.0, 0.0))).id();
    for _ in 0..20 {
        app.update();
    }
    let world = app.world();
    let fluid = world.get::<FluidParticles>(water).unwrap();
    let highest = fluid.positions.iter().map(|place| place.y);
    // Of 1.2 m. In 0.2 s a fall is one of 0.2 m.
    let highest = highest.fold(f32::NEG_INFINITY, f32::max);
    assert!((0.9..1.1).contains(&highest), "{highest}");
    let height = world.get::<Transform>(body).unwrap().translation.y;
    assert!((1.7..1.9).contains(&height), "{height}");
}

#[test]
fn fluids_are_recorded() {
    let mut app = app();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("headless");
    let _ = std::fs::remove_dir_all(&folder);
    let pattern = folder.join("ball_#.xyz");
    let writer = RecordingWriter::new(pattern.to_str().unwrap());
    let fluid = FluidParticles::new(ball(0.2, 0.05), 0.025);
    let fluid = app.world_mut().spawn((fluid, writer)).id();
    let written = |app: &App| app.world().get::<WrittenFrames>(fluid).unwrap().written();
    for _ in 0..2000 {
        app.update();
        if written(&app) > 1 {
            break;
        }
        thread::sleep(Duration::from_millis(1));
    }
    assert!(written(&app) > 1);
    assert!(folder.join("ball_1.xyz").exists());
}

#[test]
fn what_only_draws_comes_and_goes() {
    let mut app = app();
    let world = app.world_mut();
    let camera = world.spawn((ScreenSpaceFluid::FAST, Rain::HEAVY)).id();
    let roof = world.spawn(RainShelter::default()).id();
    let fluid = world.spawn(FluidParticles::new(vec![Vec3::ZERO], 0.1)).id();
    app.update();
    app.update();
    let world = app.world_mut();
    // Nobody would see the streaks.
    assert!(!world.resource::<BakedStreaks>().is_settled());
    assert_eq!(world.resource::<BakedStreaks>().exposure(), None);
    assert!(!world.resource::<FluidInspector>().open);
    world.resource::<PlanReports>().ask();
    world.entity_mut(camera).remove::<Rain>();
    for entity in [camera, roof, fluid] {
        world.despawn(entity);
    }
    app.update();
}

#[test]
fn a_player_without_assets_names_what_it_needs() {
    let mut app = app();
    for _ in 0..2 {
        app.world_mut().spawn(RecordingPlayer::default());
        app.update();
    }
    assert_eq!(log::count("a `RecordingPlayer` plays nothing"), 1);
    assert_eq!(log::count("it needs `AssetPlugin`"), 1);
}

/// A program without a clock either.
#[test]
fn plugins_without_a_clock_name_what_they_need() {
    log::listen();
    let mut app = App::new();
    app.add_plugins(FluidPlugins);
    finished(&mut app);
    assert_eq!(log::count("`FluidPlugin` needs `TimePlugin`"), 1);
    let hose = app.world_mut().spawn(ParticleEmitter::JET).id();
    app.update();
    app.update();
    assert!(
        app.world()
            .get::<EmittedParticles>(hose)
            .unwrap()
            .is_empty()
    );
}
