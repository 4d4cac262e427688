//! Pictures, and how exact they are.

use glam::{DVec3, UVec2};

use super::Tracer;
use crate::{Camera, Image, pixel_samples};

/// A picture that knows its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Linear radiance.
    pub image: Image<DVec3>,
    /// The root of the number of samples in each pixel.
    pub side: u32,
    /// Root mean square of its difference, over all channels, from the picture of half that
    /// root: about the error of that one, and more than the error of this.
    pub error: f64,
}

impl Tracer<'_> {
    /// Linear radiance, the mean of `side`² samples of each pixel ([`pixel_samples`]): what a
    /// picture is to show. One sample is that of the pixel's middle, whose edges are stairs.
    pub fn render(&self, camera: &Camera, side: u32) -> Image<DVec3> {
        Image::from_fn(camera.size, |pixel| self.pixel(camera, pixel, side))
    }

    /// A pixel of [`render`](Self::render).
    pub fn pixel(&self, camera: &Camera, pixel: UVec2, side: u32) -> DVec3 {
        let sample = |within| self.radiance(camera.ray(pixel.as_dvec2() + within));
        pixel_samples(side * side).map(sample).sum::<DVec3>() / f64::from(side * side)
    }

    /// Quadruples the samples until the picture's error is a tenth of `judged`, the error that it
    /// is to judge, or until there are `most`² of them in each pixel.
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
