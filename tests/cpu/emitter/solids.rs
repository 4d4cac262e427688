//! Nothing enters a solid, whatever its speed.

use bevy::math::{DQuat, DVec2, DVec3};
use proptest::prelude::*;

use super::*;

const RADIUS: f32 = 0.05;

/// The distance of a point from a collider's surface, in f64, by formulas of its own.
fn distance(collider: &ParticleCollider, transform: &Transform, point: Vec3) -> f64 {
    use bevy_fluid::solid::SolidShape::*;
    let turn = DQuat::from_array(transform.rotation.to_array().map(f64::from)).normalize();
    let local = turn.inverse() * (point - transform.translation).as_dvec3();
    let scale = transform.scale.as_dvec3().abs();
    match collider.shape {
        Ground => local.y,
        Sphere { radius } => local.length() - f64::from(radius) * scale.max_element(),
        Cuboid { half_size } => {
            let half_size = half_size.as_dvec3() * scale;
            let nearest = local.clamp(-half_size, half_size);
            let outside = (local - nearest).length();
            let inside = (half_size - local.abs()).min_element();
            if outside > 0.0 { outside } else { -inside }
        }
        Cylinder {
            radius,
            half_height,
        } => {
            let radius = f64::from(radius) * scale.x.max(scale.z);
            let beyond = DVec2::new(
                local.with_y(0.0).length() - radius,
                local.y.abs() - f64::from(half_height) * scale.y,
            );
            beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
        }
        Capsule {
            radius,
            half_length,
        } => {
            let end = DVec3::Y * f64::from(half_length) * scale.y;
            // The nearest point of the segment from −end to end.
            let t = ((local + end).dot(2.0 * end) / (2.0 * end).length_squared().max(1e-30))
                .clamp(0.0, 1.0);
            let radius = f64::from(radius) * scale.x.max(scale.z);
            (local + end - 2.0 * end * t).length() - radius
        }
    }
}

fn shapes() -> impl Strategy<Value = ParticleCollider> {
    let size = || 0.0_f32..1.5;
    prop_oneof![
        Just(ParticleCollider::ground()),
        size().prop_map(|radius| Sphere::new(radius).into()),
        (size(), size(), 1e-3_f32..1.0).prop_map(|(x, y, z)| Cuboid::new(x, y, z).into()),
        (size(), size()).prop_map(|(radius, length)| Capsule3d::new(radius, length).into()),
        (size(), size()).prop_map(|(radius, height)| Cylinder::new(radius, height).into()),
    ]
}

fn rotations() -> impl Strategy<Value = Quat> {
    prop::array::uniform4(-1.0_f32..1.0).prop_map(|q| {
        let q = Quat::from_array(q);
        if q.length() > 0.1 {
            q.normalize()
        } else {
            Quat::IDENTITY
        }
    })
}

fn vectors(size: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size).prop_map(Vec3::from)
}

#[derive(Clone, Debug)]
struct Case {
    collider: ParticleCollider,
    transform: Transform,
    /// Of the collider. m/s and rad/s.
    moves: Option<(Vec3, Vec3)>,
    emitter: Vec3,
    settings: ParticleEmitter,
    steps: Vec<f32>,
}

