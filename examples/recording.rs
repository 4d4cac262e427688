//! Records a breaking dam to numbered files, then plays them at twelve frames per second,
//! interpolating every particle by its id.
//!
//! ```text
//! cargo run --release --features recordings --example recording
//! cargo run --release --features recordings --example recording -- --file 'frames/dam_####.vtk'
//! ```
//! `--file` plays recordings of your own. Space pauses, left and right seek, B reverses time; the
//! mouse turns the camera. `--out FILE.png --time SECONDS [--frames N]` writes a picture instead.
//! Try `--no-interpolation`, `--speed 0.2`.

mod simulation;

use std::{
    env,
    path::{Path, PathBuf},
    process::ExitCode,
    time::Duration,
};

use anyhow::{bail, ensure};
use bevy::{
    asset::LoadState,
    math::bounding::{Aabb3d, BoundingVolume},
    prelude::*,
    time::TimeUpdateStrategy,
};
use bevy_fluid::{
    prelude::*,
    recording::{
        FluidRecording, FramePattern, Interpolation, LoadedFrames, RecordingPlayer,
        RecordingPlugin, RecordingSettings, RecordingWriter, WrittenFrames,
    },
};
use clap::Parser;
use fluid_stage::{
    PendingPicture, StagePlugins, VIEW_SIZE, capture, dam, headless_app, parse_args,
    scenery::{Scenery, frame_camera, orbit_camera},
    set_time_step, settle, step,
};

use simulation::Simulation;

/// Inside of the tank, m.
const TANK: Vec3 = vec3(1.6, 0.9, 0.7);
/// The dam at its left wall, m.
const DAM: Vec2 = vec2(0.6, 0.7);
/// Particle radius of the dam, m: about 4,600 particles.
const RADIUS: f32 = 0.02;
/// Recorded frames of the dam per second: too few to look smooth without interpolation.
const RATE: f32 = 12.0;
/// How long the dam is recorded, s.
const SECONDS: f32 = 2.5;
/// Time step of the simulation and of a picture's frames, s.
const STEP: f32 = 1.0 / 60.0;
const TO_SUN: Vec3 = vec3(0.55, 0.9, 0.45);

/// Records a breaking dam and plays it, or plays another recording.
#[derive(Parser, Resource, Clone, Debug)]
#[command(name = "recording")]
struct Args {
    /// The recording to play: one file, or numbered files as in 'frames/dam_####.vtk'
    #[arg(long)]
    file: Option<String>,
    /// Recorded frames per second of FILE
    #[arg(long, default_value = "30")]
    rate: f64,
    /// Particle radius if FILE does not hold it
    #[arg(long, default_value = "0.025")]
    radius: f32,
    /// Folder for the recording of the dam; a temporary folder if not given
    #[arg(long)]
    folder: Option<PathBuf>,
    /// Playback speed; negative is backwards
    #[arg(long, default_value = "1", allow_hyphen_values = true)]
    speed: f32,
    /// Show the frames without interpolation
    #[arg(long)]
    no_interpolation: bool,
    /// Write a picture (PNG) instead of opening a window
    #[arg(long)]
    out: Option<PathBuf>,
    /// Time in seconds that the picture shows, or from which its frames are played
    #[arg(long, default_value = "0.7")]
    time: f64,
    /// Frames of 1/60 s that are played before the picture is taken
    #[arg(long, default_value = "0")]
    frames: u32,
    /// Width and height in pixels
    #[arg(long, default_value = "1280x720", value_parser = size)]
    size: UVec2,
    /// Whether the dam is played.
    #[arg(skip)]
    is_dam: bool,
}

fn main() -> ExitCode {
    let args: Args = parse_args();
    run(args).unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::from(2)
    })
}

