//! The figures that the project has set itself, and whether they are reached.

use crate::{Table, methods};

use super::{
    aim::Aim,
    antialiasing,
    markdown::{Rows, number},
};

pub(super) fn text(table: &Table) -> String {
    let mut aims = Vec::new();
    layers(table, &mut aims);
    smoothing(table, &mut aims);
    speed(table, &mut aims);
    searches(table, &mut aims);
    refractions(table, &mut aims);
    aims.extend(antialiasing::aims(table).into_iter().flatten());
    aims.extend(Aim::at_most(
        "closed form of a medium: relative error, worst medium",
        worst_of(table, "relative_error_max"),
        1e-6,
    ));
    if aims.is_empty() {
        return String::new();
    }
    let mut rows = Rows::new(["aim", "wanted", "measured", "reached"]);
    for aim in aims {
        let reached = if aim.reached { "yes" } else { "no" };
        rows.add(&[&aim.what, &aim.wanted, &number(Some(aim.got)), reached]);
    }
    rows.finish()
}

/// The worst of a quantity over scenes.
fn worst(
    table: &Table,
    method: (&str, &str),
    quantity: &str,
    region: &str,
    scenes: impl Fn(&str) -> bool,
) -> Option<f64> {
    let wanted = table.scenes().into_iter().filter(|scene| scenes(scene));
    wanted
        .filter_map(|scene| table.value(scene, method, quantity, region))
        .reduce(f64::max)
}

/// The worst of a quantity over everything.
fn worst_of(table: &Table, quantity: &str) -> Option<f64> {
    let rows = table.rows().iter().filter(|row| row.quantity == quantity);
    rows.map(|row| row.value).reduce(f64::max)
}

fn layers(table: &Table, aims: &mut Vec<Aim>) {
    let worst = |quantity, region| worst(table, ("layers-bulk", ""), quantity, region, |_| true);
    aims.extend(Aim::at_most(
        "layers against the exact union: depth RMSE in r, worst scene",
        worst("front_depth_rmse", "interior"),
        1e-3,
    ));
    let ious = table.scenes().into_iter();
    let least = ious
        .filter_map(|scene| table.value(scene, ("layers-bulk", ""), "silhouette_iou", "all"))
        .reduce(f64::min);
    aims.extend(Aim::at_least(
        "layers against the exact union: IoU, worst scene",
        least,
        0.998,
    ));
}

/// The default's smoothing, as the table calls it.
fn default_smoothing() -> (&'static str, String) {
    let method = methods::default_smoothing();
    (method.name, method.parameters)
}

fn smoothing(table: &Table, aims: &mut Vec<Aim>) {
    let (name, parameters) = default_smoothing();
    for body in ["plane-0", "plane-60", "plane-80", "sphere-at"] {
        // At 80° all of a plane is grazed.
        let region = if body == "plane-80" {
            "all"
        } else {
            "interior"
        };
        for (quantity, most) in [("normal_p50", 2.5), ("normal_p95", 8.0)] {
            let got = worst(table, (name, &parameters), quantity, region, |scene| {
                scene.starts_with(body)
            });
            let what = format!("default smoothing, {body}, worst size: {quantity} in degrees");
            aims.extend(Aim::at_most(what, got, most));
        }
    }
}

fn speed(table: &Table, aims: &mut Vec<Aim>) {
    let (name, parameters) = default_smoothing();
    let value = |method, quantity, region| table.value("wave", method, quantity, region);
    let ratio = |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b);
    let own = (name, parameters.as_str());
    for (other, most) in [
        ((methods::TLS, "9x9 x3 px"), 0.35),
        ((methods::BILATERAL, "7x7 x22 px"), 0.10),
    ] {
        for (quantity, region, most) in [
            ("time_smooth_normals", "all", most),
            ("normal_p50", "interior", 1.0),
            ("normal_p95", "interior", 1.0),
            ("surface_roughness", "interior", 1.0),
        ] {
            let got = ratio(value(own, quantity, region), value(other, quantity, region));
            let what = format!(
                "wave: default smoothing over {} {}: {quantity}",
                other.0, other.1
            );
            aims.extend(Aim::at_most(what, got, most));
        }
    }
    for (quantity, region, most) in [
        ("time_gpu", "all", 0.5),
        ("picture_rmse", "all", 1.0),
        ("normal_p95", "interior", 1.0),
    ] {
        let got = ratio(
            value((methods::DEFAULT, ""), quantity, region),
            value((methods::THESIS, ""), quantity, region),
        );
        let what = format!("wave: the default's frame over the thesis's: {quantity}");
        aims.extend(Aim::at_most(what, got, most));
    }
}

fn searches(table: &Table, aims: &mut Vec<Aim>) {
    let way = ("bracketed", "0 coarse");
    for (scene, least) in [
        ("sphere", 0.995),
        ("rippled-pool", 0.995),
        ("half-filled-box", 0.995),
        ("depth-step", 0.97),
    ] {
        let got = table.value(scene, way, "search_right", "all");
        aims.extend(Aim::at_least(
            format!("search, {scene}: first true crossing"),
            got,
            least,
        ));
        let got = table.value(scene, way, "evaluations_mean", "all");
        aims.extend(Aim::at_most(
            format!("search, {scene}: evaluations"),
            got,
            6.0,
        ));
    }
}

fn refractions(table: &Table, aims: &mut Vec<Aim>) {
    for region in ["all", "deep"] {
        for quantity in ["flip", "picture_rmse", "flip_model", "picture_rmse_model"] {
            let value = |method| table.value("pool-and-droplets", method, quantity, region);
            let got = value((methods::DEFAULT, "")).zip(value(("refractions", "2")));
            let what = format!("pool and droplets: four interfaces over two: {quantity}, {region}");
            aims.extend(Aim::at_most(what, got.map(|(four, two)| four / two), 0.7));
        }
    }
    for quantity in ["flip", "picture_rmse"] {
        let value = |count| table.value("sphere", ("refractions", count), quantity, "all");
        let got = value("2").zip(value("1")).map(|(two, one)| two / one);
        let what = format!("sphere: two interfaces over one: {quantity}");
        aims.extend(Aim::at_most(what, got, 1.0));
    }
}
