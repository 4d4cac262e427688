//! Liquid, boundaries and bodies when the whole world or a tank is put elsewhere.

use std::{thread::sleep, time::Duration};

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{STEP, app, mean, particles, pool, run, spawn_water, status};

const SIZE: Vec3 = vec3(0.6, 1.0, 0.6);

/// Water in a tank, with a body afloat, at rest.
fn bath() -> (App, Entity, Entity, Entity) {
    let mut app = app();
    let (tank, water) = pool(&mut app, SIZE, 0.4);
    let body = app.world_mut().spawn((
        SalvaBody::new(Cuboid::from_length(0.2), 400.0),
        Transform::from_xyz(0.05, 0.5, 0.0),
    ));
    let body = body.id();
    run(&mut app, 0.5);
    (app, tank, water, body)
}

fn place(app: &App, entity: Entity) -> Vec3 {
    app.world().get::<Transform>(entity).unwrap().translation
}

/// Moves everything, and says so.
fn shift(app: &mut App, way: Vec3) {
    let world = app.world_mut();
    for mut place in world.query::<&mut Transform>().iter_mut(world) {
        place.translation += way;
    }
    world.write_message(WorldShift(way));
}

#[track_caller]
fn assert_held(app: &App, tank: Entity, water: Entity, count: usize) {
    let center = place(app, tank);
    let now = particles(app, water);
    assert_eq!(now.len(), count, "none is lost");
    for particle in now {
        let local = *particle - center;
        // A step of f32 a kilometre off is 6e-5 m.
        let is_inside = local.abs().cmple(0.5 * SIZE + 1e-3).all();
        assert!(is_inside, "{local} in the tank");
    }
}

#[test]
fn h63_a_shift_takes_liquid_tank_and_body_along() {
    let (mut app, tank, water, body) = bath();
    let count = particles(&app, water).len();
    let way = vec3(-2000.0, 512.0, 3000.0);
    let earlier = place(&app, body);
    app.update();
    let before = (particles(&app, water).to_vec(), place(&app, body));
    shift(&mut app, way);
    app.update();
    assert_held(&app, tank, water, count);
    // At rest: neither shaken nor thrown, and the body goes on.
    let speed = |now: Vec3, before: Vec3| (now - way - before).length() / STEP;
    let now = particles(&app, water).iter();
    let fastest = now.zip(&before.0).map(|(now, before)| speed(*now, *before));
    let fastest = fastest.fold(0.0, f32::max);
    assert!(fastest < 0.5, "{fastest} m/s");
    let was = (before.1 - earlier) / STEP;
    let is = (place(&app, body) - way - before.1) / STEP;
    assert!(is.distance(was) < 0.3, "{is} m/s after {was}");
    run(&mut app, 0.5);
    assert_held(&app, tank, water, count);
    let height = mean(particles(&app, water).iter().map(|p| p.y - way.y));
    let height_before = mean(before.0.iter().map(|p| p.y));
    assert!((height - height_before).abs() < 0.02, "{height}");
    assert!((place(&app, body) - way - before.1).length() < 0.1);
    assert_eq!(status(&app).broken, 0);
    // Bounds come along: what leaves them goes.
    let settings = app.world().resource::<SalvaSettings>();
    assert_eq!(settings.low, Vec3::splat(-1000.0) + way);
}

#[test]
fn a_body_flies_on_through_shifts() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
    let velocity = vec3(1.0, 0.5, 0.0);
    let body = app.world_mut().spawn(SalvaBody {
        velocity,
        ..SalvaBody::new(Sphere::new(0.1), 500.0)
    });
    let body = body.id();
    run(&mut app, 0.1);
    for frame in 0..24 {
        let before = place(&app, body);
        let mut way = Vec3::ZERO;
        if frame % 3 == 0 {
            // Several in a frame, which round one after the other.
            for part in [vec3(100.3, 0.0, 0.1), vec3(-33.7, 7.1, 0.0)] {
                way += part;
                shift(&mut app, part);
            }
        }
        app.update();
        let now = (place(&app, body) - before - way) / STEP;
        assert!(now.distance(velocity) < 0.02, "{now} in frame {frame}");
    }
}

/// Steps are on their way on another thread while the world is shifted, and come back in it.
#[test]
fn nothing_is_seen_elsewhere_while_nobody_waits() {
    let (mut app, tank, water, _) = bath();
    app.world_mut().resource_mut::<SalvaSettings>().mode = SalvaMode::Background;
    let count = particles(&app, water).len();
    let mut was_in_flight = 0;
    for frame in 0..120 {
        if frame % 4 == 1 {
            was_in_flight += u32::from(status(&app).in_flight);
            let sign = if frame % 8 == 1 { 1.0 } else { -1.0 };
            shift(&mut app, vec3(500.0, -30.0, 0.0) * sign);
        }
        app.update();
        assert_held(&app, tank, water, count);
        if frame % 3 == 0 {
            sleep(Duration::from_millis(4));
        }
    }
    assert!(was_in_flight > 3, "{was_in_flight} times");
    assert!(status(&app).simulated > 0.6);
}

#[test]
fn a_pause_may_be_shifted() {
    let (mut app, tank, water, body) = bath();
    let count = particles(&app, water).len();
    app.world_mut().resource_mut::<SalvaSettings>().paused = true;
    for _ in 0..10 {
        shift(&mut app, vec3(100.0, 10.0, 0.0));
        app.update();
        assert_held(&app, tank, water, count);
    }
    app.world_mut().resource_mut::<SalvaSettings>().paused = false;
    let before = place(&app, body);
    run(&mut app, 0.2);
    assert_held(&app, tank, water, count);
    assert!((place(&app, body) - before).length() < 0.05);
}

