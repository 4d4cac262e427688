//! Live simulation against what is known in closed form: weight, free fall, Archimedes; and that
//! nothing leaks, whatever happens.

#![cfg(feature = "salva")]

use std::{f32::consts::PI, time::Duration};

use bevy::{asset::AssetPlugin, mesh::MeshPlugin, prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{
    ExternalMotion, ParticleEmitter,
    prelude::*,
    salva::{SalvaLoad, SalvaStatus},
};

const RADIUS: f32 = 0.05;
const GRAVITY: f32 = 9.81;
const WATER: f32 = 1000.0;
/// One step an update.
const STEP: f32 = 1.0 / 120.0;

/// An app in lockstep, without anything that draws.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        MeshPlugin,
        SalvaPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
        STEP,
    )))
    .insert_resource(SalvaSettings {
        mode: SalvaMode::Lockstep,
        ..default()
    });
    app.finish();
    app.cleanup();
    // The first update has no time yet.
    app.update();
    app
}

fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / STEP).round() as u32 {
        app.update();
    }
}

/// Particles two radii apart, one radius off the walls of a block.
fn block(low: Vec3, high: Vec3) -> Vec<Vec3> {
    let counts = ((high - low) / (2.0 * RADIUS)).round().as_ivec3();
    let mut particles = Vec::new();
    for x in 0..counts.x {
        for y in 0..counts.y {
            for z in 0..counts.z {
                particles.push(low + (ivec3(x, y, z).as_vec3() + 0.5) * 2.0 * RADIUS);
            }
        }
    }
    particles
}

/// A tank that stands on y = 0 about the origin, filled up to `depth`.
fn pool(app: &mut App, size: Vec3, depth: f32) -> (Entity, Entity) {
    let tank = app.world_mut().spawn((
        SalvaBoundary::tank(size),
        SalvaLoad::default(),
        Transform::from_xyz(0.0, 0.5 * size.y, 0.0),
    ));
    let tank = tank.id();
    let low = vec3(-0.5 * size.x, 0.0, -0.5 * size.z);
    let water = block(low, vec3(-low.x, depth, -low.z));
    (tank, spawn_water(app, water))
}

fn spawn_water(app: &mut App, particles: Vec<Vec3>) -> Entity {
    let particles = FluidParticles::new(particles, RADIUS);
    app.world_mut().spawn((particles, SalvaFluid::WATER)).id()
}

fn particles(app: &App, fluid: Entity) -> &[Vec3] {
    &app.world().get::<FluidParticles>(fluid).unwrap().positions
}

fn status(app: &App) -> &SalvaStatus {
    app.world().resource::<SalvaStatus>()
}

fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    sum / count as f32
}

fn weight_of(count: usize) -> f32 {
    count as f32 * (2.0 * RADIUS).powi(3) * WATER * GRAVITY
}

#[test]
fn a_column_keeps_its_height_and_rests_its_weight_on_the_tank() {
    let mut app = app();
    let depth = 1.2;
    let (tank, water) = pool(&mut app, vec3(0.8, 2.0, 0.8), depth);
    run(&mut app, 1.5);
    let (mut heights, mut forces) = (Vec::new(), Vec::new());
    for _ in 0..120 {
        app.update();
        heights.push(mean(particles(&app, water).iter().map(|p| p.y)));
        forces.push(app.world().get::<SalvaLoad>(tank).unwrap().force);
    }
    let count = particles(&app, water).len();
    assert_eq!(count, 8 * 8 * 12, "none is lost");
    // Volume: the mean height is half the depth. 3 % is what a layer of particles at the walls
    // (an eighth of the width each) may be off by a fifth.
    let height = mean(heights.into_iter());
    assert!((height / (0.5 * depth) - 1.0).abs() < 0.03, "{height}");
    // The push of walls cancels, that of the floor is the weight.
    let force = forces.iter().sum::<Vec3>() / forces.len() as f32;
    let weight = weight_of(count);
    assert!(
        (force.y / -weight - 1.0).abs() < 0.03,
        "{force} of {weight}"
    );
    assert!(force.xz().length() < 0.03 * weight, "{force}");
}

