//! Tests of the internals: that the app never waits, and what is shown meanwhile.

use std::{
    sync::{Arc, Mutex, mpsc},
    time::Duration,
};

use bevy::{prelude::*, time::TimeUpdateStrategy};

use super::{
    SalvaBody, SalvaBoundary, SalvaFluid, SalvaPlugin, SalvaSettings, SalvaStatus,
    runner::Simulation,
};
use crate::{
    source::emitter::{EmitterBounds, ParticleEmitter},
    source::particles::FluidParticles,
};

const FRAME: Duration = Duration::from_millis(16);

fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, TransformPlugin, SalvaPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(FRAME));
    app
}

fn drop_of_water(app: &mut App) -> Entity {
    let water = FluidParticles::new(vec![Vec3::ZERO, Vec3::X * 0.1], 0.05);
    app.world_mut().spawn((water, SalvaFluid::WATER)).id()
}

/// Jobs of this app wait until something is sent.
fn hold_jobs(app: &mut App) -> mpsc::Sender<()> {
    let (go, wait) = mpsc::channel();
    let wait = Mutex::new(wait);
    let hold = move || wait.lock().unwrap().recv().unwrap();
    app.world_mut().resource_mut::<Simulation>().before_job = Some(Arc::new(hold));
    go
}

fn status(app: &App) -> &SalvaStatus {
    app.world().resource::<SalvaStatus>()
}

