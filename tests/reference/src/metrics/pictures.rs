//! PSNR and SSIM.

use glam::DVec3;

use super::{
    Mask, MetricError, counted,
    filter::{filter, gaussian},
    same_size,
};
use crate::Image;

/// Encodes linear values as a screen takes them (IEC 61966-2-1), cut to 0..=1.
pub fn encode_srgb(linear: DVec3) -> DVec3 {
    linear.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.003_130_8 {
            12.92 * c
        } else {
            1.055 * c.powf(1.0 / 2.4) - 0.055
        }
    })
}

/// The inverse of [`encode_srgb`].
pub fn decode_srgb(encoded: DVec3) -> DVec3 {
    encoded.map(|c| {
        if c <= 0.040_45 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// Mean of a map over the pixels that count.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or no pixel.
pub fn mean(metric: &'static str, map: &Image<f64>, mask: Mask) -> Result<f64, MetricError> {
    same_size(metric, map, map, mask)?;
    let (mut sum, mut count) = (0.0, 0);
    for index in counted(map.size(), mask) {
        let value = map.pixels()[index];
        if !value.is_finite() {
            return Err(MetricError::NotFinite { metric, index });
        }
        sum += value;
        count += 1;
    }
    if count == 0 {
        return Err(MetricError::Empty { metric });
    }
    Ok(sum / f64::from(count))
}

/// Peak signal-to-noise ratio of values whose peak is 1, in dB; infinite for equal pictures.
///
/// # Errors
/// Sizes that differ, a value that is not finite, or no pixel.
pub fn psnr(a: &Image<DVec3>, b: &Image<DVec3>, mask: Mask) -> Result<f64, MetricError> {
    same_size("PSNR", a, b, mask)?;
    let squared = zip(a, b, |a, b| (a - b).length_squared() / 3.0);
    Ok(-10.0 * mean("PSNR", &squared, mask)?.log10())
}

/// Structural similarity of the luma of two sRGB-encoded pictures (Wang et al. 2004): a Gaussian
/// window of 11 × 11 with σ = 1.5, K₁ = 0.01, K₂ = 0.03, a peak of 1. 1 for equal pictures.
///
/// A map, to be averaged with [`mean`]. The paper counts only windows that lie inside the
/// picture; here those at the border see its pixels go on.
///
/// # Errors
/// Sizes that differ, or a value that is not finite.
pub fn ssim(a: &Image<DVec3>, b: &Image<DVec3>) -> Result<Image<f64>, MetricError> {
    same_size("SSIM", a, b, None)?;
    let window = gaussian(1.5, 5);
    let blur = |image: &Image<f64>| filter(image, &window, &window);
    let [a, b] = [a, b].map(|image| image.map(|c| c.dot(DVec3::new(0.2126, 0.7152, 0.0722))));
    let [c1, c2] = [0.01_f64, 0.03].map(|k| k * k);
    let [mean_a, mean_b] = [&a, &b].map(blur);
    let squares = [(&a, &a), (&b, &b), (&a, &b)];
    let [aa, bb, ab] = squares.map(|(a, b)| blur(&zip(a, b, |a, b| a * b)));
    let map = Image::from_fn(a.size(), |pixel| {
        let [ma, mb, aa, bb, ab] = [&mean_a, &mean_b, &aa, &bb, &ab].map(|i| *i.get(pixel));
        let light = (2.0 * ma * mb + c1) / (ma * ma + mb * mb + c1);
        let structure = (2.0 * (ab - ma * mb) + c2) / (aa - ma * ma + bb - mb * mb + c2);
        light * structure
    });
    finite("SSIM", map)
}

/// The map itself if all of it is finite.
pub(super) fn finite(metric: &'static str, map: Image<f64>) -> Result<Image<f64>, MetricError> {
    match map.pixels().iter().position(|value| !value.is_finite()) {
        Some(index) => Err(MetricError::NotFinite { metric, index }),
        None => Ok(map),
    }
}

/// Two images of one size, pixel by pixel.
pub(super) fn zip<T: Copy + Sync, U: Send>(
    a: &Image<T>,
    b: &Image<T>,
    with: impl Fn(T, T) -> U + Sync,
) -> Image<U> {
    Image::from_fn(a.size(), |pixel| with(*a.get(pixel), *b.get(pixel)))
}
