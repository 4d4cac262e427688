//! Parts of a picture that are hard for different reasons.

use glam::UVec2;

use crate::{Camera, Image, Span};

/// Masks that share no pixel. The outline's also has pixels beside the liquid, the others have
/// not.
#[derive(Clone, Debug, PartialEq)]
pub struct Regions {
    /// Liquid that is neither of the others.
    pub interior: Image<bool>,
    /// Near an outline: of the liquid, or of a part of it before another.
    pub silhouette: Image<bool>,
    /// Liquid whose front is seen at a grazing angle.
    pub grazing: Image<bool>,
}

impl Regions {
    /// Of what a camera sees.
    ///
    /// `band`: width of the outline to either side, pixels. `step`: difference in view depth from
    /// one pixel to the next that makes an outline, m; give it more than the slopes in the scene.
    /// `grazing`: cosine between the normal and the ray below which the front is grazed.
    pub fn new(
        camera: &Camera,
        truth: &Image<Option<Span>>,
        band: u32,
        step: f64,
        grazing: f64,
    ) -> Self {
        let size = truth.size();
        let depth = |x, y| truth.clamped(x, y).map(|span: Span| span.front.view_depth);
        let edge = Image::from_fn(size, |pixel| {
            let [x, y] = pixel.as_i64vec2().to_array();
            let here = depth(x, y);
            [(1, 0), (-1, 0), (0, 1), (0, -1)]
                .into_iter()
                .any(|(dx, dy)| match (here, depth(x + dx, y + dy)) {
                    (Some(a), Some(b)) => (a - b).abs() > step,
                    (a, b) => a.is_some() != b.is_some(),
                })
        });
        // Pixels on both sides of an edge are edge pixels: the first of the band.
        let reach = i64::from(band) - 1;
        let silhouette = Image::from_fn(size, |pixel| {
            let [x, y] = pixel.as_i64vec2().to_array();
            let mut around =
                (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
            around.any(|(dx, dy)| *edge.clamped(x + dx, y + dy))
        });
        let grazed = |pixel: UVec2, span: &Span| {
            span.front.normal.dot(-camera.pixel_ray(pixel).direction) < grazing
        };
        let of = |wanted: bool| {
            Image::from_fn(size, |pixel| {
                let span = truth.get(pixel).as_ref();
                span.is_some_and(|span| grazed(pixel, span) == wanted) && !silhouette.get(pixel)
            })
        };
        let [interior, grazing] = [false, true].map(of);
        Self {
            interior,
            silhouette,
            grazing,
        }
    }
}
