//! What liquid and bodies give each other.

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{STEP, app, block, particle_mass, particles, spawn_water};

/// Momentum (kg m/s) and energy (J) of a block of water that hits a free body at `speed` (m/s), at
/// first and in the end; and the body's last velocity.
fn hit(density: f32, speed: f32) -> ([Vec3; 2], [f32; 2], Vec3) {
    let mut app = app();
    let mut settings = app.world_mut().resource_mut::<SalvaSettings>();
    settings.gravity = Vec3::ZERO;
    // As many as the fastest asks for: beyond, steps are too long to be stable.
    settings.max_substeps = 16;
    let side = 0.3;
    let size = Vec3::splat(side);
    let body = SalvaBody::new(Cuboid::from_size(size), density);
    let body = app.world_mut().spawn((body, Transform::default())).id();
    // Somewhat aside, so that the body turns too.
    let water = block(vec3(-0.7, -0.1, -0.2), vec3(-0.3, 0.3, 0.2));
    let water = spawn_water(&mut app, water);
    let velocity = Vec3::X * speed;
    app.world_mut()
        .get_mut::<SalvaFluid>(water)
        .unwrap()
        .velocity = velocity;
    let count = particles(&app, water).len();
    let mass = particle_mass();
    let body_mass = density * side.powi(3);
    let at = |app: &App| app.world().get::<Transform>(body).unwrap().translation;
    let (mut before, mut body_before) = (particles(&app, water).to_vec(), at(&app));
    let all = mass * count as f32;
    let first = (all * velocity, 0.5 * all * speed * speed);
    let mut last = (Vec3::ZERO, 0.0, Vec3::ZERO);
    for _ in 0..60 {
        app.update();
        let now = particles(&app, water).to_vec();
        let velocities = before.iter().zip(&now).map(|(a, b)| (*b - *a) / STEP);
        let body_velocity = (at(&app) - body_before) / STEP;
        let momentum = mass * velocities.clone().sum::<Vec3>() + body_mass * body_velocity;
        let energy = 0.5 * mass * velocities.map(Vec3::length_squared).sum::<f32>();
        let body_energy = 0.5 * body_mass * body_velocity.length_squared();
        last = (momentum, energy + body_energy, body_velocity);
        (before, body_before) = (now, at(&app));
    }
    assert_eq!(particles(&app, water).len(), count);
    ([first.0, last.0], [first.1, last.1], last.2)
}

#[test]
fn momentum_is_handed_over_whole_and_energy_never_grows() {
    // Also a body much lighter than what hits it, and one that is hit as fast as is stable.
    for (density, speed) in [(1000.0, 1.0), (500.0, 5.0), (20.0, 5.0), (500.0, 20.0)] {
        let ([first, last], [before, after], body) = hit(density, speed);
        let error = (last - first).length() / first.length();
        assert!(
            error < 1e-4,
            "{density} kg/m³, {speed} m/s: {first} became {last}"
        );
        assert!(
            after < before,
            "{density} kg/m³, {speed} m/s: {before} J became {after} J"
        );
        assert!(body.x > 0.1 * speed && body.x < 2.0 * speed, "{body}");
    }
}
