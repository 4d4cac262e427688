//! Textures of the streaks that the drops in a cubic metre of air leave during an exposure.
//!
//! Streaks are seen from the side in parallel projection. There is one layer per variant; its four
//! channels are four densities of drops, each of which includes the drops of the one before it.
//! Layers tile: a streak that leaves one on one side enters on the other, and streaks across a
//! border are the same in all variants, so that any two may be adjacent on any side.
//!
//! A drop of diameter D and speed v covers a point on its path for an average time of D/v, times
//! π/4 for its roundness, out of an exposure T. Its streak has an opacity of π/4 · D/(vT) over a
//! width of D and a length of vT: an area of π/4 · D², the drop's cross section, at any exposure.
//! It is spread over the texels exactly.

use core::{
    array,
    f64::consts::{FRAC_PI_4, PI},
};
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::{
    births::diameter_of_birth,
    densities::{BAKED_RATES, DENSITIES},
    drops::{DragLaw, LARGEST, SMALLEST, count},
};
use crate::random::Random;

/// Layers of the array texture. Each has its own drops, so that repetition does not show.
pub const VARIANTS: usize = 8;
/// Texels along a metre across the fall. A power of two.
pub const WIDTH: usize = 512;
/// Texels along a metre of fall. A power of two. With fewer, mip levels for square pixels would
/// blur streaks along the fall, and pixels would vary too little.
pub const HEIGHT: usize = 512;
/// Longest exposure: with a longer one, streaks would leave their cube. Unit: s.
pub const LONGEST_EXPOSURE: f32 = 0.1;
/// Shortest exposure. Unit: s.
pub const SHORTEST_EXPOSURE: f32 = 1e-4;
/// Exposure before the frame time is known. Unit: s.
pub(crate) const DEFAULT_EXPOSURE: f32 = 1.0 / 60.0;

/// Everything that the appearance of streaks depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreakInput {
    /// Exposure time. Unit: s.
    pub exposure: f32,
    /// How fast drops fall.
    pub law: DragLaw,
    /// Random seed: different seeds give different drops.
    pub seed: u64,
}

/// The textures and the values needed to read them.
#[derive(Clone, Debug)]
pub struct Streaks {
    /// Unorm texels of four channels: layer by layer, each with all its mip levels, rows from the
    /// top.
    pub texels: Vec<u8>,
    /// The opacity of a texel of 1.
    pub scale: f32,
    /// Mean opacity of each density: the cross sections of its drops per m³. Unit: 1/m.
    pub extinction: [f64; DENSITIES],
}

/// Number of mip levels of a layer.
pub const MIP_LEVELS: u32 = WIDTH.ilog2() + 1;

/// The size of a mip level.
pub const fn mip_size(level: u32) -> (usize, usize) {
    let (width, height) = (WIDTH >> level, HEIGHT >> level);
    (
        if width == 0 { 1 } else { width },
        if height == 0 { 1 } else { height },
    )
}

/// Opacity of the four densities.
type Texel = [f32; DENSITIES];

/// A drop on its way through the cube.
#[derive(Clone, Copy, Debug)]
struct Streak {
    /// Across the fall. Unit: m, 0..1.
    x: f64,
    /// Height of the drop when the shutter closes. Unit: m, 0..1.
    y: f64,
    /// m.
    length: f64,
    /// m.
    radius: f64,
    /// The first density that has it.
    density: usize,
}

impl Streak {
    fn crosses_a_border(&self) -> bool {
        // A texel beside the border is blended with the one across it.
        let reach = self.radius + 1.0 / WIDTH as f64;
        self.y + self.length > 1.0 || self.x < reach || self.x > 1.0 - reach
    }
}

/// The valid exposure time nearest to `seconds`.
fn clamped_exposure(seconds: f32) -> f32 {
    if seconds.is_nan() {
        DEFAULT_EXPOSURE
    } else {
        seconds.clamp(SHORTEST_EXPOSURE, LONGEST_EXPOSURE)
    }
}

/// Number of steps that [`bake`] counts.
pub const STEPS: u32 = 2 * VARIANTS as u32;

/// Draws all textures in parallel; `done` counts up to [`STEPS`]. An invalid exposure is clamped.
pub fn bake(input: &StreakInput, done: &AtomicU32) -> Streaks {
    let variants = sample_streaks(input);
    let mut extinction = [0.0; DENSITIES];
    for streak in variants.iter().flatten() {
        for sum in &mut extinction[streak.density..] {
            *sum += PI * streak.radius.powi(2) / VARIANTS as f64;
        }
    }
    let layers: Vec<Vec<Texel>> = variants
        .par_iter()
        .map(|streaks| {
            let layer = draw(streaks);
            done.fetch_add(1, Ordering::Relaxed);
            layer
        })
        .collect();
    // Denser rain than the densest is rare: the range is that of the values present.
    let scale = layers
        .iter()
        .flatten()
        .flatten()
        .copied()
        .fold(0.0, f32::max);
    let texels: Vec<Vec<u8>> = layers
        .into_par_iter()
        .map(|layer| {
            let texels = with_mips(layer, scale);
            done.fetch_add(1, Ordering::Relaxed);
            texels
        })
        .collect();
    Streaks {
        texels: texels.concat(),
        scale,
        extinction,
    }
}