fn run(mut args: Args) -> anyhow::Result<ExitCode> {
    let picture = args.out.clone();
    let picture = picture.as_deref().map(PendingPicture::create).transpose()?;
    match &args.file {
        Some(file) => {
            FramePattern::parse(file)?;
            // Relative to the working folder, not to the assets.
            args.file = Some(env::current_dir()?.join(file).display().to_string());
        }
        None => {
            let folder = args.folder.clone();
            let folder = folder.unwrap_or_else(|| env::temp_dir().join("bevy_fluid_recording"));
            args.file = Some(record_dam(&std::path::absolute(folder)?)?);
            args.rate = RATE.into();
            args.is_dam = true;
        }
    }
    let (size, time, frames) = (args.size, args.time, args.frames);
    let configure = move |app: &mut App| {
        app.add_plugins(FluidPlugins)
            .insert_resource(args)
            .add_systems(Startup, open)
            .add_systems(Update, (build_scene, control));
    };
    let Some(picture) = picture else {
        let mut app = App::new();
        app.add_plugins(StagePlugins {
            size,
            title: "recording · bevy_fluid".into(),
            ..default()
        });
        configure(&mut app);
        return Ok(match app.run() {
            AppExit::Success => ExitCode::SUCCESS,
            AppExit::Error(code) => ExitCode::from(code.get()),
        });
    };
    let mut app = headless_app(size, configure)?;
    settle(&mut app)?;
    let mut players = app.world_mut().query::<&mut RecordingPlayer>();
    for mut player in players.iter_mut(app.world_mut()) {
        player.seek(time);
    }
    wait_for_frames(&mut app)?;
    // The scene is built from the first loaded frame.
    settle(&mut app)?;
    for _ in 0..frames {
        set_time_step(&mut app, Duration::from_secs_f32(STEP));
        step(&mut app, 1);
        set_time_step(&mut app, Duration::ZERO);
        wait_for_frames(&mut app)?;
    }
    picture.commit(capture(&mut app)?)?;
    Ok(ExitCode::SUCCESS)
}

/// A picture must not depend on how fast files are read.
fn wait_for_frames(app: &mut App) -> anyhow::Result<()> {
    loop {
        step(app, 1);
        let mut players = app.world_mut().query::<(&RecordingPlayer, &LoadedFrames)>();
        let (player, frames) = players.single(app.world())?;
        let server = app.world().resource::<AssetServer>();
        if let LoadState::Failed(error) = server.load_state(&player.recording) {
            bail!("{error}");
        }
        if frames.shown().is_some() && !frames.is_waiting() {
            return Ok(());
        }
        let recordings = app.world().resource::<Assets<FluidRecording>>();
        let is_open = recordings.contains(&player.recording);
        ensure!(
            !is_open || frames.is_waiting(),
            "no frame of the recording can be played"
        );
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Simulates and records without a window or a renderer; returns the pattern of the files.
fn record_dam(folder: &Path) -> anyhow::Result<String> {
    let frames = folder.join("dam_####.vtk").display().to_string();
    println!("recording {frames}");
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), RecordingPlugin))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
            STEP,
        )))
        .insert_resource(Simulation::new(
            TANK,
            RADIUS,
            dam(TANK, DAM, RADIUS),
            Vec::new(),
        ))
        .add_systems(PostUpdate, simulate.in_set(FluidSystems::Simulate));
    let positions = app.world().resource::<Simulation>().positions();
    let writer = RecordingWriter {
        rate: RATE,
        // Nothing waits for these frames, but none may be lost.
        queue: usize::MAX,
        ..RecordingWriter::new(frames.clone())
    };
    let fluid = FluidParticles {
        ids: (0..positions.len() as u32).collect(),
        ..FluidParticles::new(positions, RADIUS)
    };
    let fluid = app.world_mut().spawn((fluid, writer)).id();
    for _ in 0..(SECONDS / STEP) as u32 {
        app.update();
    }
    if let Some(mut written) = app.world_mut().get_mut::<WrittenFrames>(fluid) {
        written.finish();
        if let Some(error) = written.error() {
            bail!("{error}");
        }
        println!("{} frames", written.written());
    }
    Ok(frames)
}

