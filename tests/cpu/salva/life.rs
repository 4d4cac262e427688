//! What comes, goes and breaks; and that it does so again.

use std::f32::consts::PI;

use bevy::prelude::*;
use bevy_fluid::{emitter::ExternalMotion, prelude::*};

use super::pool::{RADIUS, app, block, particles, pool, run, spawn_water, status};

#[test]
fn lockstep_repeats_itself() {
    let play = || {
        let mut app = app();
        let (_, water) = pool(&mut app, vec3(1.2, 1.0, 0.6), 0.4);
        let size = Vec3::splat(0.3);
        let body = app.world_mut().spawn((
            SalvaBody::new(Cuboid::from_size(size), 400.0),
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
    let body = SalvaBody::new(Cuboid::from_size(size), 400.0);
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
        nozzle_radius: 0.15,
        direction: Vec3::NEG_Y,
        particle_radius: RADIUS,
        lifetime: 0.5,
        ..default()
    };
    let above = Transform::from_xyz(0.0, 1.0, 0.0);
    let jet = app.world_mut().spawn((emitter, SalvaFluid::WATER, above));
    let jet = jet.id();
    app.world_mut()
        .spawn((SalvaBoundary::GROUND, Transform::default()));
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
    let lowest = particles(&app, jet).iter().map(|p| p.y);
    let lowest = lowest.fold(f32::INFINITY, f32::min);
    assert!((0.0..2.0 * RADIUS).contains(&lowest), "{lowest}");
}
