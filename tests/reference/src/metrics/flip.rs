//! ꟻLIP for pictures of low dynamic range (Andersson et al., *ꟻLIP: A Difference Evaluator for
//! Alternating Images*, HPG 2020), written from the paper.

use std::f64::consts::{PI, SQRT_2};

use glam::{DMat3, DVec3};

use super::{
    MetricError,
    filter::{filter, gaussian, normalized, weights},
    pictures::{finite, zip},
    same_size,
};
use crate::Image;

/// A screen 0.7 m wide with 3840 pixels, seen from 0.7 m (section 6 of the paper).
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// Contrast sensitivity, table 1: pairs a, b of a √(π/b) exp(−π² x² / b), x in degrees, for
/// achromatic, red–green and blue–yellow.
const SENSITIVITY: [&[[f64; 2]]; 3] = [
    &[[1.0, 0.0047]],
    &[[1.0, 0.0053]],
    &[[34.1, 0.04], [13.5, 0.025]],
];
/// Exponent of the colour difference (4.1).
const COLOR_EXPONENT: f64 = 0.7;
/// The part `p_c` of the greatest difference, which maps to the error `p_t` (4.1).
const KNEE_IN: f64 = 0.4;
const KNEE_OUT: f64 = 0.95;
/// Width of the edge and point detectors, degrees (4.2).
const FEATURE_WIDTH: f64 = 0.082;
/// Exponent of the feature difference (4.2).
const FEATURE_EXPONENT: f64 = 0.5;

/// Errors from 0 (equal) to 1 of a picture against a reference, both sRGB-encoded in 0..=1; what
/// lies beyond is cut. A map, to be averaged with [`super::mean`].
///
/// `pixels_per_degree` tells how near the viewer is; [`PIXELS_PER_DEGREE`] is the paper's.
///
/// # Errors
/// Sizes that differ, or a value that is not finite.
pub fn flip(
    reference: &Image<DVec3>,
    test: &Image<DVec3>,
    pixels_per_degree: f64,
) -> Result<Image<f64>, MetricError> {
    same_size("FLIP", reference, test, None)?;
    for image in [reference, test] {
        // Cutting would hide them.
        finite("FLIP", image.map(|c| c.element_sum()))?;
    }
    let opponent = [reference, test].map(|image| image.map(|c| opponent(decode_srgb(*c))));
    let [seen_reference, seen_test] = [0, 1].map(|i| perceived(&opponent[i], pixels_per_degree));
    let [features_reference, features_test] =
        [0, 1].map(|i| features(&opponent[i], pixels_per_degree));
    let color = zip(&seen_reference, &seen_test, color_error);
    let feature = zip(&features_reference, &features_test, |a, b| {
        let difference = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
        (difference / SQRT_2).powf(FEATURE_EXPONENT)
    });
    finite(
        "FLIP",
        zip(&color, &feature, |color, feature| color.powf(1.0 - feature)),
    )
}

/// The picture as it is seen: without what is too fine, in Lab with Hunt's adjustment.
fn perceived(opponent: &Image<DVec3>, pixels_per_degree: f64) -> Image<DVec3> {
    let widest = SENSITIVITY
        .iter()
        .copied()
        .flatten()
        .fold(0.0, |w: f64, [_, b]| w.max(*b));
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let [y, x, z] = [0, 1, 2].map(|channel| {
        let image = opponent.map(|c| c[channel]);
        let mut sum = image.map(|_| 0.0);
        let mut total = 0.0;
        for [a, b] in SENSITIVITY[channel] {
            let bell = weights(radius, |x| {
                (-PI * PI * (x / pixels_per_degree).powi(2) / b).exp()
            });
            // What this Gaussian adds to the sum of all weights.
            let share = a * (PI / b).sqrt() * bell.iter().sum::<f64>().powi(2);
            let bell = normalized(bell);
            sum = zip(&sum, &filter(&image, &bell, &bell), |sum, part| {
                sum + share * part
            });
            total += share;
        }
        sum.map(|value| value / total)
    });
    Image::from_fn(opponent.size(), |p| {
        let rgb = linear(DVec3::new(*y.get(p), *x.get(p), *z.get(p)));
        hunt(lab(rgb.clamp(DVec3::ZERO, DVec3::ONE)))
    })
}