#[test]
fn a_drop_falls_by_half_g_t_squared() {
    let mut app = app();
    let water = spawn_water(&mut app, block(Vec3::splat(-0.1), Vec3::splat(0.1)));
    run(&mut app, 0.5);
    let fallen = -mean(particles(&app, water).iter().map(|p| p.y));
    let time = status(&app).simulated as f32;
    assert!((time - 0.5).abs() < 1e-4, "lockstep keeps time: {time}");
    // Euler's symplectic step is early by g t dt / 2.
    let exact = 0.5 * GRAVITY * time * time;
    let error = 0.5 * GRAVITY * time * STEP;
    assert!((fallen - exact).abs() < 1.1 * error, "{fallen} of {exact}");
}

/// Height of a body's centre above the floor after some time in a pool of depth 0.8 over 1.2 × 1.2.
fn settle_body(shape: SalvaShape, density: f32, from: f32) -> (App, f32) {
    let mut app = app();
    pool(&mut app, vec3(1.2, 2.0, 1.2), 0.8);
    let body = app.world_mut().spawn((
        SalvaBody::new(shape, density),
        Transform::from_xyz(0.0, from, 0.0),
    ));
    let body = body.id();
    run(&mut app, 2.5);
    let mut heights = Vec::new();
    for _ in 0..60 {
        app.update();
        heights.push(app.world().get::<Transform>(body).unwrap().translation.y);
    }
    (app, mean(heights.into_iter()))
}

#[test]
fn a_box_floats_as_deep_as_archimedes_has_it() {
    let side = 0.4;
    for density in [300.0, 600.0] {
        let size = Vec3::splat(side);
        let (_, height) = settle_body(SalvaShape::Cuboid { size }, density, 1.1);
        let immersed = side * density / WATER;
        let level = 0.8 + immersed * side * side / (1.2 * 1.2);
        let expected = level - immersed + 0.5 * side;
        // The liquid's surface is no sharper than a particle, and as its level is off by up to 3 %
        // so is the body's.
        let error = height - expected;
        assert!(
            error.abs() < RADIUS,
            "density {density}: {height} for {expected}"
        );
    }
}

#[test]
fn what_is_heavier_sinks_to_the_bottom() {
    let radius = 0.2;
    let (_, height) = settle_body(SalvaShape::Sphere { radius }, 3000.0, 1.1);
    assert!((height - radius).abs() < 0.01, "{height}");
}

fn is_within(place: Vec3, size: Vec3) -> bool {
    let local = place - Vec3::Y * 0.5 * size.y;
    local.abs().cmple(0.5 * size + 1e-4).all()
}

#[test]
fn a_shaken_tank_does_not_leak() {
    let mut app = app();
    let size = vec3(0.8, 6.0, 0.8);
    let (tank, water) = pool(&mut app, size, 0.8);
    let count = particles(&app, water).len();
    for i in 0..240 {
        // To and fro by 0.15 m at up to 1.9 m/s, turning all the while.
        let time = i as f32 * STEP;
        let mut transform = app.world_mut().get_mut::<Transform>(tank).unwrap();
        transform.translation.x = 0.15 * (4.0 * PI * time).sin();
        transform.rotation = Quat::from_rotation_y(2.0 * time);
        app.update();
        let transform = *app.world().get::<Transform>(tank).unwrap();
        let to_tank = transform.compute_affine().inverse();
        for place in particles(&app, water) {
            let local = to_tank.transform_point3(*place) + Vec3::Y * 0.5 * size.y;
            let is_above = local.y > size.y;
            assert!(is_above || is_within(local, size), "{local} in update {i}");
        }
    }
    assert_eq!(particles(&app, water).len(), count);
}

