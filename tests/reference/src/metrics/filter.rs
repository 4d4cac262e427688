//! Filters whose weights are a product of a row and a column.

use glam::UVec2;

use crate::Image;

/// Odd number of weights about a middle.
pub(super) type Weights = [f64];

/// Gaussian exp(−x² / (2σ²)) out to `radius`; the sum is 1.
pub(super) fn gaussian(sigma: f64, radius: i32) -> Vec<f64> {
    normalized(weights(radius, |x| (-0.5 * (x / sigma).powi(2)).exp()))
}

pub(super) fn weights(radius: i32, of: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| of(f64::from(x))).collect()
}

/// Positive weights sum up to 1, negative ones to −1.
pub(super) fn normalized(mut weights: Vec<f64>) -> Vec<f64> {
    let sum = |sign: f64| -> f64 { weights.iter().map(|w| (sign * w).max(0.0)).sum() };
    let [above, below] = [sum(1.0), sum(-1.0)];
    for weight in &mut weights {
        *weight /= if *weight > 0.0 {
            above
        } else {
            below.max(f64::MIN_POSITIVE)
        };
    }
    weights
}

/// Filters along rows, then along columns. The border pixels go on beyond the border.
pub(super) fn filter(image: &Image<f64>, row: &Weights, column: &Weights) -> Image<f64> {
    let along = |image: &Image<f64>, weights: &Weights, dx: i64, dy: i64| {
        let radius = (weights.len() / 2) as i64;
        Image::from_fn(image.size(), |pixel: UVec2| {
            let [x, y] = pixel.as_i64vec2().to_array();
            (-radius..=radius)
                .zip(weights)
                .map(|(i, weight)| weight * image.clamped(x + i * dx, y + i * dy))
                .sum()
        })
    };
    along(&along(image, row, 1, 0), column, 0, 1)
}