fn color_error(a: DVec3, b: DVec3) -> f64 {
    // What differs most: pure green and pure blue.
    let most = hyab(hunt(lab(DVec3::Y)), hunt(lab(DVec3::Z))).powf(COLOR_EXPONENT);
    let error = hyab(a, b).powf(COLOR_EXPONENT);
    let knee = KNEE_IN * most;
    if error < knee {
        KNEE_OUT * error / knee
    } else {
        KNEE_OUT + (1.0 - KNEE_OUT) * (error - knee) / (most - knee)
    }
}

/// Strength of edges and of points in the achromatic channel.
fn features(opponent: &Image<DVec3>, pixels_per_degree: f64) -> Image<[f64; 2]> {
    let light = opponent.map(|c| (c.x + 16.0) / 116.0);
    let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * sigma).ceil() as i32;
    let bell = gaussian(sigma, radius);
    let shape = |x: f64| (-0.5 * (x / sigma).powi(2)).exp();
    let edge = normalized(weights(radius, |x| -x * shape(x)));
    let point = normalized(weights(radius, |x| ((x / sigma).powi(2) - 1.0) * shape(x)));
    let strength = |detector: &[f64]| {
        let across = filter(&light, detector, &bell);
        zip(&across, &filter(&light, &bell, detector), f64::hypot)
    };
    zip(&strength(&edge), &strength(&point), |edge, point| {
        [edge, point]
    })
}

/// Distance of large colour differences (Abasi et al. 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    (a.x - b.x).abs() + (a.y - b.y).hypot(a.z - b.z)
}

/// Chroma fades with lightness.
fn hunt(lab: DVec3) -> DVec3 {
    lab * DVec3::new(1.0, 0.01 * lab.x, 0.01 * lab.x)
}

fn decode_srgb(encoded: DVec3) -> DVec3 {
    encoded.map(|c| {
        let c = c.clamp(0.0, 1.0);
        if c <= 0.04045 {
            c / 12.92
        } else {
            ((c + 0.055) / 1.055).powf(2.4)
        }
    })
}

/// CIE XYZ of linear sRGB with the white (0.3127, 0.3290).
fn xyz_from_rgb() -> DMat3 {
    DMat3::from_cols(
        DVec3::new(
            10_135_552.0 / 24_577_794.0,
            2_613_072.0 / 12_288_897.0,
            1_425_312.0 / 73_733_382.0,
        ),
        DVec3::new(
            8_788_810.0 / 24_577_794.0,
            8_788_810.0 / 12_288_897.0,
            8_788_810.0 / 73_733_382.0,
        ),
        DVec3::new(
            4_435_075.0 / 24_577_794.0,
            887_015.0 / 12_288_897.0,
            70_074_185.0 / 73_733_382.0,
        ),
    )
}

/// XYZ over that of white.
fn relative(rgb: DVec3) -> DVec3 {
    xyz_from_rgb() * rgb / (xyz_from_rgb() * DVec3::ONE)
}

/// The linear opponent space Y Cx Cz.
fn opponent(rgb: DVec3) -> DVec3 {
    let DVec3 { x, y, z } = relative(rgb);
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

fn linear(opponent: DVec3) -> DVec3 {
    let y = (opponent.x + 16.0) / 116.0;
    let relative = DVec3::new(opponent.y / 500.0 + y, y, y - opponent.z / 200.0);
    xyz_from_rgb().inverse() * (relative * (xyz_from_rgb() * DVec3::ONE))
}

/// CIE L*a*b*.
fn lab(rgb: DVec3) -> DVec3 {
    let delta = 6.0_f64 / 29.0;
    let DVec3 { x, y, z } = relative(rgb).map(|t| {
        if t > delta.powi(3) {
            t.cbrt()
        } else {
            t / (3.0 * delta * delta) + 4.0 / 29.0
        }
    });
    DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}