fn cases() -> impl Strategy<Value = Case> {
    let collider = (
        shapes(),
        0.0_f32..=1.0,
        0.0_f32..2.0,
        vectors(2.0),
        rotations(),
        prop_oneof![
            Just(Vec3::ONE),
            vectors(2.0).prop_map(|scale| scale.abs() + 0.1)
        ],
        prop::option::of((vectors(5.0), vectors(8.0))),
    );
    let emitter = (
        vectors(4.0),
        prop_oneof![Just(0.0_f32), 0.0_f32..10.0, 10.0_f32..300.0],
        vectors(1.0),
        prop_oneof![Just(Vec3::NEG_Y * G), vectors(60.0)],
        prop_oneof![Just(0.0_f32), 0.0_f32..5.0],
        any::<u64>(),
    );
    let steps = prop::collection::vec(1e-4_f32..0.1, 1..25);
    (collider, emitter, steps).prop_map(|(collider, emitter, steps)| {
        let (shape, restitution, friction, translation, rotation, scale, moves) = collider;
        let (place, speed, towards, gravity, drag, seed) = emitter;
        Case {
            collider: ParticleCollider {
                restitution,
                friction,
                ..shape
            },
            transform: Transform {
                translation,
                rotation,
                scale,
            },
            moves,
            emitter: place,
            settings: ParticleEmitter {
                // At the collider, more or less.
                direction: translation - place + towards,
                rate: 300.0,
                speed,
                cone_half_angle: 0.2,
                gravity,
                drag,
                seed,
                particle_radius: RADIUS,
                ..EXACT
            },
            steps,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn nothing_enters_a_solid(case in cases()) {
        let mut app = app();
        let mut transform = case.transform;
        let solid = app.world_mut().spawn((case.collider, transform)).id();
        let at = Transform::from_translation(case.emitter);
        let entity = app.world_mut().spawn((case.settings, at)).id();
        for seconds in case.steps {
            if let Some((velocity, spin)) = case.moves {
                transform.translation += velocity * seconds;
                transform.rotate(Quat::from_scaled_axis(spin * seconds));
                *place(&mut app, solid) = transform;
            }
            step(&mut app, seconds);
            for &particle in particles(&app, entity).positions() {
                prop_assert!(particle.is_finite());
                let distance = distance(&case.collider, &transform, particle);
                // What rotations in f32 are worth there.
                let lever = particle.length() + particle.distance(transform.translation);
                let slack = 1e-5 + 2e-6 * f64::from(lever);
                prop_assert!(
                    distance >= f64::from(RADIUS) - slack,
                    "{} m deep at {particle}", f64::from(RADIUS) - distance
                );
            }
        }
    }
}

/// A shot at something thin, from x = −3 to whatever stands at the origin.
fn shoot(colliders: &[(ParticleCollider, Transform)], seconds: f32) -> (App, Entity) {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 2000.0,
        speed: 300.0,
        cone_half_angle: 0.05,
        direction: Vec3::X,
        particle_radius: 0.005,
        ..EXACT
    });
    place(&mut app, entity).translation.x = -3.0;
    for collider in colliders {
        app.world_mut().spawn(*collider);
    }
    for _ in 0..20 {
        step(&mut app, seconds);
    }
    (app, entity)
}

#[test]
fn nothing_tunnels_through_a_thin_wall() {
    let wall = Cuboid::new(0.001, 100.0, 100.0).into();
    let disc = (
        Sphere::new(1.0).into(),
        Transform::from_scale(Vec3::splat(0.5)),
    );
    for seconds in [0.1, 0.02, 0.001] {
        let (app, entity) = shoot(&[(wall, Transform::default()), disc], seconds);
        let particles = particles(&app, entity).positions();
        assert_near(particles.len() as f32, 2000.0 * 20.0 * seconds, 1.0);
        assert!(particles.iter().all(|p| p.x < 0.0));
    }
}

#[test]
fn what_is_put_over_particles_pushes_them_out() {
    let (mut app, entity) = emitting(ParticleEmitter {
        nozzle_radius: 1.0,
        speed: 0.0,
        rate: 0.0,
        gravity: Vec3::ZERO,
        pending_burst: 1000,
        particle_radius: RADIUS,
        ..EXACT
    });
    step(&mut app, 0.01);
    let ball: ParticleCollider = Sphere::new(0.5).into();
    let transform = Transform::default();
    app.world_mut().spawn((ball, transform));
    step(&mut app, 0.01);
    for &particle in particles(&app, entity).positions() {
        assert!(distance(&ball, &transform, particle) >= f64::from(RADIUS) - 1e-5);
    }
}
