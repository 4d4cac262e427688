//! Depths, normals, directions, outlines, and light kept.

use glam::DVec3;

use super::{Mask, MetricError, Quantiles, counted, same_size};
use crate::{Image, angle};

/// How far depths are off. Lengths in particle radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthError {
    /// Mean of measured − true: positive where the measured surface is farther away.
    pub offset: f64,
    /// Root of the mean squared error.
    pub rmse: f64,
    /// What is left of it without the offset.
    pub roughness: f64,
    /// The absolute errors.
    pub absolute: Quantiles,
}

/// Compares view depths (m) where both images have one, in radii of `radius` m.
///
/// # Errors
/// Sizes that differ, a depth that is not finite, or no pixel with both.
pub fn depth_error(
    measured: &Image<Option<f64>>,
    truth: &Image<Option<f64>>,
    mask: Mask,
    radius: f64,
) -> Result<DepthError, MetricError> {
    let metric = "depth error";
    let off = both(metric, measured, truth, mask)?
        .map(|(_, measured, truth)| (measured - truth) / radius)
        .collect::<Vec<_>>();
    let absolute = Quantiles::of(metric, off.iter().map(|error| error.abs()))?;
    let mean = |sum: f64| sum / off.len() as f64;
    let offset = mean(off.iter().sum());
    Ok(DepthError {
        offset,
        rmse: mean(off.iter().map(|e| e * e).sum()).sqrt(),
        roughness: mean(off.iter().map(|e| (e - offset).powi(2)).sum()).sqrt(),
        absolute,
    })
}

/// Degrees between normals where both images have one.
///
/// # Errors
/// Sizes that differ, a normal that is not finite or has no length, or no pixel with both.
pub fn normal_error(
    measured: &Image<Option<DVec3>>,
    truth: &Image<Option<DVec3>>,
    mask: Mask,
) -> Result<Quantiles, MetricError> {
    let metric = "normal error";
    let pairs = both(metric, measured, truth, mask)?;
    direction_error(metric, pairs.map(|(_, measured, truth)| [measured, truth]))
}

/// Degrees between the directions of each pair; of exit rays, for example.
///
/// # Errors
/// A direction that is not finite or has no length, or no pair.
pub fn direction_error(
    metric: &'static str,
    pairs: impl IntoIterator<Item = [DVec3; 2]>,
) -> Result<Quantiles, MetricError> {
    let usable = |v: DVec3| v.is_finite() && v != DVec3::ZERO;
    let degrees = |[a, b]: [DVec3; 2]| {
        if usable(a) && usable(b) {
            angle(a, b)
        } else {
            f64::NAN
        }
    };
    Quantiles::of(metric, pairs.into_iter().map(degrees))
}

/// Pixels that both have, over those that any has; 1 where none has any.
///
/// # Errors
/// Sizes that differ.
pub fn silhouette_iou(a: &Image<bool>, b: &Image<bool>) -> Result<f64, MetricError> {
    same_size("silhouette", a, b, None)?;
    let pairs = || a.pixels().iter().zip(b.pixels());
    let both = pairs().filter(|(a, b)| **a && **b).count();
    let any = pairs().filter(|(a, b)| **a || **b).count();
    Ok(if any == 0 {
        1.0
    } else {
        both as f64 / any as f64
    })
}

/// Light made or lost in surroundings of radiance 1: |R + T − 1|, the worst channel of each pixel.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or no pixel.
pub fn furnace_error(
    radiance: &Image<DVec3>,
    transmission: &Image<DVec3>,
    mask: Mask,
) -> Result<Quantiles, MetricError> {
    let metric = "furnace";
    same_size(metric, radiance, transmission, mask)?;
    let error = |i: usize| {
        let off = (radiance.pixels()[i] + transmission.pixels()[i] - 1.0).abs();
        // `max_element` may hide one that is not a number.
        if off.is_finite() {
            off.max_element()
        } else {
            f64::NAN
        }
    };
    Quantiles::of(metric, counted(radiance.size(), mask).map(error))
}

/// Pixels that count and have a value in both images.
fn both<'a, T: Copy>(
    metric: &'static str,
    measured: &'a Image<Option<T>>,
    truth: &'a Image<Option<T>>,
    mask: Mask<'a>,
) -> Result<impl Iterator<Item = (usize, T, T)> + use<'a, T>, MetricError> {
    same_size(metric, measured, truth, mask)?;
    Ok(counted(measured.size(), mask)
        .filter_map(|i| Some((i, measured.pixels()[i]?, truth.pixels()[i]?))))
}
