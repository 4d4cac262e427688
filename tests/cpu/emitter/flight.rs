//! Free flight against closed forms.

use super::*;

/// x and v after some time under v' = g − k v, in f64, as textbooks have it.
fn with_drag(speed: f64, drag: f64, time: f64) -> (f64, f64) {
    let (g, fading) = (f64::from(G), (-drag * time).exp());
    let terminal = g / drag;
    let height = (speed + terminal) * (1.0 - fading) / drag - terminal * time;
    (height, (speed + terminal) * fading - terminal)
}

#[test]
fn a_jet_rises_to_v2_over_2g() {
    for frames in [17.0, 60.0, 240.0] {
        for speed in [1.0, 4.0, 12.0] {
            let (mut app, entity) = emitting(one(speed, Vec3::Y));
            // A burst is born at the end of its step.
            step(&mut app, 0.01);
            let mut highest = 0.0_f32;
            for _ in 0..(2.0 * speed / G * frames) as u32 {
                step(&mut app, 1.0 / frames);
                highest = highest.max(single(&app, entity).0.y);
            }
            let expected = speed * speed / (2.0 * G);
            // At most half a step from the top.
            assert_near(
                highest,
                expected,
                0.5 * G * (0.5 / frames).powi(2) + 1e-5 * expected,
            );
        }
    }
}

#[test]
fn drag_follows_its_closed_form_in_steps_of_any_length() {
    for drag in [1e-7, 1e-4, 0.02, 1.0, 30.0, 1000.0] {
        for frames in [4.0, 30.0, 1000.0] {
            let (mut app, entity) = emitting(ParticleEmitter {
                drag,
                ..one(6.0, Vec3::Y)
            });
            step(&mut app, 0.01);
            run(&mut app, 1.5, frames);
            let (place, velocity) = single(&app, entity);
            let (height, speed) = if drag < 1e-6 {
                let (g, v) = (f64::from(G), 6.0);
                (v * 1.5 - 0.5 * g * 2.25, v - g * 1.5)
            } else {
                with_drag(6.0, f64::from(drag), 1.5)
            };
            assert_near(place.y, height as f32, 1e-4 * (1.0 + height.abs() as f32));
            assert_near(velocity.y, speed as f32, 1e-4 * (1.0 + speed.abs() as f32));
        }
    }
}

#[test]
fn gravity_is_the_worlds_however_the_emitter_stands() {
    let (mut app, entity) = emitting(ParticleEmitter {
        gravity: vec3(1.0, -2.0, 3.0),
        ..one(4.0, Vec3::Y)
    });
    *place(&mut app, entity) = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::splat(0.1));
    step(&mut app, 0.01);
    run(&mut app, 2.0, 32.0);
    // 4 m/s along +x, where its y points.
    let expected = vec3(1.0, 2.0, 3.0) + vec3(8.0, 0.0, 0.0) + 2.0 * vec3(1.0, -2.0, 3.0);
    assert!(single(&app, entity).0.distance(expected) < 1e-4);
    assert!(drawn(&app, entity)[0].distance(expected) < 1e-4);
}
