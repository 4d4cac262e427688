//! What an emitter's fluid keeps, whatever else is done to it.

use bevy::prelude::*;
use bevy_fluid::{emitter::EmitterBounds, prelude::*};

use super::pool::{RADIUS, app, bare_app, block, particles, run, status};

const LIFETIME: f32 = 0.3;

/// Downwards, about 60 particles a second.
fn emitter() -> ParticleEmitter {
    ParticleEmitter {
        rate: 60.0,
        speed: 3.0,
        nozzle_radius: 0.3,
        direction: Vec3::NEG_Y,
        particle_radius: RADIUS,
        lifetime: LIFETIME,
        ..default()
    }
}

fn spawn(app: &mut App, emitter: ParticleEmitter) -> Entity {
    let jet = app.world_mut().spawn((emitter, SalvaFluid::WATER));
    jet.id()
}

/// The most that may be there by its lifetime.
fn most() -> usize {
    (60.0 * LIFETIME) as usize + 2
}

#[test]
fn capacity_holds_and_the_oldest_go() {
    let mut app = app();
    let capacity = 10;
    let lifetime = f32::INFINITY;
    let jet = spawn(
        &mut app,
        ParticleEmitter {
            capacity,
            lifetime,
            ..emitter()
        },
    );
    for i in 0..120 {
        app.update();
        let count = particles(&app, jet).len();
        // What came in with the last step goes with the next.
        assert!(count <= capacity as usize + 1, "{count} in update {i}");
    }
    let now = particles(&app, jet);
    assert!(now.len() >= capacity as usize);
    // A second of falling leads 8 m down.
    assert!(now.iter().all(|p| p.y > -3.0), "the oldest are still there");
}

#[test]
fn bounds_hold_in_the_emitters_space() {
    let mut app = app();
    let bounds = EmitterBounds {
        min: Vec3::splat(-1.0),
        max: Vec3::ONE,
    };
    let jet = spawn(
        &mut app,
        ParticleEmitter {
            bounds: Some(bounds),
            lifetime: f32::INFINITY,
            ..emitter()
        },
    );
    let away = Vec3::X * 3.0;
    app.world_mut()
        .get_mut::<Transform>(jet)
        .unwrap()
        .translation = away;
    run(&mut app, 1.0);
    let now = particles(&app, jet);
    assert!(now.len() > 5);
    // In the entity's space; the last step may lead out.
    assert!(now.iter().all(|p| p.y > -1.1), "{now:?}");
    // They are where the box is now.
    app.world_mut()
        .get_mut::<Transform>(jet)
        .unwrap()
        .translation = -away;
    run(&mut app, 0.02);
    assert!(particles(&app, jet).len() < 5);
}

#[test]
fn limits_hold_when_positions_are_written() {
    let mut app = app();
    let jet = spawn(&mut app, emitter());
    run(&mut app, 0.1);
    let mut fluid = app.world_mut().get_mut::<FluidParticles>(jet).unwrap();
    fluid.positions = block(vec3(-0.5, -4.0, -0.5), vec3(0.5, -3.5, 0.5));
    run(&mut app, 2.0 * LIFETIME);
    let count = particles(&app, jet).len();
    assert!(count > 5 && count <= most(), "{count}");
}

#[test]
fn limits_hold_when_the_radius_changes() {
    let mut app = app();
    let jet = spawn(&mut app, emitter());
    run(&mut app, 0.1);
    let mut emitter = app.world_mut().get_mut::<ParticleEmitter>(jet).unwrap();
    emitter.particle_radius = 0.8 * RADIUS;
    run(&mut app, 3.0 * LIFETIME);
    let count = particles(&app, jet).len();
    assert!(count > 5 && count <= most(), "{count}");
}

#[test]
fn limits_go_with_the_emitter() {
    let mut app = app();
    let jet = spawn(&mut app, emitter());
    run(&mut app, 0.2);
    app.world_mut().entity_mut(jet).remove::<ParticleEmitter>();
    let count = particles(&app, jet).len();
    run(&mut app, 2.0 * LIFETIME);
    // One may have been on its way.
    let left = particles(&app, jet).len();
    assert!(left == count || left == count + 1, "{left} of {count}");
    // And come with another.
    app.world_mut().entity_mut(jet).insert(emitter());
    run(&mut app, 2.0 * LIFETIME);
    let count = particles(&app, jet).len();
    assert!(count > 5 && count <= most(), "{count}");
}

#[test]
fn an_emitter_may_come_before_the_plugin() {
    let mut app = bare_app();
    let jet = spawn(&mut app, emitter());
    app.add_plugins(SalvaPlugin);
    app.insert_resource(SalvaSettings {
        mode: SalvaMode::Lockstep,
        ..default()
    });
    app.finish();
    app.cleanup();
    run(&mut app, 3.0 * LIFETIME);
    let count = particles(&app, jet).len();
    assert!(count > 5 && count <= most(), "{count}");
}

#[test]
fn newborn_particles_fall_by_what_gravity_is_taken_for() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().gravity = Vec3::NAN;
    let jet = spawn(&mut app, emitter());
    run(&mut app, LIFETIME);
    assert!(particles(&app, jet).len() > 5);
    assert_eq!(status(&app).broken, 0);
}