fn simulate(mut water: ResMut<Simulation>, mut fluids: Query<&mut FluidParticles>) {
    water.step(STEP);
    for mut fluid in &mut fluids {
        let moved = water.positions();
        let ways = moved.iter().zip(&fluid.positions);
        fluid.velocities = ways.map(|(to, from)| (to - from) / STEP).collect();
        fluid.positions = moved;
    }
}

fn open(mut commands: Commands, args: Res<Args>, assets: Res<AssetServer>) {
    let settings = RecordingSettings {
        rate: args.rate,
        radius: Some(args.radius),
        ..args.file.as_deref().unwrap_or_default().into()
    };
    commands.spawn((
        RecordingPlayer {
            rate: args.speed,
            interpolation: if args.no_interpolation {
                Interpolation::None
            } else {
                Interpolation::Velocity
            },
            ..RecordingPlayer::new(FluidRecording::load(&assets, settings)).repeating()
        },
        FluidMaterial {
            // A lake's water, so that depth shows in a tank.
            medium: Medium::absorbing(LinearRgba::rgb(0.2, 0.65, 0.75), 1.0),
            ..FluidMaterial::WATER
        },
    ));
}

/// Builds the scene once there are particles, whose bounds set its size.
fn build_scene(
    mut scenery: Scenery,
    args: Res<Args>,
    fluid: Single<&FluidParticles>,
    mut is_built: Local<bool>,
) {
    let points = fluid.positions.iter().filter(|p| p.is_finite());
    let (low, high) = points.fold((Vec3::MAX, Vec3::MIN), |(low, high), &p| {
        (low.min(p), high.max(p))
    });
    if *is_built || !low.cmple(high).all() {
        return;
    }
    *is_built = true;
    let inside = if args.is_dam {
        Aabb3d::new(Vec3::Y * 0.5 * TANK.y, 0.5 * TANK)
    } else {
        Aabb3d::new(0.5 * (low + high), 0.5 * (high - low) + fluid.radius)
    };
    let reach = 4.0 * Vec3::from(inside.half_size()).max_element();
    let ground = Vec3::from(inside.center()).with_y(inside.min.y);
    scenery.checker_floor(ground, reach, 24);
    scenery.pillars(inside, 6);
    if args.is_dam {
        scenery.tank(inside);
    }
    scenery.sun(TO_SUN, reach, true);
    let sky = scenery.sky(TO_SUN);
    let aspect = args.size.x as f32 / args.size.y as f32;
    let (eye, target) = frame_camera(inside, 0.7, aspect);
    scenery.commands.spawn((
        orbit_camera(eye, target),
        Projection::Perspective(PerspectiveProjection {
            fov: 0.7,
            near: 0.01 * reach,
            far: 20.0 * reach,
            ..default()
        }),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
}

fn control(mut player: Single<&mut RecordingPlayer>, keys: Option<Res<ButtonInput<KeyCode>>>) {
    let Some(keys) = keys else {
        return;
    };
    if keys.just_pressed(KeyCode::Space) {
        player.paused = !player.paused;
    }
    if keys.just_pressed(KeyCode::KeyB) {
        player.rate = -player.rate;
    }
    for (key, seconds) in [(KeyCode::ArrowLeft, -0.25), (KeyCode::ArrowRight, 0.25)] {
        if keys.just_pressed(key) {
            player.time += seconds;
        }
    }
}

fn size(text: &str) -> Result<UVec2, String> {
    let side = |word: &str| word.parse().ok().filter(|side| (1..=8192).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some(uvec2(side(width)?, side(height)?)))
        .ok_or_else(|| format!("not WIDTHxHEIGHT, as in {}x{}", VIEW_SIZE.x, VIEW_SIZE.y))
}
