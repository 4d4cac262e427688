//! Pictures, and how exact they are.

use glam::{DVec2, DVec3};

use super::Tracer;
use crate::{Camera, Image};

/// A picture that knows its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Linear radiance.
    pub image: Image<DVec3>,
    /// Samples along each side of a pixel.
    pub side: u32,
    /// Root mean square of its difference, over all channels, from the picture of half as many
    /// samples along each side: about the error of this one, or more.
    pub error: f64,
}

impl Tracer<'_> {
    /// Linear radiance, the mean of `side`² samples evenly spaced in each pixel.
    ///
    /// One sample is exact for the middle of each pixel: what to compare a renderer without
    /// antialiasing with.
    pub fn render(&self, camera: &Camera, side: u32) -> Image<DVec3> {
        Image::from_fn(camera.size, |pixel| {
            let place = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
            let samples =
                (0..side).flat_map(|y| (0..side).map(move |x| DVec2::new(place(x), place(y))));
            let sum: DVec3 = samples
                .map(|within| self.radiance(camera.ray(pixel.as_dvec2() + within)))
                .sum();
            sum / f64::from(side * side)
        })
    }

    /// Doubles the samples along each side until the picture's error is a tenth of `judged`, the
    /// error that it is to judge, or until there are `most` along each side.
    pub fn render_converged(&self, camera: &Camera, judged: f64, most: u32) -> Picture {
        let mut picture = Picture {
            image: self.render(camera, 1),
            side: 1,
            error: f64::INFINITY,
        };
        while picture.error > 0.1 * judged && picture.side * 2 <= most {
            let side = picture.side * 2;
            let image = self.render(camera, side);
            let error = difference(&picture.image, &image);
            picture = Picture { image, side, error };
        }
        picture
    }
}

fn difference(a: &Image<DVec3>, b: &Image<DVec3>) -> f64 {
    let pairs = a.pixels().iter().zip(b.pixels());
    let squared: f64 = pairs.map(|(a, b)| (*a - *b).length_squared()).sum();
    (squared / (3 * a.pixels().len()).max(1) as f64).sqrt()
}
