//! What was measured, in a line.

use super::{Aliasing, Errors};
use crate::{methods::Method, scenes::Scene};

/// What the columns of [`line`] are.
pub(super) const HEADING: &str = "scene, method | size | RMSE outer, inner, inside, beside | mean \
    of 255 outer, inner, inside | share off by 0.2, all and inside | sharpness | 0.1 px: frames' \
    difference over the truth's, pops, flips | 0.1°: the same";

pub(super) fn line(scene: &Scene, method: &Method, of: &Aliasing) -> String {
    let cell = |region: &str, value: fn(&Errors) -> f64, digits: usize| {
        let errors = of.errors.iter().find(|(name, _)| *name == region);
        let number = |(_, errors): &(_, Errors)| format!("{:.digits$}", value(errors));
        errors.map_or_else(|| "–".into(), number)
    };
    let cells = |regions: &[&str], value, digits| {
        let cells = regions.iter().map(|region| cell(region, value, digits));
        cells.collect::<Vec<_>>().join(" ")
    };
    let size = scene.camera.size;
    let mut columns = vec![
        format!("{}, {}", scene.name, method.label().trim_end()),
        format!("{}x{}", size.x, size.y),
        cells(&["outer", "inner", "inside", "beside"], |e| e.rmse, 4),
        cells(&["outer", "inner", "inside"], |e| 255.0 * e.mean, 2),
        cells(&["all", "inside"], |e| e.off, 4),
        of.sharpness
            .map_or_else(|| "–".into(), |sharpness| format!("{sharpness:.3}")),
    ];
    columns.extend(of.motions.iter().map(|(_, motion)| {
        let (ratio, pops, flips) = (motion.ratio, motion.pops, motion.flips);
        format!("{ratio:.3} {pops:.4} {flips:.4}")
    }));
    columns.join(" | ")
}
