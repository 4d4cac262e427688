//! Particles at rest.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec2, Vec3, ivec3, vec3};

/// Turns from one particle of a shell to the next (rad): neighbours are never in a row.
const GOLDEN_ANGLE: f32 = 2.399_963;

/// A ball of radius `size` around the origin, filled by shells of evenly spread particles of
/// `radius`, two radii apart (m).
pub fn ball(size: f32, radius: f32) -> Vec<Vec3> {
    let shells = (size / (2.0 * radius)) as usize;
    (1..=shells)
        .flat_map(|shell| {
            let steps = shell as f32 - 0.5;
            let count = (4.0 * PI * steps * steps).ceil() as usize;
            (0..count).map(move |i| {
                let height = 1.0 - (2 * i + 1) as f32 / count as f32;
                let around = Vec2::from_angle(GOLDEN_ANGLE * i as f32);
                let around = around * (1.0 - height * height).sqrt();
                vec3(around.x, height, around.y) * 2.0 * radius * steps
            })
        })
        .collect()
}

/// A block of liquid at the left wall of a tank, as deep as the tank: `dam` wide and high.
pub fn dam(tank: Vec3, dam: Vec2, radius: f32) -> Vec<Vec3> {
    let low = vec3(-0.5 * tank.x, 0.0, -0.5 * tank.z);
    let high = low + vec3(dam.x, dam.y, tank.z);
    lattice(low + radius, high - radius, 2.0 * radius)
}

/// Points from `low` to `high`, both included where they are a multiple of `spacing` apart.
pub fn lattice(low: Vec3, high: Vec3, spacing: f32) -> Vec<Vec3> {
    let steps = ((high - low) / spacing + 1e-3).floor().as_ivec3();
    let mut points = Vec::new();
    for x in 0..=steps.x {
        for y in 0..=steps.y {
            for z in 0..=steps.z {
                points.push(low + ivec3(x, y, z).as_vec3() * spacing);
            }
        }
    }
    points
}

/// The mantle of an upright cylinder (foot, radius), in particles of `radius`.
pub fn cylinder((foot, size): (Vec2, f32), height: f32, radius: f32) -> Vec<Vec3> {
    let around = (TAU * size / (2.0 * radius)).ceil() as u32;
    let up = (height / (2.0 * radius)).ceil() as u32;
    let mut points = Vec::new();
    for i in 0..around {
        let angle = TAU * i as f32 / around as f32;
        let side = foot + (size - radius) * Vec2::from_angle(angle);
        points.extend((0..up).map(|j| vec3(side.x, (2 * j + 1) as f32 * radius, side.y)));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_filled_and_nothing_sticks_out() {
        let particles = ball(0.5, 0.02);
        assert!(particles.iter().all(|place| place.length() <= 0.5));
        let filled = particles.len() as f32 * 0.04_f32.powi(3) / (4.0 / 3.0 * PI * 0.5_f32.powi(3));
        assert!((0.85..1.1).contains(&filled), "{filled}");
    }
}
