//! Pictures against the means over their pixels.

use super::{aim::Aim, markdown::Rows};
use crate::{Table, methods};

/// Every method's errors on every scene.
pub(super) fn text(table: &Table) -> String {
    let mut rows = Rows::new([
        "scene, method",
        "RMSE outer",
        "RMSE inner",
        "RMSE inside",
        "off by more than 0.2",
        "sharpness",
        "difference of frames, 0.1 px",
        "pops",
        "difference of frames, 0.1°",
        "pops",
        "FLIP",
        "RMSE from the truth",
    ]);
    let mut any = false;
    for scene in table.scenes() {
        for (method, parameters) in table.methods(scene, "aliasing_rmse") {
            any = true;
            let value =
                |quantity, region| table.value(scene, (&method, &parameters), quantity, region);
            rows.numbers(
                format!("{scene}, {method} {parameters}").trim_end(),
                [
                    value("aliasing_rmse", "outer"),
                    value("aliasing_rmse", "inner"),
                    value("aliasing_rmse", "inside"),
                    value("aliasing_off", "all"),
                    value("sharpness", "inside"),
                    value("shift_difference", "all"),
                    value("shift_pops", "all"),
                    value("orbit_difference", "all"),
                    value("orbit_pops", "all"),
                    value("flip", "all"),
                    value("picture_rmse", "all"),
                ],
            );
        }
    }
    if !any {
        return String::new();
    }
    format!(
        "A picture against the mean of those that see other places of its pixels, all else equal: \
         sRGB values of 0 to 1, at the liquid's silhouette, at its inner edges and inside. \
         Sharpness is gradient energy over the mean's. Differences from frame to frame, while the \
         camera moves by a tenth of a pixel or turns by a tenth of a degree, are over the mean's; \
         a pixel pops where it changes by 0.2 and the mean does not. FLIP and the last RMSE are from \
         the tracer's picture of 64 rays a pixel, or of 4 and without FLIP where the surface is \
         implicit.\n\n{}",
        rows.finish()
    )
}

/// What the default is to reach.
pub(super) fn aims(table: &Table) -> Vec<Option<Aim>> {
    let value = |scene: &str, quantity, region| {
        table.value(scene, (methods::DEFAULT, ""), quantity, region)
    };
    let mut aims = Vec::new();
    for scene in table.scenes() {
        aims.push(Aim::at_most(
            format!("antialiasing, {scene}: RMSE at the outer edge"),
            value(scene, "aliasing_rmse", "outer"),
            0.03,
        ));
        aims.push(Aim::at_most(
            format!("antialiasing, {scene}: share of pixels off by more than 0.2"),
            value(scene, "aliasing_off", "all"),
            0.01,
        ));
        let sharpness = value(scene, "sharpness", "inside");
        let what = format!("antialiasing, {scene}: sharpness inside");
        aims.push(Aim::at_least(what.clone(), sharpness, 0.9));
        aims.push(Aim::at_most(what, sharpness, 1.1));
    }
    for (scene, most) in [
        ("wave-at-0.9px", 0.04),
        ("wave-at-1.8px", 0.035),
        ("wave-at-3.7px", 0.03),
    ] {
        aims.push(Aim::at_most(
            format!("antialiasing, {scene}: RMSE inside"),
            value(scene, "aliasing_rmse", "inside"),
            most,
        ));
    }
    for (scene, most) in [("wave", 1.3), ("sprayed-wall", 1.5)] {
        for (quantity, by) in [("shift_difference", "0.1 px"), ("orbit_difference", "0.1°")] {
            aims.push(Aim::at_most(
                format!("antialiasing, {scene}: difference of frames over the truth's, {by}"),
                value(scene, quantity, "all"),
                most,
            ));
        }
    }
    for (scene, region, most) in [
        ("wave", "outer", 3.5),
        ("wave", "inside", 2.5),
        ("sprayed-wall", "all", 4.5),
    ] {
        aims.push(Aim::at_most(
            format!("antialiasing, {scene}, {region}: mean error of 255"),
            value(scene, "aliasing_mean", region).map(|mean| 255.0 * mean),
            most,
        ));
    }
    aims
}
