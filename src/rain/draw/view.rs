//! A view's rain: how it is drawn at each distance, and its uniform.

use bevy::prelude::*;

use super::{
    extract::ExtractedRain,
    gpu_types::{GpuRain, GpuRainLevel, LEVEL_COUNT, SPEED_VECTORS},
    lattice::{Eye, LEVELS, Level, NEAR, NEAR_REACH, STEEPEST},
};
use crate::rain::{
    densities::density_weights,
    drops::{SMALLEST, count, extinction},
    settings::RainMethod,
};

/// How rain is drawn at each distance.
pub(crate) struct Plan {
    /// Voxels of streaks.
    pub(crate) levels: Option<[Level; LEVEL_COUNT]>,
    /// Individually drawn drops: largest distance from the eye across the fall, and largest
    /// distance overall. Unit: m.
    pub(crate) drops_end: f32,
    pub(crate) drops_reach: f32,
}

impl Plan {
    pub(crate) fn new(method: RainMethod, distance: f32, eye: &Eye) -> Self {
        let (levels, drops_end, drops_reach) = match method {
            RainMethod::PerDrop => (None, f32::INFINITY, distance),
            RainMethod::Streaks if eye.perspective => {
                (Some(LEVELS), NEAR, distance.min(NEAR_REACH))
            }
            RainMethod::Streaks => {
                let mut levels = LEVELS;
                levels[0].start = 0.0;
                (Some(levels), 0.0, 0.0)
            }
        };
        Self {
            levels,
            drops_end,
            drops_reach,
        }
    }

    /// Whether some rays are so close to the fall that drops and streaks leave part of them
    /// uncovered.
    pub(crate) fn leaves_some(&self, steepest: f32) -> bool {
        let near = if self.drops_reach > 0.0 {
            self.drops_end / self.drops_reach
        } else {
            0.0
        };
        self.levels.is_some() && steepest < near.max(STEEPEST)
    }
}

impl GpuRain {
    /// Without lights and shelters.
    pub(crate) fn new(
        extracted: &ExtractedRain,
        plan: &Plan,
        view: &GlobalTransform,
        eye: &Eye,
        axis: Vec3,
    ) -> Self {
        let ExtractedRain {
            rain,
            clock,
            streaks,
            ..
        } = extracted;
        let scale = view.affine().matrix3;
        let rate = f64::from(rain.rate);
        let mut gpu = Self {
            axis,
            distance: rain.distance,
            forward: eye.forward,
            perspective: u32::from(eye.perspective),
            ambient: extracted.ambient,
            extinction: extinction(rate) as f32,
            extent: rain.extent,
            brightness: rain.brightness,
            fallen_tiles: clock.fallen.floor() as i64 as i32,
            fallen: (clock.fallen - clock.fallen.floor()) as f32,
            seed: (streaks.input.seed ^ (streaks.input.seed >> 32)) as u32,
            drops_end: plan.drops_end.min(1e9),
            drops_reach: plan.drops_reach,
            drops: count(rate, SMALLEST, f64::INFINITY) as f32,
            exposure: streaks.input.exposure,
            seconds: clock.seconds as f32,
            wind: rain.wind,
            drift: clock.drift.as_vec2(),
            mean_speed: streaks.speed as f32,
            view_scale: vec2(scale.y_axis.length(), scale.z_axis.length()),
            speeds: core::array::from_fn(|i| {
                Vec4::from_array(core::array::from_fn(|k| {
                    streaks.input.law.speed(0.1 * (4 * i + k) as f64) as f32
                }))
            }),
            ..default()
        };
        for (gpu, level) in gpu.levels.iter_mut().zip(plan.levels.unwrap_or_default()) {
            let wanted = extinction(rate) * f64::from(level.size);
            *gpu = GpuRainLevel {
                weights: density_weights(wanted, streaks.extinction) * streaks.scale,
                size: level.size,
                inverse_size: level.size.recip(),
                start: level.start,
                end: level.end,
            };
        }
        gpu
    }

    /// The longest streak. Unit: m.
    pub(crate) fn longest(&self) -> f32 {
        let fastest = self
            .speeds
            .iter()
            .fold(0.0, |most: f32, v| most.max(v.max_element()));
        self.wind.length().hypot(fastest) * self.exposure
    }
}

const _: () = assert!(LEVEL_COUNT == LEVELS.len() && SPEED_VECTORS * 4 >= 61);
