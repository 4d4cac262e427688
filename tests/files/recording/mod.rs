//! Recordings: files as assets, sequences, playing, writing.

mod background;
mod files;
mod formats;
mod gates;
mod interpolation;
mod sources;
mod time;
mod writing;

use std::{
    fs,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use bevy::{prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{
    prelude::FluidParticles,
    recording::{
        FluidRecording, LoadedFrames, ParticleFrame, RecordingPlayer, RecordingPlugin,
        RecordingSettings,
    },
};
use fluid_stage::log;

/// For what happens in the background of a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A folder of its own for a test, empty.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("recording")
        .join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// An app whose assets are in `folder`, and whose clock stands still.
fn app(folder: &Path) -> App {
    log::listen();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        AssetPlugin {
            file_path: folder.to_str().unwrap().into(),
            ..default()
        },
        RecordingPlugin,
    ));
    stop_clock(&mut app);
    app
}

/// Until [`set_time_step`], of any length.
fn stop_clock(app: &mut App) {
    let mut clock = app.world_mut().resource_mut::<Time<Virtual>>();
    clock.set_max_delta(Duration::from_secs(1000));
    set_time_step(app, 0.0);
}

fn set_time_step(app: &mut App, seconds: f64) {
    let step = Duration::from_secs_f64(seconds);
    app.insert_resource(TimeUpdateStrategy::ManualDuration(step));
}

/// One particle at `x`, and nothing else known of it.
fn dot(x: f32) -> ParticleFrame {
    ParticleFrame {
        positions: vec![Vec3::X * x],
        ..default()
    }
}

/// Frames of one dot each, whose x is its number.
fn write_dots(folder: &Path, numbers: impl IntoIterator<Item = u32>) {
    for number in numbers {
        let path = folder.join(format!("dot_{number}.xyz"));
        dot(number as f32).write(&path).unwrap();
    }
}

fn open(app: &App, settings: impl Into<RecordingSettings>) -> Handle<FluidRecording> {
    FluidRecording::load(app.world().resource::<AssetServer>(), settings)
}

/// One frame a second, so that times are numbers.
fn slowly(frames: &str) -> RecordingSettings {
    RecordingSettings {
        rate: 1.0,
        ..frames.into()
    }
}

/// Updates until something has happened.
#[track_caller]
fn wait(app: &mut App, happened: impl Fn(&World) -> bool) {
    let began = Instant::now();
    while !happened(app.world()) {
        assert!(began.elapsed() < PATIENCE, "it does not happen");
        thread::sleep(Duration::from_millis(1));
        app.update();
    }
}

/// A player, once it shows its first frame.
#[track_caller]
fn play(app: &mut App, player: RecordingPlayer) -> Entity {
    let entity = app.world_mut().spawn(player).id();
    wait(app, |world| frames(world, entity).shown().is_some());
    entity
}

fn frames(world: &World, entity: Entity) -> &LoadedFrames {
    world.get(entity).unwrap()
}

fn particles(app: &App, entity: Entity) -> &FluidParticles {
    app.world().get(entity).unwrap()
}

/// The x of the only particle.
#[track_caller]
fn x(app: &App, entity: Entity) -> f32 {
    let [position] = particles(app, entity).positions[..] else {
        panic!("not one particle");
    };
    position.x
}

fn player(app: &mut App, entity: Entity) -> Mut<'_, RecordingPlayer> {
    app.world_mut().get_mut(entity).unwrap()
}

/// Goes to a time and waits until it is shown.
#[track_caller]
fn seek(app: &mut App, entity: Entity, time: f64) {
    player(app, entity).seek(time);
    app.update();
    wait(app, |world| !frames(world, entity).is_waiting());
}
