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

/// A pause in which things are dragged about, slow motion and fast motion: as at any other time.
#[test]
fn h65_time_may_stand_still_crawl_or_race() {
    let (mut app, entity) = scene();
    let mut floors = app.world_mut().query::<(Entity, &ParticleCollider)>();
    let colliders: Vec<_> = floors.iter(app.world()).map(|(it, _)| it).collect();
    let speed = |app: &mut App, speed: f32| {
        let mut time = app.world_mut().resource_mut::<Time<Virtual>>();
        time.set_relative_speed(speed);
    };
    let sound = |app: &App| {
        let particles = particles(app, entity);
        let places = particles.positions().iter().zip(particles.velocities());
        let fastest = places.map(|(p, v)| {
            assert!(p.is_finite() && p.length() < 10.0, "{p}");
            // 3.2 m/s out of the nozzle, and 3.9 m/s from a lifetime's fall.
            v.length()
        });
        let fastest = fastest.fold(0.0, f32::max);
        assert!(fastest < 8.0, "{fastest} m/s");
        particles.len() as f32
    };
    run(&mut app, 0.5, 60.0);
    assert_near(sound(&app), 24_000.0, 2.0);

    app.world_mut().resource_mut::<Time<Virtual>>().pause();
    let before = bits(&app, entity);
    for _ in 0..20 {
        place(&mut app, entity).translation.x += 0.1;
        for &collider in &colliders {
            place(&mut app, collider).translation.y += 0.02;
        }
        step(&mut app, 1.0 / 60.0);
    }
    assert!(bits(&app, entity) == before, "nothing moves in no time");
    app.world_mut().resource_mut::<Time<Virtual>>().unpause();
    step(&mut app, 1.0 / 60.0);
    // None was born on the way there, and the floor, 0.4 m higher, throws none.
    sound(&app);
    let young = particles(&app, entity)
        .ages()
        .iter()
        .zip(drawn(&app, entity));
    let young: Vec<_> = young.filter(|(age, _)| **age < 1.0 / 60.0).collect();
    assert_near(young.len() as f32, 1000.0, 2.0);
    assert!(young.iter().all(|(_, place)| place.x > 1.8));

    speed(&mut app, 0.01);
    // Moved by a hand that time does not slow down.
    let before = particles(&app, entity).len() as f32;
    for frame in 0..100 {
        place(&mut app, entity).translation.x -= 0.02;
        // At 1.2 m/s, or 120 m/s in this time.
        if frame < 20 {
            for &collider in &colliders {
                place(&mut app, collider).translation.y -= 0.02;
            }
        }
        step(&mut app, 1.0 / 60.0);
    }
    assert_near(sound(&app), before, 1100.0);

    speed(&mut app, 10.0);
    for _ in 0..60 {
        step(&mut app, 1.0 / 60.0);
        assert!(sound(&app) <= 24_002.0);
    }
    speed(&mut app, 1.0);
    run(&mut app, 0.5, 60.0);
    assert_near(sound(&app), 24_000.0, 2.0);
}
