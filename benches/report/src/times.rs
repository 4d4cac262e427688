//! How long the passes take: all methods in turn, so that a drifting machine favours none.

use bevy::diagnostic::{Diagnostic, DiagnosticsStore};
use bevy_fluid::diagnostics::gpu_time;
use indicatif::ProgressBar;

use crate::{
    ReportError,
    methods::Method,
    rig::Rig,
    scenes::Scene,
    table::{Subject, Table},
};

/// The passes by the names of their GPU spans, and what the table calls their times.
const PASSES: [(&str, &str, &str); 7] = [
    (
        "fluid_scene_depth",
        "time_scene_depth",
        "time_scene_depth_p95",
    ),
    ("fluid_splat", "time_splat", "time_splat_p95"),
    ("fluid_smooth", "time_smooth", "time_smooth_p95"),
    ("fluid_normals", "time_normals", "time_normals_p95"),
    ("fluid_thickness", "time_thickness", "time_thickness_p95"),
    ("fluid_refract", "time_refract", "time_refract_p95"),
    ("fluid_composite", "time_composite", "time_composite_p95"),
];

/// Frames of a method that are drawn before its turn counts: its textures change hands, and times
/// are read a frame or two after they were taken.
const WARM_UP: u32 = 2;
/// Frames that count in each turn.
const TURN: u32 = 5;

/// How many turns each method gets: a software driver is slow, and steadier.
pub(crate) fn turns(adapter: &str, quick: bool) -> u32 {
    match (quick, adapter.contains("llvmpipe")) {
        (true, _) => 1,
        (false, true) => 2,
        (false, false) => 6,
    }
}

/// Adds the median and the 95th percentile of every pass's GPU time, of the sum of the passes, and
/// of the shape stage on the CPU.
pub(crate) fn measure(
    table: &mut Table,
    scene: &Scene,
    methods: &[Method],
    rig: &mut Rig,
    turns: u32,
    progress: &ProgressBar,
) -> Result<(), ReportError> {
    let mut taken: Vec<Vec<[f64; PASSES.len()]>> = vec![Vec::new(); methods.len()];
    let mut shaped: Vec<Vec<f64>> = vec![Vec::new(); methods.len()];
    for method in methods {
        rig.show(method)?;
        progress.inc(1);
    }
    for _ in 0..turns {
        for (index, method) in methods.iter().enumerate() {
            rig.choose(method);
            rig.stir();
            (0..WARM_UP).for_each(|_| rig.frame());
            forget(rig);
            for _ in 0..TURN {
                rig.stir();
                rig.frame();
                if let Some(fluid) = rig.shaped() {
                    shaped[index].push(1e3 * fluid.times().total.as_secs_f64());
                }
            }
            taken[index].extend(frames(rig));
            progress.inc(1);
        }
    }
    for ((method, frames), shaped) in methods.iter().zip(taken).zip(shaped) {
        let subject = Subject {
            scene,
            method: method.name,
            parameters: &method.parameters,
        };
        if let Some([median, high]) = median_and_p95(shaped) {
            table.add(subject, "time_shape_cpu", "all", median, "ms");
            table.add(subject, "time_shape_cpu_p95", "all", high, "ms");
        }
        for (pass, (_, quantity, quantity_p95)) in PASSES.iter().enumerate() {
            let times = frames.iter().map(|frame| frame[pass]).collect();
            if let Some([median, high]) = median_and_p95(times) {
                table.add(subject, quantity, "all", median, "ms");
                table.add(subject, quantity_p95, "all", high, "ms");
            }
        }
        // The smoothing's own work: the pass that finds normals is spared where it yields them.
        let sum = |passes: &[usize]| {
            let times = frames
                .iter()
                .map(|frame| passes.iter().map(|&p| frame[p]).sum());
            median_and_p95(times.collect())
        };
        for (passes, quantity, quantity_p95) in [
            (
                &[2, 3][..],
                "time_smooth_normals",
                "time_smooth_normals_p95",
            ),
            (&[0, 1, 2, 3, 4, 5, 6], "time_gpu", "time_gpu_p95"),
        ] {
            if let Some([median, high]) = sum(passes) {
                table.add(subject, quantity, "all", median, "ms");
                table.add(subject, quantity_p95, "all", high, "ms");
            }
        }
    }
    Ok(())
}

fn forget(rig: &mut Rig) {
    let mut store = rig.app.world_mut().resource_mut::<DiagnosticsStore>();
    for diagnostic in store.iter_mut() {
        diagnostic.clear_history();
    }
}

/// The times of every frame since, pass by pass; a pass that did not run took none.
fn frames(rig: &Rig) -> Vec<[f64; PASSES.len()]> {
    let Some(store) = rig.app.world().get_resource::<DiagnosticsStore>() else {
        return Vec::new();
    };
    let histories = PASSES.map(|(pass, ..)| {
        let values = store.get(&gpu_time(pass)).map(Diagnostic::values);
        values.map_or(Vec::new(), |values| values.copied().collect::<Vec<_>>())
    });
    let count = histories.iter().map(Vec::len).max().unwrap_or(0);
    (0..count)
        .map(|frame| {
            histories
                .each_ref()
                .map(|history| history.get(frame).copied().unwrap_or(0.0))
        })
        .collect()
}

fn median_and_p95(mut times: Vec<f64>) -> Option<[f64; 2]> {
    times.sort_by(f64::total_cmp);
    let last = times.len().checked_sub(1)?;
    Some([0.5, 0.95].map(|part| times[(part * last as f64).round() as usize]))
}
