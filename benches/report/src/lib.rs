//! Speed against error of `bevy_fluid`, measured in one run: the program behind
//! `cargo bench --package fluid_benches --bench speed_error`.
//!
//! Every scene is drawn headless with every method. Errors are those of what the GPU holds
//! against `fluid_reference`; times are GPU timestamps, the methods taking turns. [`run`] writes a
//! table, plots and a summary.

pub mod aliasing;
mod error;
mod front;
mod media;
mod methods;
mod options;
mod pictures;
mod plots;
pub mod reference;
mod rig;
mod scenes;
mod searches;
mod summary;
mod surfaces;
mod surroundings;
mod table;
mod thesis;
mod times;
mod truth;

use std::{
    fs,
    process::{Command, ExitCode},
};

use fluid_stage::adapter_name;
use indicatif::{ProgressBar, ProgressStyle};

pub use error::ReportError;
pub use options::Options;
pub use table::{Row, Table};

use aliasing::Aliasing;
use methods::Method;
use pictures::TruePicture;
use rig::Rig;
use scenes::{Measures, Scene};
use table::Subject;
use truth::{Splats, Truth};

/// The exit code of a program that has measured; what went wrong is printed.
pub fn exit_code(done: Result<(), ReportError>) -> ExitCode {
    let Err(error) = done else {
        return ExitCode::SUCCESS;
    };
    if error.exit_code() == 0 {
        print!("{error}");
    } else {
        eprintln!("{}", error.to_string().trim_end());
    }
    ExitCode::from(error.exit_code())
}

/// Measures what is asked for and writes the report.
///
/// # Errors
/// No adapter, a picture that cannot be drawn, a value that is not a number, a file that cannot be
/// written.
pub fn run(options: &Options) -> Result<(), ReportError> {
    let mut table = Table::default();
    let makers = scenes::asked(options).into_iter();
    for scene in makers.filter_map(|name| scenes::make(options, name)) {
        measure(&mut table, &scene?, options)?;
        // What is there so far, should a later scene fail.
        table.write(&options.out)?;
    }
    if options.table_only {
        return Ok(());
    }
    finish(&table, options)
}

/// The same with a process for every scene, as software drivers keep some memory of every frame:
/// runs this program again with other options.
///
/// # Errors
/// As [`run`]; what fails in another process has said why by itself.
pub fn run_apart(options: &Options) -> Result<(), ReportError> {
    let names = scenes::asked(options);
    if options.table_only || (names.len() < 2 && !options.resume) {
        return run(options);
    }
    let mut table = Table::default();
    if options.resume && Table::is_in(&options.out) {
        table.read(&options.out)?;
    }
    let folder = options.out.join("part");
    for name in names {
        if table.scenes().contains(&name) {
            continue;
        }
        let failed = |reason: String| ReportError::Part {
            path: folder.clone(),
            reason,
        };
        let program = std::env::current_exe().map_err(|error| failed(error.to_string()))?;
        let mut part = Command::new(program);
        part.args(["--table-only", "--scene", name, "--out"])
            .arg(&folder);
        part.args(options.quick.then_some("--quick"));
        part.args(options.method.iter().flat_map(|name| ["--method", name]));
        if let Some(size) = options.size {
            part.args(["--size".into(), format!("{}x{}", size.x, size.y)]);
        }
        part.args(options.still.then_some("--still"));
        if let Some(jitters) = options.jitters {
            part.args(["--jitters".into(), jitters.to_string()]);
        }
        if let Some(truths) = &options.truths {
            part.arg("--truths").arg(truths);
        }
        part.arg("--pictures").arg(options.pictures());
        let status = part.status().map_err(|error| failed(error.to_string()))?;
        if !status.success() {
            return Err(failed(format!("{name} ended with {status}")));
        }
        table.read(&folder)?;
        table.write(&options.out)?;
    }
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|source| ReportError::Write {
            path: folder,
            source,
        })?;
    }
    finish(&table, options)
}

fn finish(table: &Table, options: &Options) -> Result<(), ReportError> {
    plots::draw(table, &options.out)?;
    summary::write(table, &stage_adapter()?, &options.out)
}

/// The name of the adapter that renders.
fn stage_adapter() -> Result<String, ReportError> {
    let app = fluid_stage::headless_app(bevy::math::UVec2::ONE, |_| {})?;
    Ok(adapter_name(&app))
}

