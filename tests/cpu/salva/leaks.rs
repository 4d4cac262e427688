//! Nothing passes a surface, whatever happens, and what moves in the liquid has been paid for.

use std::f32::consts::PI;

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{
    GRAVITY, STEP, app, block, load, mean, particle_mass, particles, pool, spawn_water,
};

fn is_within(place: Vec3, size: Vec3) -> bool {
    let local = place - Vec3::Y * 0.5 * size.y;
    local.abs().cmple(0.5 * size + 1e-4).all()
}

/// A bowl: the lower half of a sphere, seen from inside.
fn bowl(radius: f32) -> Mesh {
    let ball = Sphere::new(radius).mesh().uv(24, 12);
    let positions = ball.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
    let positions: Vec<Vec3> = positions
        .as_float3()
        .unwrap()
        .iter()
        .map(|&p| p.into())
        .collect();
    let indices: Vec<usize> = ball.indices().unwrap().iter().collect();
    let mut corners = Vec::new();
    for face in indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| positions[face[i]]);
        if a.y + b.y + c.y < 0.0 {
            corners.extend([a, c, b].map(|corner| corner.to_array()));
        }
    }
    Mesh::new(default(), default()).with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
}

#[test]
fn a_mesh_holds_water_and_its_scale_counts() {
    let mut app = app();
    let radius = 0.7;
    // Half as large, scaled by two.
    let mesh = bowl(0.5 * radius);
    let corners = mesh.attribute(Mesh::ATTRIBUTE_POSITION).unwrap();
    let corners: Vec<_> = corners.as_float3().unwrap().to_vec();
    let faces: Vec<_> = corners
        .chunks_exact(3)
        .map(|face| [0, 1, 2].map(|i| 2.0 * Vec3::from(face[i])))
        .map(|[a, b, c]| (a, (b - a).cross(c - a).normalize_or_zero()))
        .collect();
    // The bowl is convex: inside is what is before all faces.
    let depth = |place: Vec3| {
        let depths = faces
            .iter()
            .map(|(corner, normal)| (place - corner).dot(*normal));
        depths.fold(f32::INFINITY, f32::min)
    };
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let scale = Transform::from_scale(Vec3::splat(2.0));
    app.world_mut()
        .spawn((SalvaBoundary::MESH, Mesh3d(mesh), scale));
    // Dropped from above the rim onto the ground of the bowl, at 3 m/s.
    let water = spawn_water(&mut app, block(vec3(-0.3, -0.2, -0.3), vec3(0.3, 0.3, 0.3)));
    app.world_mut()
        .get_mut::<SalvaFluid>(water)
        .unwrap()
        .velocity = Vec3::NEG_Y * 3.0;
    let count = particles(&app, water).len();
    // A splash may go over the rim at y = 0, but nothing through below it.
    let rim = -0.02;
    for i in 0..240 {
        let before = particles(&app, water).to_vec();
        app.update();
        let now = particles(&app, water);
        assert_eq!(now.len(), count);
        for (before, now) in before.iter().zip(now) {
            let is_below = before.y < rim && now.y < rim;
            let leaks = is_below && depth(*before) > 0.0 && depth(*now) < 0.0;
            assert!(!leaks, "{before} to {now} in update {i}");
        }
    }
    let left = particles(&app, water);
    let left = left.iter().filter(|p| p.y < 0.0 && depth(**p) > 0.0);
    let left = left.count();
    assert!(left > count / 2, "{left} of {count}");
}

#[test]
fn a_moved_tank_takes_its_water_along() {
    let mut app = app();
    let size = vec3(0.6, 1.0, 0.6);
    let (tank, water) = pool(&mut app, size, 0.4);
    let speed = 1.0;
    for _ in 0..120 {
        let mut transform = app.world_mut().get_mut::<Transform>(tank).unwrap();
        transform.translation.x += speed * STEP;
        app.update();
    }
    let x = mean(particles(&app, water).iter().map(|p| p.x));
    assert!((x - 1.0).abs() < 0.1, "{x}");
}

/// The tank in update `i`: to and fro by 0.15 m at up to 1.9 m/s, turning all the while.
fn shaken(size: Vec3, i: u32) -> Transform {
    let time = i as f32 * STEP;
    let x = 0.15 * (1.0 - (4.0 * PI * time).cos());
    Transform::from_xyz(x, 0.5 * size.y, 0.0).with_rotation(Quat::from_rotation_y(SPIN * time))
}

/// rad/s
const SPIN: f32 = 2.0;

#[test]
fn a_shaken_tank_does_not_leak_and_gives_all_the_energy_there_is() {
    let mut app = app();
    let size = vec3(0.8, 8.0, 0.8);
    let (tank, water) = pool(&mut app, size, 0.8);
    let count = particles(&app, water).len();
    let mass = particle_mass();
    let mut before = particles(&app, water).to_vec();
    let rest: f32 = before.iter().map(|p| mass * GRAVITY * p.y).sum();
    let (mut work, mut impulse) = (0.0, Vec2::ZERO);
    let mut load_before = Vec3::ZERO;
    for i in 1..=240 {
        let (from, to) = (shaken(size, i - 1), shaken(size, i));
        *app.world_mut().get_mut::<Transform>(tank).unwrap() = to;
        app.update();
        let now = particles(&app, water).to_vec();
        assert_eq!(now.len(), count);
        let to_tank = to.compute_affine().inverse();
        for place in &now {
            let local = to_tank.transform_point3(*place) + Vec3::Y * 0.5 * size.y;
            assert!(is_within(local, size), "{local} in update {i}");
        }
        let load = load(&app, tank);
        let way = to.translation - from.translation;
        work -= load.force.dot(way) + load.torque.y * SPIN * STEP;
        impulse -= load.force.xz() * STEP;
        let velocities = before.iter().zip(&now).map(|(a, b)| (*b - *a) / STEP);
        let energy: f32 = velocities
            .clone()
            .zip(&now)
            .map(|(v, p)| mass * (0.5 * v.length_squared() + GRAVITY * p.y))
            .sum();
        let gain = energy - rest;
        let momentum = mass * velocities.map(Vec3Swizzles::xz).sum::<Vec2>();
        // What the water has, the tank has given; some of it is lost.
        assert!(gain < work, "{gain} J of {work} J in update {i}");
        // Momentum is that of the update's mean velocity, the impulse that at its end, and what the
        // guard stops last is handed over in the next: they differ by no more than two pushes.
        let pushes = (load.force.length() + load_before.length()) * STEP;
        let error = (momentum - impulse).length();
        assert!(error <= pushes, "{momentum} of {impulse} N s in update {i}");
        load_before = load.force;
        before = now;
    }
}