/// A bowl: the lower half of a sphere, seen from inside.
fn bowl(radius: f32) -> Mesh {
    let ball = Sphere::new(radius).mesh().uv(24, 12);
    let positions = ball.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
    let positions: Vec<Vec3> = positions
        .as_float3()
        .unwrap()
        .iter()
        .map(|&p| p.into())
        .collect();
    let indices: Vec<usize> = ball.indices().unwrap().iter().collect();
    let mut corners = Vec::new();
    for face in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| positions[face[i]]);
        if a.y + b.y + c.y < 0.0 {
            corners.extend([a, c, b].map(|corner| corner.to_array()));
        }
    }
    Mesh::new(default(), default()).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
}

#[test]
fn a_mesh_holds_water_and_its_scale_counts() {
    let mut app = app();
    let radius = 0.7;
    // Half as large, scaled by two.
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(bowl(0.5 * radius));
    let scale = Transform::from_scale(Vec3::splat(2.0));
    app.world_mut()
        .spawn((SalvaBoundary::MESH, Mesh3d(mesh), scale));
    // Dropped from above the rim onto the ground of the bowl, at 3 m/s.
    let water = spawn_water(&mut app, block(vec3(-0.3, -0.2, -0.3), vec3(0.3, 0.3, 0.3)));
    app.world_mut()
        .get_mut::<SalvaFluid>(water)
        .unwrap()
        .velocity = Vec3::NEG_Y * 3.0;
    let count = particles(&app, water).len();
    let is_inside = |place: &Vec3| place.length() < radius && place.y < 0.0;
    // Some may splash over the rim, but none goes through below it.
    let is_outside = |place: &Vec3| place.length() > radius + 1e-3 && place.y < -0.1;
    for i in 0..240 {
        let before = particles(&app, water).to_vec();
        app.update();
        let now = particles(&app, water);
        assert_eq!(now.len(), count);
        for (before, now) in before.iter().zip(now) {
            let leaks = is_inside(before) && is_outside(now);
            assert!(!leaks, "{before} to {now} in update {i}");
        }
    }
    let left = particles(&app, water).iter().filter(|p| is_inside(p));
    let left = left.count();
    assert!(left > count / 2, "{left} of {count}");
}

#[test]
fn lockstep_repeats_itself() {
    let play = || {
        let mut app = app();
        let (_, water) = pool(&mut app, vec3(1.2, 1.0, 0.6), 0.4);
        let size = Vec3::splat(0.3);
        let body = app.world_mut().spawn((
            SalvaBody::new(SalvaShape::Cuboid { size }, 400.0),
            Transform::from_xyz(0.1, 0.8, 0.05),
        ));
        let body = body.id();
        run(&mut app, 0.6);
        let at = *app.world().get::<Transform>(body).unwrap();
        (particles(&app, water).to_vec(), at)
    };
    assert_eq!(play(), play());
}

#[test]
fn broken_particles_go_and_the_others_stay() {
    let mut app = app();
    let mut places = block(Vec3::splat(-0.1), Vec3::splat(0.1));
    let sound = places.len();
    places.extend([Vec3::NAN, Vec3::splat(f32::INFINITY), Vec3::splat(2e3)]);
    let water = spawn_water(&mut app, places);
    run(&mut app, 0.1);
    assert_eq!(particles(&app, water).len(), sound);
    assert!(particles(&app, water).iter().all(|p| p.is_finite()));
    assert_eq!(status(&app).broken, 2, "the third is out of bounds only");
    // Two in one place push each other no faster than the limit.
    let empty = spawn_water(&mut app, Vec::new());
    let twins = spawn_water(&mut app, vec![Vec3::X * 9.0; 2]);
    run(&mut app, 0.1);
    assert!(particles(&app, empty).is_empty());
    assert!(particles(&app, twins).iter().all(|p| p.is_finite()));
    assert!(!status(&app).stopped);
}