/// Updates until the job in flight has been collected.
fn finish_job(app: &mut App) {
    for _ in 0..10_000 {
        let simulated = status(app).simulated;
        app.update();
        if status(app).simulated > simulated {
            return;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("the job has not come back");
}

#[test]
fn frames_go_on_while_a_step_is_in_flight() {
    let mut app = app();
    let water = drop_of_water(&mut app);
    let go = hold_jobs(&mut app);
    // The first update has no time yet.
    app.update();
    app.update();
    assert!(status(&app).in_flight);
    // A hundred frames for one job that does not end.
    for _ in 0..100 {
        app.update();
        assert!(status(&app).in_flight);
        assert_eq!(status(&app).simulated, 0.0);
    }
    let particles = app.world().get::<FluidParticles>(water).unwrap();
    assert_eq!(particles.positions[0], Vec3::ZERO, "shown as it was");
    go.send(()).unwrap();
    finish_job(&mut app);
    let status = status(&app);
    // One step was due in the first frame, of the hundred others' time none is caught up.
    assert!(status.simulated > 0.0 && status.simulated < 0.1);
    assert!(status.speed < 1.0);
}

#[test]
fn fluids_may_go_while_they_are_simulated() {
    let mut app = app();
    let water = drop_of_water(&mut app);
    let other = drop_of_water(&mut app);
    let go = hold_jobs(&mut app);
    app.update();
    app.update();
    assert!(status(&app).in_flight);
    app.world_mut().despawn(water);
    app.update();
    go.send(()).unwrap();
    finish_job(&mut app);
    assert_eq!(status(&app).particles, 4, "the job had both");
    go.send(()).unwrap();
    finish_job(&mut app);
    assert_eq!(status(&app).particles, 2);
    assert!(app.world().get::<FluidParticles>(other).is_some());
}

#[test]
fn particles_replaced_in_flight_are_not_overwritten() {
    let mut app = app();
    let water = drop_of_water(&mut app);
    let go = hold_jobs(&mut app);
    app.update();
    app.update();
    let mut particles = app.world_mut().get_mut::<FluidParticles>(water).unwrap();
    particles.positions = vec![Vec3::Y * 5.0];
    app.update();
    go.send(()).unwrap();
    finish_job(&mut app);
    let positions = |app: &App| {
        app.world()
            .get::<FluidParticles>(water)
            .unwrap()
            .positions
            .clone()
    };
    assert_eq!(positions(&app), [Vec3::Y * 5.0]);
    go.send(()).unwrap();
    finish_job(&mut app);
    let shown = positions(&app);
    assert_eq!(shown.len(), 1);
    assert!((4.5..5.0).contains(&shown[0].y), "{shown:?}");
}

#[test]
fn what_is_shown_moves_evenly_between_steps() {
    let mut app = app();
    // Four frames in two steps; nothing pushes.
    let frame = Duration::from_secs_f32(1.0 / 240.0);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(frame));
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let velocity = vec3(1.0, -2.0, 0.5);
    let water = drop_of_water(&mut app);
    app.world_mut()
        .get_mut::<SalvaFluid>(water)
        .unwrap()
        .velocity = velocity;
    let body = SalvaBody {
        velocity,
        ..SalvaBody::new(Sphere::new(0.1), 500.0)
    };
    let away = Vec3::Y * 5.0;
    let body = app
        .world_mut()
        .spawn((body, Transform::from_translation(away)))
        .id();
    let mut between = 0;
    for _ in 0..100 {
        app.update();
        // Long enough for what a step of two particles takes, mostly.
        std::thread::sleep(Duration::from_millis(2));
        let shown = status(&app).shown;
        // The first step has no state before it: its end is shown at once.
        if shown < 2.0 / 120.0 {
            continue;
        }
        let expected = velocity * shown as f32;
        let particles = app.world().get::<FluidParticles>(water).unwrap();
        let body = app.world().get::<Transform>(body).unwrap().translation - away;
        for place in [particles.positions[0], body] {
            assert!(place.abs_diff_eq(expected, 1e-4), "{place} for {expected}");
        }
        let steps = shown * 120.0;
        between += u32::from((steps - steps.round()).abs() > 0.1);
    }
    // Steps alone would never lie between.
    assert!(between > 10, "{between}");
}

/// How many commands wait for the next job.
fn waiting(app: &App) -> usize {
    app.world().resource::<Simulation>().commands.len()
}

#[test]
fn nothing_piles_up_while_time_stands_still() {
    let mut app = app();
    let water = drop_of_water(&mut app);
    let plane = app.world_mut().spawn(SalvaBoundary::GROUND).id();
    let ball = Sphere::new(0.1);
    let body = app.world_mut().spawn(SalvaBody::new(ball, 500.0)).id();
    let emitter = ParticleEmitter {
        particle_radius: 0.05,
        bounds: Some(EmitterBounds::default()),
        ..default()
    };
    let jet = app.world_mut().spawn((emitter, SalvaFluid::WATER)).id();
    app.world_mut().resource_mut::<SalvaSettings>().paused = true;
    for i in 0..100 {
        // All that can be changed is.
        let world = app.world_mut();
        let x = i as f32;
        for entity in [plane, body, jet] {
            world.get_mut::<Transform>(entity).unwrap().translation.x = x;
        }
        let mut body = world.get_mut::<SalvaBody>(body).unwrap();
        body.friction = 0.01 * x;
        body.shape = Sphere::new(0.1 + 1e-3 * x).into();
        world.get_mut::<FluidParticles>(water).unwrap().positions = vec![vec3(x, 5.0, 0.0)];
        world.get_mut::<SalvaFluid>(water).unwrap().viscosity = 1e-3 * x;
        world.get_mut::<SalvaFluid>(jet).unwrap().viscosity = 1e-3 * x;
        app.update();
        assert!(waiting(&app) <= 12, "{} in update {i}", waiting(&app));
    }
    // And it all takes effect.
    app.world_mut().resource_mut::<SalvaSettings>().paused = false;
    app.update();
    finish_job(&mut app);
    assert!(status(&app).particles > 0 && !status(&app).stopped);
    let at = app.world().get::<Transform>(body).unwrap().translation.x;
    assert!((at - 99.0).abs() < 0.1, "{at}");
}

#[test]
fn what_is_refused_is_not_tried_again() {
    let mut app = app();
    drop_of_water(&mut app);
    let mut meshes = Assets::<Mesh>::default();
    let sheet = Mesh3d(meshes.add(Plane3d::default().mesh().size(1.0, 1.0)));
    app.insert_resource(meshes);
    app.world_mut().spawn((SalvaBody::default(), sheet));
    app.update();
    app.update();
    finish_job(&mut app);
    let told = |app: &App| app.world().resource::<Simulation>().told;
    let before = told(&app);
    let refused = |app: &App| {
        let solids = &app.world().resource::<Simulation>().solids;
        solids.values().all(|solid| solid.refused.is_some())
    };
    for _ in 0..10 {
        app.update();
        assert!(refused(&app));
    }
    assert_eq!(told(&app), before);
}

#[test]
fn nothing_piles_up_when_salva_has_panicked() {
    let mut app = app();
    let emitter = ParticleEmitter {
        particle_radius: 0.05,
        ..default()
    };
    let jet = app.world_mut().spawn((emitter, SalvaFluid::WATER)).id();
    let wall = app.world_mut().spawn(SalvaBoundary::GROUND).id();
    let panic = || panic!("as a test has it");
    app.world_mut().resource_mut::<Simulation>().before_job = Some(Arc::new(panic));
    let fall = |app: &mut App| {
        let mut wall = app.world_mut().get_mut::<Transform>(wall).unwrap();
        wall.translation.y -= 0.01;
        app.update();
    };
    // A panic takes its time to be reported.
    for _ in 0..10_000 {
        fall(&mut app);
        if status(&app).stopped {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(status(&app).stopped);
    for _ in 0..10 {
        fall(&mut app);
    }
    app.world_mut().despawn(jet);
    app.update();
    assert_eq!(waiting(&app), 0);
}