/// Measures a scene.
fn measure(table: &mut Table, scene: &Scene, options: &Options) -> Result<(), ReportError> {
    let progress = ProgressBar::new(0).with_style(
        ProgressStyle::with_template("{prefix:20} {wide_bar} {pos}/{len} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar()),
    );
    progress.set_prefix(scene.name);
    let wanted = |methods: Vec<Method>| -> Vec<Method> {
        let named = |method: &Method| options.wants_method(method.name);
        methods.into_iter().filter(named).collect()
    };
    let (smoothings, frames) = match scene.measures {
        Measures::Surface => (methods::smoothings(options.quick), Vec::new()),
        Measures::All => (
            methods::smoothings(options.quick),
            methods::frames(options.quick),
        ),
        Measures::Times => (Vec::new(), methods::frames(true)),
        Measures::Windows => ([false, true].map(methods::table).concat(), Vec::new()),
        Measures::Thickness => (Vec::new(), methods::thicknesses()),
        Measures::Edges => (Vec::new(), methods::antialiased()),
    };
    let (smoothings, frames) = (wanted(smoothings), wanted(frames));
    let mut rig = Rig::new(scene)?;
    if matches!(scene.measures, Measures::Surface | Measures::All) {
        errors(
            table,
            scene,
            (&smoothings, &frames),
            &mut rig,
            options,
            &progress,
        )?;
    }
    if scene.measures == Measures::Edges {
        return edges(table, scene, &frames, &mut rig, options, &progress);
    }
    if scene.measures == Measures::Thickness {
        media::measure_closed_form(table, scene);
        media::measure_thickness(table, scene, &frames, &mut rig)?;
    }
    // Of close-ups one size says enough of speed.
    if scene.measures != Measures::Surface || scene.name.ends_with("-6px") {
        progress.set_message("times");
        let turns = times::turns(&adapter_name(&rig.app), options.quick);
        let timed: Vec<Method> = smoothings.into_iter().chain(frames).collect();
        progress.set_position(0);
        progress.set_length(timed.len() as u64 * u64::from(turns + 1));
        times::measure(table, scene, &timed, &mut rig, turns, &progress)?;
    }
    progress.finish_with_message("done");
    Ok(())
}

/// How a method antialiases: at rest, and for a few in motion too, where ten times as many
/// pictures are drawn.
fn antialiasing(
    table: &mut Table,
    scene: &Scene,
    method: &Method,
    rig: &mut Rig,
    options: &Options,
) -> Result<Aliasing, ReportError> {
    let is_default = method.name == methods::DEFAULT;
    let moves = is_default || (!options.quick && methods::IN_MOTION.contains(&method.name));
    let aliasing = aliasing::measure(scene, method, rig, options, moves && !options.still)?;
    if is_default {
        aliasing.draw(scene, method, options.pictures())?;
    }
    let subject = Subject {
        scene,
        method: method.name,
        parameters: &method.parameters,
    };
    aliasing.write(table, subject);
    Ok(aliasing)
}

/// What antialiasing does, and pictures where their truth is known.
fn edges(
    table: &mut Table,
    scene: &Scene,
    frames: &[Method],
    rig: &mut Rig,
    options: &Options,
    progress: &ProgressBar,
) -> Result<(), ReportError> {
    progress.set_message("errors");
    progress.set_length(frames.len() as u64);
    let mut picture = None;
    for method in frames {
        let subject = Subject {
            scene,
            method: method.name,
            parameters: &method.parameters,
        };
        let aliasing = antialiasing(table, scene, method, rig, options)?;
        if let Some(exact) = scene.exact.as_deref() {
            let truth = picture.get_or_insert_with(|| {
                // The first method's parts of the picture for all.
                TruePicture::of(scene, &Truth::Exact(exact), aliasing.edges.named().to_vec())
            });
            pictures::measure(table, subject, truth, &aliasing.picture)?;
        }
        progress.inc(1);
    }
    progress.finish_with_message("done");
    Ok(())
}

/// Everything but the times.
fn errors(
    table: &mut Table,
    scene: &Scene,
    (smoothings, frames): (&[Method], &[Method]),
    rig: &mut Rig,
    options: &Options,
    progress: &ProgressBar,
) -> Result<(), ReportError> {
    progress.set_message("truth");
    let splats = Splats::of(scene)?;
    let truth = Truth::of(scene, &splats);
    let few = methods::smoothings(true);
    rig.show(&few[0])?;
    surfaces::measure_layers(table, scene, &splats, rig)?;
    let regions = surfaces::regions(scene, &truth, &rig.seen()?.bulk);

    progress.set_length((smoothings.len() + frames.len()) as u64);
    progress.set_message("errors");
    for method in smoothings {
        rig.show(method)?;
        surfaces::measure(table, scene, &truth, &regions, method, rig)?;
        // Of the grids of parameters it would take too long.
        if method.is_among(&few) {
            antialiasing(table, scene, method, rig, options)?;
        }
        progress.inc(1);
    }
    if frames.is_empty() {
        return Ok(());
    }
    let picture = TruePicture::of(scene, &truth, surfaces::named(&regions).to_vec());
    let model = TruePicture::of_model(scene, &picture);
    let antialiased = methods::antialiased();
    for method in frames {
        rig.show(method)?;
        let got = rig.picture()?;
        let subject = Subject {
            scene,
            method: method.name,
            parameters: &method.parameters,
        };
        for truth in [Some(&picture), model.as_ref()].into_iter().flatten() {
            pictures::measure(table, subject, truth, &got)?;
        }
        surfaces::measure(table, scene, &truth, &regions, method, rig)?;
        if method.is_among(&antialiased) {
            antialiasing(table, scene, method, rig, options)?;
        }
        progress.inc(1);
    }
    pictures::ablate(table, scene, &picture, rig)?;
    pictures::measure_furnace(table, scene, rig)?;
    searches::measure(table, scene, rig, options.quick)
}
