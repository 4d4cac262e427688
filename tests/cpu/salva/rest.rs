//! Weight, free fall, Archimedes.

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{
    GRAVITY, RADIUS, STEP, WATER, app, block, load, mean, particles, pool, run, spawn_water,
    status, weight_of,
};

#[test]
fn a_column_keeps_its_height_and_rests_its_weight_on_the_tank() {
    let mut app = app();
    let depth = 1.2;
    let (tank, water) = pool(&mut app, vec3(0.8, 2.0, 0.8), depth);
    run(&mut app, 1.5);
    let center = |app: &App| particles(app, water).iter().sum::<Vec3>() / 768.0;
    let (mut centers, mut forces) = (vec![center(&app)], Vec::new());
    let mut square = 0.0;
    for _ in 0..120 {
        let before = particles(&app, water).to_vec();
        app.update();
        let ways = before.iter().zip(particles(&app, water));
        square += ways.map(|(a, b)| a.distance_squared(*b)).sum::<f32>();
        centers.push(center(&app));
        forces.push(load(&app, tank).force);
    }
    let count = particles(&app, water).len();
    assert_eq!(count, 8 * 8 * 12, "none is lost");
    // Volume: the mean height is half the depth. Particles at rest lie up to 0.2 radii nearer to
    // the walls than in a lattice, and to each other by what the solver leaves: of a column of 16
    // radii between four walls 0.2 × 4 / 16 = 5 %. salva's own volumes would be off by 20 %.
    let height = mean(centers.iter().map(|center| center.y));
    assert!((height / (0.5 * depth) - 1.0).abs() < 0.05, "{height}");
    // What the tank feels is the weight, less what the column gains of momentum meanwhile: it
    // breathes. All that a wall takes without feeling it would be missing.
    let force = forces.iter().sum::<Vec3>() / 120.0;
    let weight = weight_of(count);
    let velocity = |i: usize| (centers[i + 1] - centers[i]) / STEP;
    let gain = (velocity(119) - velocity(0)) / (119.0 * STEP) * weight / GRAVITY;
    let error = (force + Vec3::Y * weight + gain).length() / weight;
    assert!(error < 0.01, "{force} of {weight}, {gain}");
    // At rest it creeps, but no faster than this.
    let speed = (square / (120.0 * count as f32)).sqrt() / STEP;
    assert!(speed < 0.15, "{speed}");
}

#[test]
fn a_drop_falls_by_half_g_t_squared() {
    let mut app = app();
    let water = spawn_water(&mut app, block(Vec3::splat(-0.1), Vec3::splat(0.1)));
    run(&mut app, 0.5);
    let fallen = -mean(particles(&app, water).iter().map(|p| p.y));
    let time = status(&app).simulated as f32;
    assert!((time - 0.5).abs() < 1e-4, "lockstep keeps time: {time}");
    // Euler's symplectic step is early by g t dt / 2.
    let exact = 0.5 * GRAVITY * time * time;
    let error = 0.5 * GRAVITY * time * STEP;
    assert!((fallen - exact).abs() < 1.1 * error, "{fallen} of {exact}");
}

/// Sides of the pool for bodies, m.
const POOL: f32 = 1.2;

/// Mean heights of a body's centre and of the water after some time in a pool of depth 0.8.
fn settle_body(shape: impl Into<SalvaShape>, density: f32, from: f32) -> (f32, f32) {
    let mut app = app();
    let (_, water) = pool(&mut app, vec3(POOL, 2.0, POOL), 0.8);
    let body = app.world_mut().spawn((
        SalvaBody::new(shape, density),
        Transform::from_xyz(0.0, from, 0.0),
    ));
    let body = body.id();
    run(&mut app, 2.5);
    let (mut heights, mut water_heights) = (Vec::new(), Vec::new());
    for _ in 0..60 {
        app.update();
        heights.push(app.world().get::<Transform>(body).unwrap().translation.y);
        water_heights.push(mean(particles(&app, water).iter().map(|p| p.y)));
    }
    (mean(heights.into_iter()), mean(water_heights.into_iter()))
}

#[test]
fn a_box_floats_as_deep_as_archimedes_has_it() {
    let side = 0.4;
    for density in [300.0, 600.0] {
        let size = Vec3::splat(side);
        let (height, water) = settle_body(Cuboid::from_size(size), density, 1.1);
        let immersed = side * density / WATER;
        // The level follows from the water's own mean height, which is a little lower than it should be:
        // that of a full pool of the level, less that of the part that the box takes.
        let (area, displaced) = (POOL * POOL, immersed * side * side);
        let sum = displaced + water * area;
        let rest = displaced * (0.5 * immersed + water);
        let level = (sum + (sum * sum - 2.0 * area * rest).sqrt()) / area;
        let expected = level - immersed + 0.5 * side;
        // The water's surface is no sharper than half a particle.
        let error = (height - expected).abs();
        assert!(
            error < 0.5 * RADIUS,
            "{density} kg/m³: {height} for {expected}"
        );
        // And the level, like the column's height, by 5 %: it would be this without loss.
        let full = 0.8 + displaced / area;
        assert!((level / full - 1.0).abs() < 0.05, "{level} for {full}");
    }
}

#[test]
fn what_is_heavier_sinks_to_the_bottom() {
    let radius = 0.2;
    let (height, _) = settle_body(Sphere::new(radius), 3000.0, 1.1);
    assert!((height - radius).abs() < 0.01, "{height}");
}

/// Fastest particle and mean height in the first fifth of a second of a pool, by steps of `step`.
fn wake(step: f32) -> (f32, f32) {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().step = step * 1.001;
    let (_, water) = pool(&mut app, vec3(0.8, 2.0, 0.8), 0.8);
    let (mut fastest, mut highest) = (0.0_f32, 0.0_f32);
    let mut before = particles(&app, water).to_vec();
    for _ in 0..24 {
        app.update();
        let now = particles(&app, water).to_vec();
        let ways = before.iter().zip(&now).map(|(a, b)| a.distance(*b));
        fastest = ways.fold(fastest, |fastest, way| fastest.max(way / STEP));
        highest = highest.max(mean(now.iter().map(|p| p.y)));
        before = now;
    }
    (fastest, highest)
}

#[test]
fn a_filled_tank_does_not_start_with_a_jump() {
    // No particle is faster than one that falls for a tenth of a second, and the whole rises by no more
    // than half a percent. With samples one radius behind walls it would be 1.2 to 8 m/s.
    for step in [STEP, STEP / 4.0, STEP / 8.0] {
        let (fastest, highest) = wake(step);
        assert!(fastest < 1.0, "{fastest} m/s by {step}");
        assert!(highest < 0.402, "{highest} m by {step}");
    }
}
