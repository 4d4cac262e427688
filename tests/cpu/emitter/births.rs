//! How many particles come out, when and where.

use std::f32::consts::{FRAC_PI_2, PI};

use super::*;

#[test]
fn as_many_come_out_as_the_rate_says_at_any_frame_rate() {
    for rate in [0.7, 60.0, 1234.5, 20_000.0] {
        for frames in [5.0, 24.0, 60.0, 143.7, 500.0] {
            let (mut app, entity) = emitting(ParticleEmitter { rate, ..EXACT });
            run(&mut app, 2.0, frames);
            let seconds = (2.0 * frames).round() / frames;
            let count = particles(&app, entity).len() as f32;
            assert_near(count, rate * seconds, 1.0 + 1e-5 * rate);
        }
    }
}

#[test]
fn the_same_particles_come_out_at_any_frame_rate() {
    let emitter = ParticleEmitter {
        rate: 200.0,
        drag: 0.7,
        lifetime: f32::INFINITY,
        ..ParticleEmitter::fountain(200.0, 5.0)
    };
    let (mut slow, a) = emitting(emitter);
    let (mut fast, b) = emitting(emitter);
    run(&mut slow, 1.0, 8.0);
    run(&mut fast, 1.0, 128.0);
    let (slow, fast) = (particles(&slow, a), particles(&fast, b));
    assert_eq!((slow.len(), fast.len()), (200, 200));
    for i in 0..200 {
        assert_near(slow.ages()[i], fast.ages()[i], 1e-5);
        let apart = slow.positions()[i].distance(fast.positions()[i]);
        assert!(apart < 1e-4, "{apart} m");
    }
}

#[test]
fn a_jet_is_even_across_frames() {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 500.0,
        speed: 10.0,
        gravity: Vec3::ZERO,
        ..EXACT
    });
    for seconds in [0.01, 0.033, 0.0015, 0.1, 0.0007, 0.02, 0.05] {
        step(&mut app, seconds);
    }
    let places = particles(&app, entity).positions();
    assert!(places.len() >= 107);
    for pair in places.windows(2) {
        assert_near(pair[0].y - pair[1].y, 10.0 / 500.0, 1e-5);
    }
}

#[test]
fn a_moving_emitter_leaves_no_clumps() {
    let still = ParticleEmitter {
        rate: 300.0,
        speed: 0.0,
        gravity: Vec3::ZERO,
        ..EXACT
    };
    let (mut app, entity) = emitting(still);
    step(&mut app, 1e-6);
    for _ in 0..10 {
        place(&mut app, entity).translation.x += 1.0;
        step(&mut app, 0.05);
    }
    let places = drawn(&app, entity);
    assert_eq!(places.len(), 150);
    for pair in places.windows(2) {
        // 20 m/s over 300 particles a second.
        assert!((pair[1] - pair[0] - Vec3::X * 20.0 / 300.0).length() < 1e-4);
    }
    // One that turns spreads them around.
    let (mut app, entity) = emitting(ParticleEmitter {
        speed: 1.0,
        ..still
    });
    step(&mut app, 1e-6);
    for _ in 0..8 {
        place(&mut app, entity).rotate_z(0.5);
        step(&mut app, 0.05);
    }
    let directions = particles(&app, entity).velocities();
    for pair in directions.windows(2) {
        assert_near(pair[0].angle_between(pair[1]), 10.0 / 300.0, 1e-3);
    }
}

#[test]
fn an_emitter_put_back_elsewhere_starts_there() {
    let still = ParticleEmitter {
        rate: 100.0,
        speed: 0.0,
        gravity: Vec3::ZERO,
        ..EXACT
    };
    let (mut app, entity) = emitting(still);
    step(&mut app, 0.05);
    app.world_mut()
        .entity_mut(entity)
        .remove::<ParticleEmitter>();
    step(&mut app, 0.05);
    place(&mut app, entity).translation.x = 100.0;
    app.world_mut().entity_mut(entity).insert(still);
    step(&mut app, 0.1);
    let places = drawn(&app, entity);
    assert_eq!(places.len(), 15);
    let is_at_either = |x: f32| x.abs() < 1e-3 || (x - 100.0).abs() < 1e-3;
    assert!(places.iter().all(|p| is_at_either(p.x)), "{places:?}");
}

#[test]
fn what_is_out_stays_in_the_world() {
    let (mut app, entity) = emitting(ParticleEmitter {
        speed: 0.0,
        gravity: Vec3::ZERO,
        nozzle_radius: 0.5,
        ..EXACT
    });
    let parent = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().entity_mut(parent).add_child(entity);
    run(&mut app, 0.1, 100.0);
    emitter(&mut app, entity).stop();
    let before = drawn(&app, entity);
    assert_eq!(before.len(), 100);
    *place(&mut app, entity) = Transform::from_xyz(3.0, -1.0, 2.0)
        .with_rotation(Quat::from_rotation_y(1.0))
        .with_scale(vec3(0.5, 2.0, -3.0));
    place(&mut app, parent).rotate_x(0.7);
    // While no time passes, too.
    for seconds in [0.0, 0.02] {
        step(&mut app, seconds);
        for (before, after) in before.iter().zip(drawn(&app, entity)) {
            assert!(before.distance(after) < 1e-5);
        }
    }
}

