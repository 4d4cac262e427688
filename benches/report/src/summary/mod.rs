//! The report in words and tables.

mod aim;
mod aims;
mod antialiasing;
mod failures;
mod markdown;
mod published;

use std::{fmt::Write, fs, path::Path};

use crate::{
    ReportError, Table,
    front::{TRADES, points},
    methods,
};
use markdown::Rows;

/// Writes `summary.md`.
pub(crate) fn write(table: &Table, adapter: &str, folder: &Path) -> Result<(), ReportError> {
    let path = folder.join("summary.md");
    fs::write(&path, text(table, adapter)).map_err(|source| ReportError::Write { path, source })
}

/// A heading and what is below it.
type Part = (&'static str, String);

fn text(table: &Table, adapter: &str) -> String {
    let mut out = format!(
        "# Speed against error\n\n\
         Rendered by {adapter}, on a machine of {} threads. Times are medians of GPU timestamps in \
         ms, the methods taking turns within one run; on another machine trust their ratios. \
         Lengths are in particle radii (r), angles in degrees. The bench writes every value to \
         `speed_error.csv` beside this file; that table is not in the repository.\n",
        std::thread::available_parallelism().map_or(1, usize::from),
    );
    let parts: [Part; 11] = [
        ("What was aimed for", aims::text(table)),
        ("Presets", presets(table)),
        ("Where the time goes", passes(table)),
        ("Fronts", fronts(table)),
        ("How many refractions", refractions(table)),
        ("Antialiasing", antialiasing::text(table)),
        ("Layers or search: what is to blame", ablation(table)),
        ("Searches in exact layers", searches(table)),
        ("What is inside", inside(table)),
        ("Where each method fails", failures::text(table)),
        ("The thesis's tables", published::text(table)),
    ];
    for (heading, part) in parts {
        if !part.is_empty() {
            // Writing to a string cannot fail.
            let _ = write!(out, "\n## {heading}\n\n{part}");
        }
    }
    out
}

/// Every preset on every scene: time relative to the default, and errors.
fn presets(table: &Table) -> String {
    let mut rows = Rows::new([
        "scene, preset",
        "time",
        "of the default's",
        "FLIP",
        "RMSE",
        "normals p50",
        "normals p95",
        "offset",
        "roughness",
    ]);
    let mut any = false;
    for scene in table.scenes() {
        let value = |preset, quantity, region| table.value(scene, (preset, ""), quantity, region);
        let default = value(methods::DEFAULT, "time_gpu", "all");
        for preset in methods::PRESETS {
            let time = value(preset, "time_gpu", "all");
            if time.is_none() {
                continue;
            }
            any = true;
            rows.numbers(
                &format!("{scene}, {preset}"),
                [
                    time,
                    time.zip(default).map(|(time, default)| time / default),
                    value(preset, "flip", "all"),
                    value(preset, "picture_rmse", "all"),
                    value(preset, "normal_p50", "interior"),
                    value(preset, "normal_p95", "interior"),
                    value(preset, "surface_offset", "interior"),
                    value(preset, "surface_roughness", "interior"),
                ],
            );
        }
    }
    if any { rows.finish() } else { String::new() }
}

fn passes(table: &Table) -> String {
    const PASSES: [&str; 7] = [
        "time_splat",
        "time_smooth",
        "time_normals",
        "time_refract",
        "time_composite",
        "time_gpu",
        "time_shape_cpu",
    ];
    let headings = [
        "scene, preset",
        "splat",
        "smooth",
        "normals",
        "refract",
        "composite",
        "GPU in all",
        "shape (CPU)",
    ];
    let mut rows = Rows::new(headings);
    for scene in table.scenes() {
        for preset in methods::PRESETS {
            let times = PASSES.map(|pass| table.value(scene, (preset, ""), pass, "all"));
            if times[0].is_some() {
                rows.numbers(&format!("{scene}, {preset}"), times);
            }
        }
    }
    rows.finish()
}

fn fronts(table: &Table) -> String {
    let mut out = String::from(
        "Methods that no other beats in both time and error, fastest first: time in ms, error.\n\n",
    );
    for scene in table.scenes() {
        for trade in &TRADES {
            let front: Vec<String> = points(table, scene, trade)
                .into_iter()
                .filter(|point| point.on_front)
                .map(|point| {
                    format!(
                        "{} ({}, {})",
                        format!("{} {}", point.method, point.parameters).trim_end(),
                        markdown::number(Some(point.time)),
                        markdown::number(Some(point.error)),
                    )
                })
                .collect();
            if front.len() > 1 {
                let _ = writeln!(
                    out,
                    "- [{scene}, {}]({scene}_{}.svg): {}",
                    trade.title,
                    trade.error,
                    front.join(", ")
                );
            }
        }
    }
    out
}

fn refractions(table: &Table) -> String {
    let mut rows = Rows::new(["scene, error", "0", "1", "2", "4", "4 over 2", "2 over 1"]);
    for scene in table.scenes() {
        for (name, quantity, region) in [
            ("FLIP", "flip", "all"),
            ("RMSE", "picture_rmse", "all"),
            ("FLIP beyond two interfaces", "flip", "deep"),
            ("RMSE beyond two interfaces", "picture_rmse", "deep"),
            ("FLIP, model", "flip_model", "all"),
            ("RMSE, model", "picture_rmse_model", "all"),
            ("FLIP beyond two, model", "flip_model", "deep"),
            ("RMSE beyond two, model", "picture_rmse_model", "deep"),
        ] {
            let counts = ["0", "1", "2"];
            let value = |method| table.value(scene, method, quantity, region);
            let [zero, one, two] = counts.map(|count| value(("refractions", count)));
            let four = value((methods::DEFAULT, ""));
            let ratio = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
            if two.is_some() && four.is_some() {
                let label = format!("{scene}, {name}");
                rows.numbers(
                    &label,
                    [zero, one, two, four, ratio(four, two), ratio(two, one)],
                );
            }
        }
    }
    rows.finish()
}

fn ablation(table: &Table) -> String {
    const WAYS: [&str; 4] = [
        "our layers, our search",
        "our layers, exact search",
        "exact layers, our search",
        "our search against exact search",
    ];
    let mut rows = Rows::new(["scene, error"].into_iter().chain(WAYS));
    for scene in table.scenes() {
        for (name, quantity) in [("FLIP", "flip"), ("RMSE", "picture_rmse")] {
            let values = WAYS.map(|way| table.value(scene, ("ablation", way), quantity, "all"));
            if values.iter().any(Option::is_some) {
                rows.numbers(&format!("{scene}, {name}"), values);
            }
        }
    }
    rows.finish()
}

fn searches(table: &Table) -> String {
    const QUANTITIES: [&str; 8] = [
        "search_right",
        "search_missed",
        "search_invented",
        "search_error_p50",
        "search_error_p95",
        "exit_direction_p50",
        "evaluations_mean",
        "evaluations_max",
    ];
    let mut rows = Rows::new([
        "scene, search",
        "right crossing",
        "missed",
        "invented",
        "error p50",
        "error p95",
        "exit direction p50",
        "evaluations",
        "at most",
    ]);
    for scene in table.scenes() {
        for (method, parameters) in table.methods(scene, "search_right") {
            let values = QUANTITIES.map(|q| table.value(scene, (&method, &parameters), q, "all"));
            rows.numbers(format!("{scene}, {method} {parameters}").trim_end(), values);
        }
    }
    rows.finish()
}

/// The closed form of a medium against its differential equation, and thickness against the truth.
fn inside(table: &Table) -> String {
    let mut forms = Rows::new([
        "closed form, medium",
        "relative error",
        "ns",
        "ns of the march",
    ]);
    let mut lengths = Rows::new([
        "scene, thickness",
        "ms a frame",
        "offset in r",
        "RMSE in r",
        "RMSE, one puff",
        "RMSE, two in line",
    ]);
    let mut any = false;
    for scene in table.scenes() {
        for (method, parameters) in table.methods(scene, "relative_error_max") {
            let value = |quantity| table.value(scene, (&method, &parameters), quantity, "all");
            let quantities = ["relative_error_max", "time_closed_form", "time_march"];
            forms.numbers(&parameters, quantities.map(value));
        }
        for (method, parameters) in table.methods(scene, "thickness_rmse") {
            any = true;
            let value =
                |quantity, region| table.value(scene, (&method, &parameters), quantity, region);
            lengths.numbers(
                &format!("{scene}, {parameters}"),
                [
                    value("time_gpu", "all"),
                    value("thickness_offset", "all"),
                    value("thickness_rmse", "all"),
                    value("thickness_rmse", "single"),
                    value("thickness_rmse", "behind"),
                ],
            );
        }
    }
    if any {
        format!("{}\n{}", forms.finish(), lengths.finish())
    } else {
        String::new()
    }
}