#[test]
fn everything_may_come_and_go() {
    let mut app = app();
    let (tank, water) = pool(&mut app, vec3(0.8, 1.0, 0.8), 0.4);
    let size = Vec3::splat(0.2);
    let body = SalvaBody::new(SalvaShape::Cuboid { size }, 400.0);
    let body = app
        .world_mut()
        .spawn((body, Transform::from_xyz(0.0, 0.8, 0.0)))
        .id();
    let other = spawn_water(
        &mut app,
        block(vec3(-0.2, 0.45, -0.2), vec3(0.2, 0.65, 0.2)),
    );
    let others = particles(&app, other).len();
    run(&mut app, 0.1);
    app.world_mut().despawn(water);
    run(&mut app, 0.05);
    assert_eq!(status(&app).particles, others);
    app.world_mut().despawn(body);
    app.world_mut().entity_mut(tank).remove::<SalvaBoundary>();
    run(&mut app, 0.5);
    // Nothing is left that would hold it.
    assert!(particles(&app, other).iter().all(|p| p.y < 0.0));
    // Another radius may come when no fluid is left.
    app.world_mut().despawn(other);
    let small = FluidParticles::new(vec![Vec3::ZERO], 0.02);
    let small = app.world_mut().spawn((small, SalvaFluid::WATER)).id();
    run(&mut app, 0.1);
    assert!(particles(&app, small)[0].y < -0.01);
    // But not beside it.
    let large = spawn_water(&mut app, vec![Vec3::X]);
    run(&mut app, 0.1);
    assert_eq!(particles(&app, large), [Vec3::X]);
}

#[test]
fn an_emitter_feeds_the_liquid() {
    let mut app = app();
    let emitter = ParticleEmitter {
        rate: 200.0,
        speed: 2.0,
        nozzle: 0.15,
        direction: Vec3::NEG_Y,
        particle_radius: RADIUS,
        lifetime: 0.5,
        ..default()
    };
    let above = Transform::from_xyz(0.0, 1.0, 0.0);
    let jet = app.world_mut().spawn((emitter, SalvaFluid::WATER, above));
    let jet = jet.id();
    app.world_mut()
        .spawn((SalvaBoundary::PLANE, Transform::default()));
    assert!(app.world().get::<ExternalMotion>(jet).is_some());
    run(&mut app, 0.3);
    let count = particles(&app, jet).len();
    // No more than fit through: 2 m/s over the nozzle's disc and half a particle around it.
    let flux = 2.0 * PI * (0.15_f32 + RADIUS).powi(2) / (2.0 * RADIUS * 0.8).powi(3);
    let most = (200.0_f32 * 0.3).min(flux * 0.3);
    assert!(
        count as f32 > 0.4 * most && count as f32 <= most + 2.0,
        "{count} of {most}"
    );
    run(&mut app, 1.0);
    // In the steady state the oldest go as new ones come.
    let steady = particles(&app, jet).len();
    assert!(steady < 110 && steady > 30, "{steady}");
    // On the plane they lie, not below.
    let lowest = particles(&app, jet).iter().map(|p| p.y + 1.0);
    let lowest = lowest.fold(f32::INFINITY, f32::min);
    assert!((0.0..2.0 * RADIUS).contains(&lowest), "{lowest}");
}

#[test]
fn a_moved_tank_takes_its_water_along() {
    let mut app = app();
    let size = vec3(0.6, 1.0, 0.6);
    let (tank, water) = pool(&mut app, size, 0.4);
    let speed = 1.0;
    for _ in 0..120 {
        let mut transform = app.world_mut().get_mut::<Transform>(tank).unwrap();
        transform.translation.x += speed * STEP;
        app.update();
    }
    let x = mean(particles(&app, water).iter().map(|p| p.x));
    assert!((x - 1.0).abs() < 0.1, "{x}");
}

/// Prints what steps cost.
#[test]
#[ignore = "a measurement"]
fn cost() {
    println!("| particles | ms per step |\n|---|---|");
    for side in [10, 15, 20, 30] {
        let mut app = app();
        let width = side as f32 * 2.0 * RADIUS;
        pool(&mut app, vec3(2.0 * width, 2.0 * width, width), width);
        run(&mut app, 0.3);
        let mut times = Vec::new();
        for _ in 0..20 {
            app.update();
            times.push(status(&app).step_time.as_secs_f32() * 1e3);
        }
        times.sort_by(f32::total_cmp);
        println!("| {} | {:.1} |", status(&app).particles, times[10]);
    }
}
