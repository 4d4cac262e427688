//! Parts of a picture by how many surfaces their pixels hold.

use glam::UVec2;

use crate::Image;

/// The nearest surface of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Front {
    /// m, positive forward.
    pub view_depth: f64,
    /// Whether it is a droplet's; otherwise the bulk's.
    pub droplet: bool,
}

/// Masks that share no pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Edges {
    /// Within 1.5 pixels of the liquid's silhouette, on either side.
    pub outer: Image<bool>,
    /// Within 1.5 pixels of a step in the front's depth, or of a droplet's outline before the
    /// bulk; none of the outer ones.
    pub inner: Image<bool>,
    /// The rest of the liquid.
    pub inside: Image<bool>,
    /// What is beside the liquid.
    pub beside: Image<bool>,
}

impl Edges {
    /// Of a picture whose pixels are covered by liquid to these parts, and show these surfaces in
    /// their middles.
    ///
    /// `step`: difference in view depth from pixel to pixel, beyond what the slopes to either side
    /// make likely, that counts as a step, m.
    pub fn new(coverage: &Image<f64>, fronts: &Image<Option<Front>>, step: f64) -> Self {
        let size = coverage.size();
        // A silhouette lies in a pixel that is covered in part, or between two that differ.
        let on_silhouette = Image::from_fn(size, |pixel| {
            let here = *coverage.get(pixel);
            (here > 0.0 && here < 1.0) || (here >= 1.0) && touches(coverage, pixel, |c| c <= 0.0)
        });
        let outer = widened(&on_silhouette, 1.5);
        let inner = widened(&steps(fronts, step), 1.0);
        let of = |wanted: fn(bool, bool, bool) -> bool| {
            Image::from_fn(size, |pixel| {
                let covered = *coverage.get(pixel) > 0.0;
                wanted(covered, *outer.get(pixel), *inner.get(pixel))
            })
        };
        Self {
            inner: of(|covered, outer, inner| covered && inner && !outer),
            inside: of(|covered, outer, inner| covered && !inner && !outer),
            beside: of(|covered, outer, _| !covered && !outer),
            outer,
        }
    }

    /// All of them but what is beside, by name, and those together.
    pub fn named(&self) -> [(&'static str, Image<bool>); 4] {
        [
            ("all", self.liquid()),
            ("outer", self.outer.clone()),
            ("inner", self.inner.clone()),
            ("inside", self.inside.clone()),
        ]
    }

    /// The liquid with its silhouette.
    pub fn liquid(&self) -> Image<bool> {
        self.beside.map(|beside| !beside)
    }
}

fn touches(image: &Image<f64>, pixel: UVec2, is: impl Fn(f64) -> bool) -> bool {
    let [x, y] = pixel.as_i64vec2().to_array();
    let around = [(1, 0), (-1, 0), (0, 1), (0, -1)];
    around
        .into_iter()
        .any(|(dx, dy)| is(*image.clamped(x + dx, y + dy)))
}

/// Pixels to either side of a step.
fn steps(fronts: &Image<Option<Front>>, step: f64) -> Image<bool> {
    Image::from_fn(fronts.size(), |pixel| {
        let [x, y] = pixel.as_i64vec2().to_array();
        [(1, 0), (-1, 0), (0, 1), (0, -1)]
            .into_iter()
            .any(|(dx, dy)| {
                let at = |i: i64| *fronts.clamped(x + i * dx, y + i * dy);
                let (Some(a), Some(b)) = (at(0), at(1)) else {
                    return false;
                };
                let slope = |a: Option<Front>, b: Option<Front>| match (a, b) {
                    (Some(a), Some(b)) => (a.view_depth - b.view_depth).abs(),
                    _ => 0.0,
                };
                // A slope that goes on is none, however steep.
                let likely = slope(at(-1), at(0)).max(slope(at(1), at(2)));
                a.droplet != b.droplet || slope(at(0), at(1)) > step + likely
            })
    })
}

/// Pixels whose middles are within a distance (pixels) of those of others.
fn widened(mask: &Image<bool>, distance: f64) -> Image<bool> {
    let reach = distance as i64;
    Image::from_fn(mask.size(), |pixel| {
        let [x, y] = pixel.as_i64vec2().to_array();
        let mut around = (-reach..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
        around.any(|(dx, dy)| {
            (dx * dx + dy * dy) as f64 <= distance * distance && *mask.clamped(x + dx, y + dy)
        })
    })
}
