//! How far a picture of one sample a pixel is from the mean over its pixels.

use glam::{DVec3, UVec2};

use super::{Mask, MetricError, counted, pictures::zip, same_size};
use crate::Image;

/// The mean, over pixels and channels, of absolute differences.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or no pixel.
pub fn mean_difference(a: &Image<DVec3>, b: &Image<DVec3>, mask: Mask) -> Result<f64, MetricError> {
    same_size("mean difference", a, b, mask)?;
    let differences = zip(a, b, |a, b| (a - b).abs().element_sum() / 3.0);
    super::mean("mean difference", &differences, mask)
}

/// The share of pixels of which some channel differs by more than `most`.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or no pixel.
pub fn share_off(
    a: &Image<DVec3>,
    b: &Image<DVec3>,
    most: f64,
    mask: Mask,
) -> Result<f64, MetricError> {
    same_size("share off", a, b, mask)?;
    let off = zip(a, b, |a, b| match (a - b).abs().max_element() {
        difference if difference.is_nan() => f64::NAN,
        difference => f64::from(difference > most),
    });
    super::mean("share off", &off, mask)
}

/// Gradient energy of a picture over that of its truth, between neighbours that both count:
/// below 1 it is blurred, above it has noise or stairs.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or a truth without any gradient.
pub fn sharpness(
    picture: &Image<DVec3>,
    truth: &Image<DVec3>,
    mask: Mask,
) -> Result<f64, MetricError> {
    same_size("sharpness", picture, truth, mask)?;
    let ratio = energy(picture, mask)? / energy(truth, mask)?;
    if ratio.is_finite() {
        Ok(ratio)
    } else {
        Err(MetricError::Empty {
            metric: "sharpness",
        })
    }
}

fn energy(image: &Image<DVec3>, mask: Mask) -> Result<f64, MetricError> {
    let size = image.size();
    let mut sum = 0.0;
    for index in counted(size, mask) {
        let here = UVec2::new(index as u32 % size.x, index as u32 / size.x);
        for next in [here + UVec2::X, here + UVec2::Y] {
            if next.cmplt(size).all() && mask.is_none_or(|mask| *mask.get(next)) {
                sum += (image.get(next) - image.get(here)).length_squared();
            }
        }
        if !sum.is_finite() {
            return Err(MetricError::NotFinite {
                metric: "sharpness",
                index,
            });
        }
    }
    Ok(sum)
}
