//! The mean over each pixel.

use bevy::math::{DVec2, DVec3};
use fluid_reference::{
    Camera, Image,
    metrics::{decode_srgb, encode_srgb},
    pixel_samples,
};

use crate::{ReportError, methods::Method, rig::Rig};

/// The mean of pictures that see other places of each pixel.
pub(super) struct Supersampled {
    /// The mean of light, sRGB-encoded. Each picture's light is cut to what a screen shows before
    /// that, as it is where a hardware's samples are resolved after tone mapping: a glint that is
    /// smaller than a pixel does not fill it.
    pub(super) image: Image<DVec3>,
    /// The share of the pictures in which there is liquid.
    pub(super) coverage: Image<f64>,
}

/// A method without antialiasing of its own: what the pictures of a mean are drawn with.
pub(super) fn unfiltered(method: &Method) -> Method {
    method.clone()
}

/// The mean of `count` pictures; the rig is left looking past the middles of its pixels.
pub(super) fn supersample(
    rig: &mut Rig,
    camera: &Camera,
    count: u32,
) -> Result<Supersampled, ReportError> {
    let decoded: Vec<f64> = (0..=255)
        .map(|byte| decode_srgb(DVec3::splat(f64::from(byte) / 255.0)).x)
        .collect();
    let mut light = Image::from_fn(camera.size, |_| DVec3::ZERO);
    let mut coverage = Image::from_fn(camera.size, |_| 0.0);
    for place in pixel_samples(count) {
        rig.aim(camera, place - DVec2::splat(0.5));
        rig.frame();
        let (picture, fronts) = (rig.picture()?, rig.fronts()?);
        let linear = |c: DVec3| c.map(|c| decoded[(255.0 * c).round() as usize]);
        light = Image::from_fn(camera.size, |p| *light.get(p) + linear(*picture.get(p)));
        let there = |p| f64::from(fronts.get(p).is_some());
        coverage = Image::from_fn(camera.size, |p| *coverage.get(p) + there(p));
    }
    let count = f64::from(count);
    Ok(Supersampled {
        image: light.map(|sum| encode_srgb(*sum / count)),
        coverage: coverage.map(|sum| sum / count),
    })
}
