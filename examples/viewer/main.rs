//! Draws the particles of any file (`.vtk`, `.bgeo`, `.ply`, `.xyz`) as a liquid over a checkered
//! floor with coloured pillars behind it: in a window, or with `--out FILE.png` as a picture.
//!
//! ```text
//! cargo run --release --features recordings --example viewer -- FILE --radius 0.025 --out picture.png
//! ```
//! Try `--debug-view normals`, `--smoothing none`, `--refractions 1`, `--isotropic`.

mod args;
mod scene;
mod stats;
mod strip;

use std::process::ExitCode;

use anyhow::{anyhow, ensure};
use bevy::prelude::*;
use bevy_fluid::recording::ParticleFrame;
use fluid_stage::{PendingPicture, StagePlugins, headless_app, parse_args, set_time_step, settle};

use crate::{args::Args, scene::ScenePlugin};

fn main() -> ExitCode {
    let args = parse_args::<Args>();
    match run(&args) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(args: &Args) -> anyhow::Result<ExitCode> {
    let positions = ParticleFrame::read(&args.file)?.positions;
    ensure!(
        !positions.is_empty(),
        "{} is empty: it holds no particles",
        args.file.display()
    );
    let scene = ScenePlugin::new(args, positions);
    if args.out.is_none() && args.stats.is_none() {
        let stage = StagePlugins {
            size: args.size,
            title: format!("{} · bevy_fluid", args.file.display()),
            ..default()
        };
        let exit = App::new().add_plugins((stage, scene)).run();
        return Ok(match exit {
            AppExit::Success => ExitCode::SUCCESS,
            AppExit::Error(code) => ExitCode::from(code.get()),
        });
    }
    // Before anything is drawn, so that a path that cannot be written to costs nothing.
    let picture = args
        .out
        .as_deref()
        .map(PendingPicture::create)
        .transpose()?;
    let stats_file = args
        .stats
        .as_deref()
        .map(stats::check_writable)
        .transpose()?;
    let mut app = headless_app(args.size, |app| {
        app.add_plugins(scene);
    })?;
    settle(&mut app)?;
    set_time_step(&mut app, std::time::Duration::from_secs_f64(1.0 / 60.0));
    let shape_times = stats::step(&mut app, args.frames, stats_file.is_some());
    if let Some(picture) = picture {
        picture.commit(strip::capture_orbit(&mut app, args.orbit)?)?;
    }
    if let Some(path) = stats_file {
        let stats = stats::gather(&app, &shape_times)?;
        std::fs::write(path, stats)
            .map_err(|error| anyhow!("cannot write {}: {error}", path.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}
