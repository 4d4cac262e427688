//! `App::run` without a window: a picture, or one line on why there is none.

use std::{env, fs, num::NonZeroU8, path::Path, process::Command, time::Duration};

use bevy::prelude::*;
use fluid_stage::{StageError, StagePlugins, headless_app};

#[derive(Resource, Clone, Default)]
struct Ticks(std::sync::Arc<std::sync::Mutex<Vec<Duration>>>);

fn run(out: &Path) -> (AppExit, Vec<Duration>) {
    let ticks = Ticks::default();
    let exit = App::new()
        .add_plugins(StagePlugins {
            out: Some(out.into()),
            size: UVec2::new(32, 16),
            frames: 3,
            ..default()
        })
        .insert_resource(ticks.clone())
        .add_systems(Startup, |mut commands: Commands| {
            commands.spawn(Camera3d::default());
        })
        .add_systems(Update, |time: Res<Time>, ticks: Res<Ticks>| {
            ticks.0.lock().unwrap().push(time.delta());
        })
        .run();
    let ticks = ticks.0.lock().unwrap().clone();
    (exit, ticks)
}

#[test]
fn a_run_steps_its_frames_and_leaves_only_the_picture() {
    let folder = env::temp_dir().join(format!("fluid_stage_{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (exit, ticks) = run(&folder.join("a.png"));
    let files: Vec<_> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    let size = image::image_dimensions(folder.join("a.png")).unwrap();
    fs::remove_dir_all(&folder).unwrap();

    assert_eq!(exit, AppExit::Success);
    assert_eq!(files, ["a.png"]);
    assert_eq!(size, (32, 16));
    let moved: Vec<_> = ticks.iter().filter(|tick| !tick.is_zero()).collect();
    assert_eq!(moved, [&StagePlugins::default().time_step; 3]);
}

#[test]
fn an_unwritable_place_ends_the_run_before_it_starts() {
    let (exit, ticks) = run(Path::new("/no/such/folder/a.png"));
    assert_eq!(exit, AppExit::Error(NonZeroU8::new(2).unwrap()));
    assert!(ticks.is_empty());
}

/// In a process of its own, for the environment is everybody's.
#[test]
#[cfg(target_os = "linux")]
fn a_machine_without_a_driver_is_told_what_to_install() {
    let status = Command::new(env::current_exe().unwrap())
        .args(["--ignored", "--exact", "picture::without_a_driver"])
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .status()
        .unwrap();
    assert!(status.success());
}

#[test]
#[ignore = "run by the test above"]
fn without_a_driver() {
    let Err(error @ StageError::NoAdapter) = headless_app(UVec2::ONE, |_| {}) else {
        panic!("an adapter without a driver");
    };
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("mesa-vulkan-drivers"));
}