/// The drops of each variant: a random number in each, with the average number in all of them
/// together.
fn sample_streaks(input: &StreakInput) -> [Vec<Streak>; VARIANTS] {
    let exposure = f64::from(clamped_exposure(input.exposure));
    let mut random = Random::new(input.seed);
    let mut variants: [Vec<Streak>; VARIANTS] = Default::default();
    let mut before = 0.0;
    for (density, rate) in BAKED_RATES.into_iter().enumerate() {
        let count = count(rate, SMALLEST, f64::INFINITY);
        for _ in 0..random.round((count - before) * VARIANTS as f64) {
            let there = before + (count - before) * random.next_f64();
            let diameter = diameter_of_birth(there, array::from_fn(|_| random.next_f64()));
            // Larger ones break up.
            let diameter = diameter.min(LARGEST);
            let streak = Streak {
                x: random.next_f64(),
                y: random.next_f64(),
                length: input.law.speed(diameter) * exposure,
                radius: 0.5e-3 * diameter,
                density,
            };
            // Across a border all variants are alike: one decides for all.
            match (random.below(VARIANTS), streak.crosses_a_border()) {
                (variant, false) => variants[variant].push(streak),
                (0, true) => variants.iter_mut().for_each(|streaks| streaks.push(streak)),
                (_, true) => {}
            }
        }
        before = count;
    }
    variants
}

fn draw(streaks: &[Streak]) -> Vec<Texel> {
    let mut layer = vec![Texel::default(); WIDTH * HEIGHT];
    let (width, height) = (WIDTH as f64, HEIGHT as f64);
    for streak in streaks {
        let area = FRAC_PI_4 * (2.0 * streak.radius).powi(2) * width * height;
        let (left, right) = (streak.x - streak.radius, streak.x + streak.radius);
        let (bottom, top) = (streak.y * height, (streak.y + streak.length) * height);
        for column in (left * width).floor() as i64..=(right * width).floor() as i64 {
            let part = |x: f64| disc_left_of((x / width - streak.x) / streak.radius);
            let across = part(column as f64 + 1.0) - part(column as f64);
            for row in bottom.floor() as i64..=top.floor() as i64 {
                let inside = top.min(row as f64 + 1.0) - bottom.max(row as f64);
                let along = inside.max(0.0) / (top - bottom);
                // Rows of a texture run downwards.
                let row = HEIGHT - 1 - row.rem_euclid(HEIGHT as i64) as usize;
                let column = column.rem_euclid(WIDTH as i64) as usize;
                let opacity = (area * across * along) as f32;
                for density in &mut layer[row * WIDTH + column][streak.density..] {
                    *density += opacity;
                }
            }
        }
    }
    layer
}

/// The part of a unit disc that lies left of `x`.
fn disc_left_of(x: f64) -> f64 {
    let x = x.clamp(-1.0, 1.0);
    0.5 + (x * (1.0 - x * x).sqrt() + x.asin()) / PI
}

/// All mip levels in 8 bits, each the mean of the one before.
fn with_mips(mut layer: Vec<Texel>, scale: f32) -> Vec<u8> {
    let mut texels = Vec::new();
    for level in 0..MIP_LEVELS {
        if level > 0 {
            layer = halved(&layer, mip_size(level - 1));
        }
        quantise(&layer, scale, &mut texels);
    }
    texels
}

fn halved(layer: &[Texel], (width, height): (usize, usize)) -> Vec<Texel> {
    let (half_width, half_height) = ((width / 2).max(1), (height / 2).max(1));
    let (step_x, step_y) = (width / half_width, height / half_height);
    let mut out = Vec::with_capacity(half_width * half_height);
    for y in 0..half_height {
        for x in 0..half_width {
            let mut sum = Texel::default();
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let from = (y * step_y + dy % step_y) * width + x * step_x + dx % step_x;
                for (sum, value) in sum.iter_mut().zip(layer[from]) {
                    *sum += 0.25 * value;
                }
            }
            out.push(sum);
        }
    }
    out
}

/// Quantises to 8 bits; the rounding error of one texel is added to the next, so that the mean is
/// kept.
fn quantise(layer: &[Texel], scale: f32, out: &mut Vec<u8>) {
    let factor = if scale > 0.0 { 255.0 / scale } else { 0.0 };
    let mut left = Texel::default();
    for texel in layer {
        for (value, left) in texel.iter().zip(&mut left) {
            let exact = value * factor + *left;
            let rounded = exact.round().clamp(0.0, 255.0);
            *left = exact - rounded;
            out.push(rounded as u8);
        }
    }
}

#[cfg(test)]
mod tests;
