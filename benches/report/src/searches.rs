//! How well the next interface is found, in layers that are exact.

use bevy::math::{DVec2, DVec3};
use bevy_fluid::render::{ExitRay, SearchStatus};
use fluid_reference::{
    Camera, Image, layers,
    metrics::{Quantiles, Search, Status, direction_error, search_report},
    tracer::{Path, Tracer, World},
};

use crate::{
    ReportError,
    methods::{Method, searches},
    rig::Rig,
    scenes::Scene,
    surfaces::metric,
    surroundings::sky,
    table::{Subject, Table},
    truth::water,
};

/// A crossing that is found within so many particle radii of the true one is the right one.
const RIGHT: f64 = 1.0;

/// Runs every search through exact layers, against the exact path.
pub(crate) fn measure(
    table: &mut Table,
    scene: &Scene,
    rig: &mut Rig,
    quick: bool,
) -> Result<(), ReportError> {
    // Droplets are drawn exactly as they are; only the bulk has layers to be exact.
    let (Some(exact), None) = (&scene.exact, &scene.exact_bulk) else {
        return Ok(());
    };
    let camera = &scene.camera;
    let world = World {
        surface: &**exact,
        objects: &[],
        sky: &sky,
    };
    let tracer = Tracer {
        interfaces: 2,
        ..Tracer::renderer(world, water())
    };
    let paths = Image::from_fn(camera.size, |pixel| tracer.path(camera.pixel_ray(pixel)));
    let spans = layers(camera, &**exact);
    for method in searches(quick) {
        rig.show(&method)?;
        rig.put_exact_layers(Some(&spans));
        rig.frame();
        let exits = rig.exits()?;
        rig.put_exact_layers(None);
        compare(table, scene, &method, &paths, &exits)?;
    }
    Ok(())
}

fn compare(
    table: &mut Table,
    scene: &Scene,
    method: &Method,
    paths: &Image<Path>,
    exits: &Image<Option<ExitRay>>,
) -> Result<(), ReportError> {
    let subject = Subject {
        scene,
        method: method.name,
        parameters: &method.parameters,
    };
    let mut searched = Vec::new();
    let mut directions = Vec::new();
    let mut evaluations = Vec::new();
    for (path, exit) in paths.pixels().iter().zip(exits.pixels()) {
        // Where total reflection comes first there is nothing to search.
        let (Some(exit), [_, rest @ ..]) = (exit, &path.vertices[..]) else {
            continue;
        };
        if exit.searches[0] == SearchStatus::None {
            continue;
        }
        let found = position(&scene.camera, exit);
        let truth = rest.first().map(|vertex| vertex.position);
        let search = Search {
            status: Status::ALL[exit.searches[0] as usize],
            position: found,
            truth,
        };
        evaluations.push(f64::from(exit.evaluations));
        if let Some(truth) = truth
            && is_right(&search, truth, scene.radius)
        {
            let direction = scene
                .camera
                .world_from_view
                .transform_vector3(exit.direction.as_dvec3());
            directions.push([direction, path.exit.direction]);
        }
        searched.push(search);
    }
    let wrong = |source| metric(subject, source);
    let report = search_report(&searched, scene.radius).map_err(wrong)?;
    let with_truth = searched.iter().filter_map(|s| Some((s, s.truth?)));
    let right = with_truth
        .clone()
        .filter(|(s, truth)| is_right(s, *truth, scene.radius))
        .count();
    let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
    let met = with_truth.count();
    table.add(subject, "search_right", "all", share(right, met), "1");
    table.add(
        subject,
        "search_missed",
        "all",
        share(report.missed, met),
        "1",
    );
    table.add(
        subject,
        "search_invented",
        "all",
        share(report.invented, searched.len()),
        "1",
    );
    for (status, quantity) in Status::ALL.into_iter().zip(STATUSES) {
        table.add(subject, quantity, "all", report.rate(status), "1");
    }
    if let Some(error) = report.error {
        table.add(subject, "search_error_p50", "all", error.p50, "r");
        table.add(subject, "search_error_p95", "all", error.p95, "r");
        table.add(subject, "search_error_max", "all", error.max, "r");
    }
    if !directions.is_empty() {
        let error = direction_error("exit direction", directions).map_err(wrong)?;
        table.add(subject, "exit_direction_p50", "all", error.p50, "deg");
        table.add(subject, "exit_direction_p95", "all", error.p95, "deg");
    }
    if !evaluations.is_empty() {
        let spent = Quantiles::of("evaluations", evaluations).map_err(wrong)?;
        table.add(subject, "evaluations_mean", "all", spent.mean, "1");
        table.add(subject, "evaluations_max", "all", spent.max, "1");
    }
    Ok(())
}

/// In the order of `Status::ALL`.
const STATUSES: [&str; 8] = [
    "status_none",
    "status_hit",
    "status_no_bracket",
    "status_left_layer",
    "status_invalid",
    "status_total_reflection",
    "status_budget",
    "status_opaque",
];

fn is_right(search: &Search, truth: DVec3, radius: f64) -> bool {
    search.position.distance(truth) <= RIGHT * radius
}

/// Where an exit ray starts, in world space.
fn position(camera: &Camera, exit: &ExitRay) -> DVec3 {
    let on_screen: DVec2 = exit.uv.as_dvec2() * camera.size.as_dvec2();
    let depth = camera.view_from_device(f64::from(exit.device_depth));
    camera.unproject(on_screen, depth)
}
