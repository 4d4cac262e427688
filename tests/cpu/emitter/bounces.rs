//! Bouncing, sliding and rest, against closed forms.

use super::*;

const RADIUS: f32 = 0.02;

fn ground(app: &mut App, restitution: f32, friction: f32, transform: Transform) -> Entity {
    let ground = ParticleCollider {
        restitution,
        friction,
        ..ParticleCollider::ground()
    };
    app.world_mut().spawn((ground, transform)).id()
}

#[test]
fn each_bounce_is_as_high_as_the_one_before_times_restitution_squared() {
    for frames in [20.0, 60.0, 240.0] {
        for restitution in [0.3, 0.6, 0.9, 1.0] {
            let (mut app, entity) = emitting(one(0.0, Vec3::Y));
            place(&mut app, entity).translation.y = 1.0 + RADIUS;
            ground(&mut app, restitution, 0.3, Transform::default());
            step(&mut app, 0.01);
            // Energy of flight over weight: how high it would rise.
            let mut energies = vec![1.0_f32];
            for _ in 0..(2.0 * frames) as u32 {
                step(&mut app, 1.0 / frames);
                let (place, velocity) = single(&app, entity);
                let energy = place.y - RADIUS + velocity.y.powi(2) / (2.0 * G);
                if (energy - energies[energies.len() - 1]).abs() > 1e-3 {
                    energies.push(energy);
                }
            }
            if restitution == 1.0 {
                assert_eq!(energies.len(), 1, "nothing is lost: {energies:?}");
                continue;
            }
            let square = restitution * restitution;
            for (bounce, energy) in energies.iter().enumerate().take(4) {
                let expected = square.powi(bounce as i32);
                // Those that are shorter than a step may not be seen, or come to rest.
                if 8.0 * expected / G < 16.0 / (frames * frames) {
                    break;
                }
                assert_near(*energy, expected, 2e-3 * expected + 1e-4);
            }
            assert!(energies.len() > 1);
        }
    }
}

#[test]
fn friction_stops_a_slide_after_v2_over_2_mu_g() {
    for frames in [11.0, 60.0, 300.0] {
        for friction in [0.1, 0.5, 2.0] {
            let (mut app, entity) = emitting(one(3.0, Vec3::X));
            place(&mut app, entity).translation.y = RADIUS;
            ground(&mut app, 0.4, friction, Transform::default());
            step(&mut app, 0.01);
            let expected = 9.0 / (2.0 * friction * G);
            run(&mut app, 3.0 / (friction * G) + 0.5, frames);
            let (place, velocity) = single(&app, entity);
            assert_near(place.x, expected, 1e-3 * expected);
            assert_near(place.y, RADIUS, 1e-3 * RADIUS);
            assert_eq!(velocity, Vec3::ZERO);
        }
    }
}

#[test]
fn on_a_slope_it_stays_or_slides_as_friction_says() {
    let (slope, frames) = (0.5_f32, 60.0);
    for friction in [0.0, 0.3, 0.6] {
        let down = vec3(slope.cos(), -slope.sin(), 0.0);
        let up = vec3(slope.sin(), slope.cos(), 0.0);
        let (mut app, entity) = emitting(one(0.0, Vec3::Y));
        place(&mut app, entity).translation = up * RADIUS;
        let tilted = Transform::from_rotation(Quat::from_rotation_z(-slope));
        ground(&mut app, 0.2, friction, tilted);
        step(&mut app, 0.01);
        run(&mut app, 1.0, frames);
        let (place, _) = single(&app, entity);
        let pull = G * (slope.sin() - friction * slope.cos()).max(0.0);
        assert_near(place.dot(down), 0.5 * pull, 2e-3);
        assert_near(place.dot(up), RADIUS, 1e-4);
    }
}

#[test]
fn what_it_hits_at_an_angle_mirrors_it() {
    for frames in [13.0, 60.0] {
        let (mut app, entity) = emitting(ParticleEmitter {
            gravity: Vec3::ZERO,
            ..one(5.0, vec3(3.0, 4.0, 0.0))
        });
        let wall = ParticleCollider {
            restitution: 1.0,
            friction: 0.0,
            ..Cuboid::new(0.2, 20.0, 20.0).into()
        };
        app.world_mut()
            .spawn((wall, Transform::from_xyz(1.1 + RADIUS, 0.0, 0.0)));
        step(&mut app, 0.01);
        run(&mut app, 1.0, frames);
        // 3 m/s along x for a metre, and back.
        let (place, velocity) = single(&app, entity);
        assert!(place.distance(vec3(-1.0, 4.0, 0.0)) < 1e-3, "{place}");
        assert!(velocity.distance(vec3(-3.0, 4.0, 0.0)) < 1e-4, "{velocity}");
    }
}

#[test]
fn friction_takes_of_a_bounce_what_coulomb_says() {
    // Onto the ground at 45°: Δv along = μ (1 + e) v across.
    for (friction, along) in [(0.1, 3.0 - 0.1 * 1.5 * 3.0), (5.0, 0.0)] {
        let (mut app, entity) = emitting(ParticleEmitter {
            gravity: Vec3::ZERO,
            ..one(18_f32.sqrt(), vec3(1.0, -1.0, 0.0))
        });
        place(&mut app, entity).translation.y = 1.0;
        ground(&mut app, 0.5, friction, Transform::default());
        run(&mut app, 1.0, 60.0);
        let (_, velocity) = single(&app, entity);
        assert!(
            velocity.distance(vec3(along, 1.5, 0.0)) < 1e-4,
            "{velocity}"
        );
    }
}

#[test]
fn a_collider_that_moves_takes_particles_along() {
    for (restitution, expected) in [(0.0, 2.0), (0.5, 3.0), (1.0, 4.0)] {
        let (mut app, entity) = emitting(ParticleEmitter {
            gravity: Vec3::ZERO,
            ..one(0.0, Vec3::X)
        });
        let paddle = ParticleCollider {
            restitution,
            ..Cuboid::new(0.01, 1.0, 1.0).into()
        };
        let paddle = app
            .world_mut()
            .spawn((paddle, Transform::from_xyz(-1.0, 0.0, 0.0)))
            .id();
        step(&mut app, 0.01);
        for _ in 0..20 {
            place(&mut app, paddle).translation.x += 0.1;
            step(&mut app, 0.05);
        }
        let (place, velocity) = single(&app, entity);
        assert!(velocity.distance(Vec3::X * expected) < 1e-2, "{velocity}");
        assert!(place.x >= 1.0 + 0.005 + RADIUS - 1e-4, "{place}");
    }
}

#[test]
fn thousands_at_rest_stay_at_rest() {
    let (mut app, entity) = emitting(ParticleEmitter {
        nozzle_radius: 1.0,
        speed: 0.0,
        rate: 0.0,
        pending_burst: 3000,
        ..EXACT
    });
    place(&mut app, entity).translation.y = 0.3;
    ground(&mut app, 0.5, 0.5, Transform::default());
    run(&mut app, 2.0, 60.0);
    let before = particles(&app, entity).positions().to_vec();
    run(&mut app, 2.0, 60.0);
    for (before, after) in before.iter().zip(particles(&app, entity).positions()) {
        assert!(before.distance(*after) < 1e-5);
        assert_near(after.y, RADIUS, 1e-4);
    }
}
