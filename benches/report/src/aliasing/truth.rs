//! The mean over each pixel.

use std::path::Path;

use bevy::math::{DVec2, DVec3, UVec2};
use bevy_fluid::{prelude::ScreenSpaceFluid, settings::Antialiasing};
use fluid_reference::{
    Camera, Image,
    metrics::{decode_srgb, encode_srgb},
    pixel_samples,
};

use image::{ImageBuffer, Rgba};

use crate::{
    ReportError,
    methods::{self, Method},
    rig::Rig,
};

/// The mean of pictures that see other places of each pixel.
pub(super) struct Supersampled {
    /// The mean of light, sRGB-encoded. Each picture's light is cut to what a screen shows before
    /// that, as it is where a hardware's samples are resolved after tone mapping: a glint that is
    /// smaller than a pixel does not fill it.
    pub(super) image: Image<DVec3>,
    /// The same of every second picture: how far it is from that of all tells how far that is from
    /// the truth.
    pub(super) half: Image<DVec3>,
    /// The share of the pictures in which there is liquid.
    pub(super) coverage: Image<f64>,
}

/// A method without antialiasing of its own: what the pictures of a mean are drawn with. It bears the
/// default's name if it differs from the default in nothing else.
pub(super) fn unfiltered(method: &Method) -> Method {
    let without = |method: &Method| Method {
        settings: ScreenSpaceFluid {
            antialiasing: Antialiasing::None,
            ..method.settings
        },
        ..method.clone()
    };
    let [default, own] = [&methods::default(), method].map(without);
    let as_default = own.settings == default.settings
        && own.kernel == default.kernel
        && own.material == default.material;
    if as_default { default } else { own }
}

/// [`supersample`], or what it has left in a file of this name before.
pub(super) fn kept_or_drawn(
    rig: &mut Rig,
    camera: &Camera,
    count: u32,
    kept: Option<&Path>,
) -> Result<Supersampled, ReportError> {
    if let Some(truth) = kept.and_then(|path| Supersampled::read(path, camera.size)) {
        return Ok(truth);
    }
    let truth = supersample(rig, camera, count)?;
    if let Some(path) = kept {
        truth.write(path)?;
    }
    Ok(truth)
}

impl Supersampled {
    /// From a picture whose alpha is coverage, above that of every second; `None` where there is none
    /// of this size.
    fn read(path: &Path, size: UVec2) -> Option<Self> {
        let kept = image::open(path).ok()?.into_rgba16();
        let part = |value: u16| f64::from(value) / f64::from(u16::MAX);
        let colors = |below| {
            Image::from_fn(size, |UVec2 { x, y }| {
                let [r, g, b, _] = kept.get_pixel(x, y + below).0;
                DVec3::from([r, g, b].map(part))
            })
        };
        let fits = UVec2::from(kept.dimensions()) == size * UVec2::new(1, 2);
        fits.then(|| Self {
            image: colors(0),
            half: colors(size.y),
            coverage: Image::from_fn(size, |UVec2 { x, y }| part(kept.get_pixel(x, y).0[3])),
        })
    }

    fn write(&self, path: &Path) -> Result<(), ReportError> {
        let size = self.image.size();
        let picture = ImageBuffer::from_fn(size.x, 2 * size.y, |x, y| {
            let at = UVec2::new(x, y % size.y);
            let image = if y < size.y { &self.image } else { &self.half };
            let color = image.get(at).extend(*self.coverage.get(at));
            let of = |value: f64| (value * f64::from(u16::MAX)).round() as u16;
            Rgba(color.to_array().map(of))
        });
        picture.save(path).map_err(|error| ReportError::Plot {
            path: path.into(),
            reason: error.to_string(),
        })
    }
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
    let black = || Image::from_fn(camera.size, |_| DVec3::ZERO);
    let mut light = [black(), black()];
    let mut coverage = Image::from_fn(camera.size, |_| 0.0);
    for (place, turn) in pixel_samples(count).zip([0, 1].into_iter().cycle()) {
        rig.aim(camera, place - DVec2::splat(0.5));
        rig.frame();
        let (picture, fronts) = (rig.picture()?, rig.fronts()?);
        let linear = |c: DVec3| c.map(|c| decoded[(255.0 * c).round() as usize]);
        let sum = &light[turn];
        light[turn] = Image::from_fn(camera.size, |p| *sum.get(p) + linear(*picture.get(p)));
        let there = |p| f64::from(fronts.get(p).is_some());
        coverage = Image::from_fn(camera.size, |p| *coverage.get(p) + there(p));
    }
    let [even, odd] = light;
    let both = Image::from_fn(camera.size, |p| *even.get(p) + *odd.get(p));
    let mean = |of: Image<DVec3>, count: u32| of.map(|sum| encode_srgb(*sum / f64::from(count)));
    Ok(Supersampled {
        image: mean(both, count),
        half: mean(even, count.div_ceil(2)),
        coverage: coverage.map(|sum| sum / f64::from(count)),
    })
}