#[test]
fn the_cone_is_filled_evenly() {
    for (spread, scale) in [(0.3, 1.0), (FRAC_PI_2, 2.5), (PI, 1.0)] {
        let (mut app, entity) = emitting(ParticleEmitter {
            cone_half_angle: spread,
            speed: 3.0,
            direction: vec3(0.0, 0.0, 2.0),
            gravity: Vec3::ZERO,
            pending_burst: 40_000,
            rate: 0.0,
            ..EXACT
        });
        let turn = Quat::from_rotation_arc(Vec3::Z, vec3(0.6, 0.0, -0.8));
        *place(&mut app, entity) = Transform::from_rotation(turn).with_scale(Vec3::splat(scale));
        step(&mut app, 0.01);
        let particles = particles(&app, entity);
        let directions = particles.velocities().iter();
        // Along the axis the mean of an even cap is half-way between its ends; across it is none.
        let mean = directions
            .map(|velocity| {
                assert_near(velocity.length(), 3.0, 1e-5);
                let direction = turn.inverse() * *velocity / 3.0;
                assert!(direction.z >= spread.cos() - 1e-5, "{direction}");
                direction
            })
            .sum::<Vec3>()
            / 40_000.0;
        // Four standard deviations of the mean, at most.
        let slack = 4.0 / 40_000_f32.sqrt();
        let expected = Vec3::Z * 0.5 * (1.0 + spread.cos());
        assert!((mean - expected).abs().max_element() < slack, "{mean}");
    }
}

#[test]
fn the_nozzle_is_an_even_disc_and_jitter_an_even_ball() {
    let (mut app, entity) = emitting(ParticleEmitter {
        nozzle_radius: 0.4,
        speed: 0.0,
        jitter: 2.0,
        direction: Vec3::X,
        gravity: Vec3::ZERO,
        pending_burst: 40_000,
        rate: 0.0,
        ..EXACT
    });
    place(&mut app, entity).translation = vec3(0.0, 1.0, 0.0);
    step(&mut app, 0.01);
    let particles = particles(&app, entity);
    let squares = |values: &[Vec3], center: Vec3, most: f32| {
        let squares = values.iter().map(|value| {
            let square = value.distance_squared(center);
            assert!(square.sqrt() <= most * 1.0001);
            square
        });
        squares.sum::<f32>() / values.len() as f32
    };
    // The mean square is R²/2 over a disc and 3R²/5 over a ball.
    let disc = squares(particles.positions(), Vec3::Y, 0.4);
    assert_near(disc, 0.08, 0.02 * 0.08);
    assert!(particles.positions().iter().all(|p| p.x.abs() < 1e-6));
    let ball = squares(particles.velocities(), Vec3::ZERO, 2.0);
    assert_near(ball, 2.4, 0.02 * 2.4);
}

#[test]
fn presets_aim_where_they_say() {
    for (emitter, expected) in [
        (ParticleEmitter::jet(50.0, 7.0), Vec3::NEG_Z * 7.0),
        (ParticleEmitter::fountain(50.0, 7.0), Vec3::Y * 7.0),
        (ParticleEmitter::shower(50.0, 0.5), Vec3::NEG_Y * 2.0),
    ] {
        let (mut app, entity) = emitting(ParticleEmitter {
            gravity: Vec3::ZERO,
            ..emitter
        });
        run(&mut app, 1.0, 20.0);
        let velocities = particles(&app, entity).velocities();
        assert_near(velocities.len() as f32, 50.0, 1.0);
        let mean = velocities.iter().sum::<Vec3>() / velocities.len() as f32;
        assert!(mean.distance(expected) < 0.05 * 7.0, "{mean}");
    }
}

#[test]
fn a_burst_comes_out_at_once_where_the_emitter_is() {
    let (mut app, entity) = emitting(ParticleEmitter::bursts(3.0));
    run(&mut app, 0.5, 30.0);
    assert!(particles(&app, entity).is_empty());
    place(&mut app, entity).translation.y = 5.0;
    emitter(&mut app, entity).burst(40);
    emitter(&mut app, entity).burst(60);
    step(&mut app, 0.0);
    assert!(particles(&app, entity).is_empty(), "no time has passed");
    step(&mut app, 0.02);
    assert_eq!(emitter(&mut app, entity).pending_burst, 0);
    let places = particles(&app, entity).positions();
    assert_eq!(places.len(), 100);
    assert!(places.iter().all(|p| p.distance(Vec3::Y * 5.0) < 0.051));
    step(&mut app, 0.02);
    assert_eq!(particles(&app, entity).len(), 100, "only once");
    // Also from one that is stopped, and between others.
    emitter(&mut app, entity).stop();
    emitter(&mut app, entity).burst(7);
    step(&mut app, 0.02);
    assert_eq!(particles(&app, entity).len(), 107);
}

#[test]
fn stop_and_start() {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 100.0,
        ..EXACT
    });
    run(&mut app, 0.5, 50.0);
    emitter(&mut app, entity).stop();
    run(&mut app, 0.5, 50.0);
    assert_eq!(particles(&app, entity).len(), 50);
    emitter(&mut app, entity).start();
    run(&mut app, 0.5, 50.0);
    assert_eq!(particles(&app, entity).len(), 100);
}
