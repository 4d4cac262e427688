//! Places within a pixel.

use std::f64::consts::GOLDEN_RATIO;

use glam::DVec2;

/// `count` places within a pixel whose sides are 1, on a lattice turned by the golden ratio, in
/// which no row or column holds two: edges of any slope converge alike.
pub fn pixel_samples(count: u32) -> impl Iterator<Item = DVec2> {
    (0..count).map(move |i| {
        let i = f64::from(i);
        let row = (0.5 + i * (GOLDEN_RATIO - 1.0)).fract();
        DVec2::new((i + 0.5) / f64::from(count), row)
    })
}
