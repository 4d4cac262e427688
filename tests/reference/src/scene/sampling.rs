//! Bodies → particles that end where the bodies end.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::{
    random::Random,
    surface::{Cuboid, RippledPool, Sphere},
};

/// How far particles are moved along each axis, in radii. The outermost only move along the
/// surface. Without it, rows of particles would make patterns.
const JITTER: f64 = 0.2;

/// Evenly spaced places, about two radii apart, from one radius above `low` to one below `high`.
/// A body too thin for two gets one place in its middle.
fn places(low: f64, high: f64, radius: f64) -> Vec<f64> {
    let span = high - low - 2.0 * radius;
    let gaps = (span / (2.0 * radius)).round().max(0.0);
    if gaps == 0.0 {
        return vec![0.5 * (low + high)];
    }
    let place = |i| low + radius + span * f64::from(i) / gaps;
    (0..=gaps as u32).map(place).collect()
}

/// Keeps the coordinates of a shift only where a place is not the first or last of its axis.
fn free(index: usize, count: usize) -> f64 {
    if index == 0 || index + 1 == count {
        0.0
    } else {
        1.0
    }
}

/// Particles of `radius` (m) that fill a box: a lattice along its own axes.
///
/// The box should measure some multiple of 2 `radius` along each axis; otherwise the spacing is
/// off by up to a third where it is two particles thick, and by less where it is thicker.
pub fn fill_cuboid(body: &Cuboid, radius: f64, seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let axes = body.half.to_array().map(|half| places(-half, half, radius));
    let [xs, ys, zs] = &axes;
    let world = body.world_from_local();
    let mut out = Vec::with_capacity(xs.len() * ys.len() * zs.len());
    for (i, &x) in xs.iter().enumerate() {
        for (j, &y) in ys.iter().enumerate() {
            for (k, &z) in zs.iter().enumerate() {
                let freedom = DVec3::new(free(i, xs.len()), free(j, ys.len()), free(k, zs.len()));
                let moved = random.point() * freedom * JITTER * radius;
                out.push(world.transform_point3(DVec3::new(x, y, z) + moved));
            }
        }
    }
    out
}

/// Particles of `radius` (m) that fill a ball: shells two radii apart from the outermost inwards,
/// each a Fibonacci lattice with an area of (2 `radius`)² for each particle.
pub fn fill_sphere(body: &Sphere, radius: f64, seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let golden = PI * (3.0 - 5_f64.sqrt());
    let mut out = Vec::new();
    let mut shell = body.radius - radius;
    let outermost = shell;
    while shell > 0.5 * radius {
        let count = (PI * (shell / radius).powi(2)).round().max(1.0) as u32;
        // Another turn for each shell, so that they do not line up.
        let turn = PI * random.signed();
        for i in 0..count {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (golden * f64::from(i) + turn).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            let on_shell = DVec3::new(flat * cos, flat * sin, z) * shell;
            let moved = on_shell + random.point() * JITTER * radius;
            let moved = if shell == outermost {
                moved.normalize() * shell
            } else {
                moved
            };
            out.push(body.center + moved);
        }
        shell -= 2.0 * radius;
    }
    // A ball of one particle, or the room that the innermost shell leaves.
    if shell > -0.5 * radius {
        out.push(body.center);
    }
    out
}

/// Particles of `radius` (m) that fill a pool: upright columns of as many particles each, whose
/// topmost touch the waves from below.
///
/// The waves' radius of curvature must exceed `radius`.
pub fn fill_pool(body: &RippledPool, radius: f64, seed: u64) -> Vec<DVec3> {
    let mut random = Random::new(seed);
    let xs = places(body.min.x, body.max.x, radius);
    let zs = places(body.min.z, body.max.z, radius);
    let count = places(body.min.y, body.max.y, radius).len();
    let bottom = body.min.y + radius;
    let mut out = Vec::with_capacity(xs.len() * zs.len() * count);
    for (i, &x) in xs.iter().enumerate() {
        for (k, &z) in zs.iter().enumerate() {
            let freedom = DVec3::new(free(i, xs.len()), 1.0, free(k, zs.len()));
            for layer in 0..count {
                let moved = random.point() * freedom * JITTER * radius;
                let at = DVec2::new(x + moved.x, z + moved.z);
                let top = below_waves(body, at, radius);
                let part = layer as f64 / (count - 1).max(1) as f64;
                let up = moved.y * free(layer, count);
                let y = bottom + part * (top - bottom) + up;
                out.push(DVec3::new(at.x, y, at.y));
            }
        }
    }
    out
}

/// Height (m) at which a sphere of `radius` (m) at x and z touches the waves from below.
fn below_waves(body: &RippledPool, at: DVec2, radius: f64) -> f64 {
    // Where it touches: there the normal leads to the centre.
    let mut touch = at;
    for _ in 0..50 {
        let n = body.normal(touch);
        touch = at + radius * DVec2::new(n.x, n.z);
    }
    body.height(touch) - radius * body.normal(touch).y
}
