//! How particles vanish, and what a still emitter costs.

use bevy_fluid::{emitter::EmitterBounds, particles::ShapedFluid};

use super::*;

/// As `emitting`, and its particles are shaped.
fn shaping(emitter: ParticleEmitter) -> (App, Entity) {
    let (mut app, entity) = emitting(emitter);
    app.world_mut()
        .entity_mut(entity)
        .insert(SurfaceKernel::default());
    (app, entity)
}

/// How often the fluid has been shaped: once for every time that it has changed.
fn shapings(app: &App, entity: Entity) -> u64 {
    app.world().get::<ShapedFluid>(entity).unwrap().generation()
}

#[test]
fn they_vanish_at_their_lifetime() {
    for frames in [7.0, 60.0] {
        let (mut app, entity) = emitting(ParticleEmitter {
            rate: 1000.0,
            lifetime: 0.5,
            ..EXACT
        });
        run(&mut app, 2.0, frames);
        let particles = particles(&app, entity);
        assert_near(particles.len() as f32, 500.0, 1.5);
        assert!(particles.ages().iter().all(|age| (0.0..0.5).contains(age)));
        // The oldest first.
        assert!(particles.ages().is_sorted_by(|a, b| a > b));
        assert_eq!(drawn(&app, entity).len(), particles.len());
    }
}

#[test]
fn they_vanish_out_of_bounds() {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 1000.0,
        speed: 2.0,
        gravity: Vec3::ZERO,
        bounds: Some(EmitterBounds {
            min: vec3(-1.0, -1.0, -1.0),
            max: vec3(1.0, 0.5, 1.0),
        }),
        ..EXACT
    });
    // In the entity's space: half a unit is a metre here.
    *place(&mut app, entity) = Transform::from_xyz(0.0, 10.0, 0.0).with_scale(Vec3::splat(2.0));
    run(&mut app, 2.0, 60.0);
    // A metre at 2 m/s.
    let particles = particles(&app, entity);
    assert_near(particles.len() as f32, 500.0, 1.0);
    assert!(particles.positions().iter().all(|p| p.y <= 11.0));
}

#[test]
fn the_oldest_make_room_for_new_ones() {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 1000.0,
        capacity: 120,
        ..EXACT
    });
    run(&mut app, 1.0, 50.0);
    let ages = particles(&app, entity).ages();
    assert_eq!(ages.len(), 120);
    assert!(ages.iter().all(|&age| age < 0.1205));
    // Less room.
    emitter(&mut app, entity).capacity = 30;
    step(&mut app, 0.02);
    assert_eq!(particles(&app, entity).len(), 30);
    // More at once than there is room for: the last ones.
    emitter(&mut app, entity).burst(u32::MAX);
    step(&mut app, 0.02);
    assert_eq!(particles(&app, entity).ages(), [0.0; 30]);
    emitter(&mut app, entity).capacity = 0;
    step(&mut app, 0.02);
    assert!(particles(&app, entity).is_empty());
    assert!(drawn(&app, entity).is_empty());
}

#[test]
fn a_still_emitter_costs_nothing() {
    let (mut app, entity) = shaping(ParticleEmitter {
        lifetime: 0.2,
        enabled: false,
        ..EXACT
    });
    step(&mut app, 0.02);
    let untouched = shapings(&app, entity);
    run(&mut app, 0.5, 50.0);
    place(&mut app, entity).translation.y = 1.0;
    step(&mut app, 0.02);
    assert_eq!(shapings(&app, entity), untouched);

    emitter(&mut app, entity).burst(10);
    run(&mut app, 1.0, 50.0);
    assert!(drawn(&app, entity).is_empty());
    let gone = shapings(&app, entity);
    assert!(gone > untouched);
    run(&mut app, 0.5, 50.0);
    assert_eq!(shapings(&app, entity), gone);
}

#[test]
fn a_frame_without_time_changes_nothing() {
    let (mut app, entity) = shaping(EXACT);
    run(&mut app, 0.3, 30.0);
    let before = (shapings(&app, entity), drawn(&app, entity));
    for _ in 0..3 {
        step(&mut app, 0.0);
    }
    assert_eq!((shapings(&app, entity), drawn(&app, entity)), before);
}

#[test]
fn emitters_and_colliders_come_and_go() {
    let (mut app, entity) = emitting(EXACT);
    let ground = app.world_mut().spawn(ParticleCollider::ground()).id();
    run(&mut app, 0.2, 30.0);
    app.world_mut().despawn(ground);
    run(&mut app, 2.0, 30.0);
    let lowest = |app: &App| {
        let heights = particles(app, entity).positions().iter().map(|p| p.y);
        heights.fold(0.0, f32::min)
    };
    assert!(lowest(&app) < -1.0, "nothing holds them");
    // What is no emitter any more leaves its particles where they are.
    app.world_mut()
        .entity_mut(entity)
        .remove::<ParticleEmitter>();
    let left = drawn(&app, entity);
    run(&mut app, 0.2, 30.0);
    assert_eq!(drawn(&app, entity), left);
    app.world_mut().despawn(entity);
    run(&mut app, 0.2, 30.0);
}

#[test]
fn hidden_ones_go_on() {
    let (mut app, entity) = emitting(EXACT);
    app.world_mut()
        .entity_mut(entity)
        .insert(Visibility::Hidden);
    run(&mut app, 0.5, 50.0);
    assert_eq!(particles(&app, entity).len(), 500);
    assert_eq!(drawn(&app, entity).len(), 500);
}

#[test]
fn others_may_move_what_is_emitted() {
    let (mut app, entity) = emitting(EXACT);
    let own = FluidParticles::new(vec![Vec3::X], 0.1);
    app.world_mut()
        .entity_mut(entity)
        .insert((bevy_fluid::emitter::ExternalMotion, own));
    run(&mut app, 0.5, 50.0);
    assert!(particles(&app, entity).is_empty());
    assert_eq!(drawn(&app, entity), [Vec3::X]);
}
