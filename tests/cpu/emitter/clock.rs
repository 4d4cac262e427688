//! Time: equal steps, long ones, none, and pauses.

use bevy::ecs::schedule::SingleThreadedExecutor;

use super::*;

/// A busy scene.
fn scene() -> (App, Entity) {
    let (mut app, entity) = emitting(ParticleEmitter {
        seed: 7,
        lifetime: 0.4,
        drag: 0.3,
        ..ParticleEmitter::fountain(60_000.0, 3.0)
    });
    app.world_mut().spawn(ParticleCollider::ground());
    app.world_mut().spawn((
        ParticleCollider::from(Sphere::new(0.1)),
        Transform::from_xyz(0.0, 0.4, 0.0),
    ));
    app.edit_schedule(PostUpdate, |schedule| {
        schedule.set_executor(SingleThreadedExecutor::new());
    });
    (app, entity)
}

fn bits(app: &App, entity: Entity) -> Vec<[u32; 6]> {
    let particles = particles(app, entity);
    let places = particles.positions().iter().zip(particles.velocities());
    places
        .map(|(p, v)| [p.x, p.y, p.z, v.x, v.y, v.z].map(f32::to_bits))
        .collect()
}

#[test]
fn equal_steps_give_equal_particles_on_any_number_of_threads() {
    let results = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let (mut app, entity) = scene();
            for frame in 0..60 {
                place(&mut app, entity).translation.x = 0.1 * (0.3 * frame as f32).sin();
                step(&mut app, 1.0 / 60.0);
            }
            bits(&app, entity)
        })
    });
    // More than any one task moves.
    assert!(results[0].len() > 20_000, "{}", results[0].len());
    assert!(results[0] == results[1] && results[1] == results[2]);
}

#[test]
fn other_seeds_give_other_particles() {
    let first = |seed| {
        let (mut app, entity) = emitting(ParticleEmitter {
            seed,
            ..ParticleEmitter::fountain(100.0, 3.0)
        });
        step(&mut app, 0.1);
        bits(&app, entity)
    };
    assert_eq!(first(3), first(3));
    assert_ne!(first(3), first(4));
}

#[test]
fn a_pause_holds_everything() {
    let (mut app, entity) = scene();
    run(&mut app, 0.2, 60.0);
    let before = bits(&app, entity);
    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    run(&mut app, 0.5, 60.0);
    assert!(bits(&app, entity) == before);
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    step(&mut app, 1.0 / 60.0);
    assert!(bits(&app, entity) != before);
}

#[test]
fn a_frame_that_took_forever_is_a_quarter_of_a_second() {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 1000.0,
        ..EXACT
    });
    app.world_mut()
        .resource_mut::<Time<Virtual>>()
        .set_max_delta(Duration::MAX);
    step(&mut app, 2.0);
    assert_eq!(particles(&app, entity).len(), 250);
}

#[test]
fn a_step_of_a_nanosecond_is_one() {
    let (mut app, entity) = emitting(one(4.0, Vec3::Y));
    app.world_mut().spawn((
        ParticleCollider::ground(),
        Transform::from_xyz(0.0, -0.02, 0.0),
    ));
    for _ in 0..100 {
        step(&mut app, 1e-9);
    }
    let (place, velocity) = single(&app, entity);
    assert!(place.is_finite() && place.length() < 1e-5);
    assert_near(velocity.y, 4.0, 1e-4);
}
