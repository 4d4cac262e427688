//! Particles at rest.

use std::f32::consts::PI;

use bevy::math::{Vec2, Vec3, vec3};

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