#[test]
fn h64_a_tank_that_jumps_takes_its_water_along_if_told() {
    let way = vec3(50.0, 2.0, 0.0);
    for told in [true, false] {
        let (mut app, tank, water, body) = bath();
        app.world_mut().despawn(body);
        // A tank whose water is its child.
        app.world_mut().entity_mut(tank).add_child(water);
        run(&mut app, 0.1);
        let count = particles(&app, water).len();
        let mut at = app.world_mut().get_mut::<Transform>(tank).unwrap();
        at.translation += way;
        let teleport = Teleport::of(tank);
        let teleport = if told {
            teleport.carrying(way)
        } else {
            teleport
        };
        app.world_mut().write_message(teleport);
        for _ in 0..30 {
            app.update();
            if told {
                assert_held(&app, tank, water, count);
            }
        }
        let x = mean(particles(&app, water).iter().map(|p| p.x));
        let expected = if told { way.x } else { 0.0 };
        assert!((x - expected).abs() < 0.5, "{x}");
        let speeds = &app.world().get::<FluidParticles>(water).unwrap().velocities;
        let fastest = speeds.iter().map(|v| v.length()).fold(0.0, f32::max);
        // Without the tank it falls for a quarter of a second.
        assert!(fastest < if told { 0.5 } else { 6.0 }, "{fastest} m/s");
    }
}

#[test]
fn a_wall_that_is_put_elsewhere_sweeps_nothing() {
    for (told, frames) in [(false, 1), (true, 1), (true, 4)] {
        let mut app = app();
        app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::ZERO;
        let wall = SalvaBoundary::new(Cuboid::new(0.2, 1.0, 1.0));
        let wall = app
            .world_mut()
            .spawn((wall, Transform::from_xyz(-0.2, 0.0, 0.0)));
        let wall = wall.id();
        let water = spawn_water(&mut app, vec![Vec3::ZERO]);
        run(&mut app, 0.05);
        for _ in 0..frames {
            let mut at = app.world_mut().get_mut::<Transform>(wall).unwrap();
            // 48 m/s is a motion.
            at.translation.x += 0.4 / frames as f32;
            if told {
                app.world_mut().write_message(Teleport::of(wall));
            }
            app.update();
        }
        let swept = particles(&app, water)[0].x;
        assert_eq!(swept.abs() < 0.3, told, "{swept}");
    }
}

/// A lid whose scale passes zero holds nothing there.
#[test]
fn h72_a_wall_without_an_extent_is_not_there() {
    let mut app = app();
    let floor = SalvaBoundary::new(Cuboid::new(1.0, 0.2, 1.0));
    let floor = app
        .world_mut()
        .spawn((floor, Transform::from_xyz(0.0, -0.2, 0.0)));
    let floor = floor.id();
    let water = spawn_water(&mut app, vec![Vec3::ZERO]);
    run(&mut app, 0.5);
    assert!(particles(&app, water)[0].y > -0.2);
    let scale = |app: &mut App, to: f32| {
        let mut place = app.world_mut().get_mut::<Transform>(floor).unwrap();
        place.scale = Vec3::splat(to);
    };
    scale(&mut app, 0.0);
    run(&mut app, 0.3);
    assert!(particles(&app, water)[0].y < -0.3, "it has fallen");
    // It is back, mirrored, and holds what is above it.
    scale(&mut app, -1.0);
    let other = spawn_water(&mut app, vec![vec3(0.0, 0.1, 0.3)]);
    run(&mut app, 0.5);
    assert!(particles(&app, other)[0].y > -0.2);
}

/// A pause, slow motion and fast motion: nothing is stuck, torn or lost, and a frame does no more
/// steps than it may.
#[test]
fn h65_time_may_stand_still_crawl_or_race() {
    for mode in [SalvaMode::Lockstep, SalvaMode::Background] {
        let (mut app, tank, water, _) = bath();
        let count = particles(&app, water).len();
        app.world_mut().resource_mut::<SalvaSettings>().mode = mode;
        let most = {
            let settings = app.world().resource::<SalvaSettings>();
            f64::from(settings.max_steps) * f64::from(settings.step)
        };
        let mut play = |speed: f32, frames: u32| {
            let mut time = app.world_mut().resource_mut::<Time<Virtual>>();
            time.set_relative_speed(speed);
            let start = status(&app).simulated;
            for _ in 0..frames {
                let before = status(&app).simulated;
                app.update();
                let speeds = &app.world().get::<FluidParticles>(water).unwrap().velocities;
                let fastest = speeds.iter().map(|v| v.length()).fold(0.0, f32::max);
                assert!(fastest < 1.0, "{fastest} m/s at {speed} times the speed");
                assert_held(&app, tank, water, count);
                let steps = status(&app).simulated - before;
                assert!(mode == SalvaMode::Lockstep || steps < 1.01 * most);
                sleep(Duration::from_millis(2));
            }
            (status(&app).simulated - start) as f32
        };
        let slow = play(0.01, 40);
        assert!(slow < 4.0 * STEP, "{slow} s in slow motion");
        // What was on its way when time stopped may still come in.
        play(0.0, 10);
        assert_eq!(play(0.0, 10), 0.0);
        let fast = play(10.0, 20);
        assert!(fast > 10.0 * STEP, "{fast} s in fast motion");
        assert!(play(1.0, 60) > 20.0 * STEP);
    }
}
