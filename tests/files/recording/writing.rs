//! A running app is recorded.

use std::{fs, iter, path::Path, sync::mpsc};

use bevy::{prelude::*, tasks::IoTaskPool};
use bevy_fluid::{
    prelude::{FluidParticles, FluidSystems},
    recording::{FluidRecording, ParticleFrame, RecordingPlayer, RecordingWriter, WrittenFrames},
};

use super::{app, folder, log, play, seek, set_time_step, wait, x};

/// One particle, whose x is the app's time.
fn recorded(folder: &Path, writer: RecordingWriter, step: f64) -> (App, Entity) {
    let mut app = app(folder);
    set_time_step(&mut app, step);
    app.add_systems(
        PostUpdate,
        (|mut fluids: Query<&mut FluidParticles, With<RecordingWriter>>,
          mut age: Local<f32>,
          time: Res<Time>| {
            for mut fluid in &mut fluids {
                fluid.positions[0].x = *age;
                *age += time.delta_secs();
            }
        })
        .in_set(FluidSystems::Simulate),
    );
    // The clock's first step is none.
    app.update();
    let fluid = FluidParticles::new(vec![Vec3::ZERO], 0.05);
    let entity = app.world_mut().spawn((fluid, writer)).id();
    (app, entity)
}

fn written(app: &mut App, entity: Entity) -> Mut<'_, WrittenFrames> {
    app.world_mut().get_mut(entity).unwrap()
}

fn writer(folder: &Path, name: &str) -> RecordingWriter {
    RecordingWriter::new(folder.join(name).to_str().unwrap())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let name = |entry: fs::DirEntry| entry.file_name().to_str().unwrap().to_owned();
    let mut names: Vec<_> = entries.map(|entry| name(entry.unwrap())).collect();
    names.sort();
    names
}

/// Threads that are all busy are as slow as a disk can be, until what is returned is dropped.
fn slow_disk() -> Vec<mpsc::Sender<()>> {
    let pool = IoTaskPool::get();
    let block = |_| {
        let (sender, busy) = mpsc::channel::<()>();
        pool.spawn(async move {
            let _ = busy.recv();
        })
        .detach();
        sender
    };
    (0..pool.thread_num()).map(block).collect()
}

#[test]
fn what_is_recorded_can_be_played() {
    let folder = folder("recorded");
    for extension in ["vtk", "bgeo", "ply", "xyz"] {
        let made = folder.join(extension).join("made");
        let writer = RecordingWriter {
            rate: 20.0,
            queue: 100,
            ..writer(&made, &format!("age_###.{extension}"))
        };
        let (mut app, entity) = recorded(&folder, writer, 0.01);
        app.world_mut().entity_mut(entity).insert(FluidParticles {
            ids: vec![5],
            velocities: vec![Vec3::X],
            ..FluidParticles::new(vec![Vec3::ZERO], 0.05)
        });
        for _ in 0..21 {
            app.update();
        }
        written(&mut app, entity).finish();
        assert_eq!(written(&mut app, entity).written(), 5);
        assert_eq!(written(&mut app, entity).error(), None);
        let frames = (0..5).map(|n| format!("age_00{n}.{extension}"));
        let all: Vec<_> = iter::once("age.fluid.ron".into()).chain(frames).collect();
        assert_eq!(names(&made), all);
        for number in 0..5 {
            let path = made.join(format!("age_00{number}.{extension}"));
            let frame = ParticleFrame::read(&path).unwrap();
            let age = 0.05 * number as f32;
            assert!((frame.positions[0].x - age).abs() < 1e-5);
            let has_attributes = extension != "xyz";
            assert_eq!(frame.ids.contains(&5), has_attributes);
            assert_eq!(frame.velocities.contains(&Vec3::X), has_attributes);
            assert_eq!(frame.radius.is_some(), has_attributes);
        }
        // By its description, in the app's assets.
        let path = format!("{extension}/made/age.fluid.ron");
        let recording: Handle<FluidRecording> = app.world().resource::<AssetServer>().load(path);
        app.world_mut().despawn(entity);
        let player = play(
            &mut app,
            RecordingPlayer {
                paused: true,
                ..RecordingPlayer::new(recording)
            },
        );
        for (time, interpolated, nearest) in [(0.0, 0.0, 0.0), (0.12, 0.12, 0.1), (0.19, 0.19, 0.2)]
        {
            seek(&mut app, player, time);
            let expected = if extension == "xyz" {
                nearest
            } else {
                interpolated
            };
            assert!(
                (x(&app, player) - expected).abs() < 1e-5,
                "{extension} at {time}"
            );
        }
        assert_eq!(super::particles(&app, player).radius, 0.05);
    }
}

#[test]
fn an_app_slower_than_the_recording_leaves_numbers_out() {
    let folder = folder("slow_app");
    let writer = RecordingWriter {
        rate: 30.0,
        queue: 100,
        ..writer(&folder, "age_#.xyz")
    };
    let (mut app, entity) = recorded(&folder, writer, 0.1);
    for _ in 0..4 {
        app.update();
    }
    written(&mut app, entity).finish();
    let expected = [
        "age.fluid.ron",
        "age_0.xyz",
        "age_3.xyz",
        "age_6.xyz",
        "age_9.xyz",
    ];
    assert_eq!(names(&folder), expected);
    let frame = ParticleFrame::read(&folder.join("age_6.xyz")).unwrap();
    assert!(
        (frame.positions[0].x - 0.2).abs() < 1e-5,
        "numbers keep their time"
    );

    let mut writer = app.world_mut().get_mut::<RecordingWriter>(entity).unwrap();
    writer.paused = true;
    for _ in 0..4 {
        app.update();
    }
    written(&mut app, entity).finish();
    assert_eq!(names(&folder), expected);
}

#[test]
fn what_cannot_be_written_is_said_once() {
    let folder = folder("unwritable");
    fs::write(folder.join("file"), b"").unwrap();
    for (name, part) in [
        ("file/age_#.xyz", "unwritable/file"),
        ("age_without_number.xyz", "age_without_number.xyz"),
        ("age_#.doc", "age_#.doc"),
    ] {
        // So that nothing is said of a slow machine.
        let patient = RecordingWriter {
            queue: 1000,
            ..writer(&folder, name)
        };
        let (mut app, entity) = recorded(&folder, patient, 0.1);
        wait(&mut app, |world| {
            world
                .get::<WrittenFrames>(entity)
                .unwrap()
                .error()
                .is_some()
        });
        for _ in 0..20 {
            app.update();
        }
        written(&mut app, entity).finish();
        assert_eq!(log::count(part), 1, "{part}");
        assert_eq!(written(&mut app, entity).written(), 0);

        // Mended, it starts.
        let mended = folder.join("mended").join("age_#.xyz");
        let mut writer = app.world_mut().get_mut::<RecordingWriter>(entity).unwrap();
        writer.frames = mended.to_str().unwrap().into();
        app.update();
        written(&mut app, entity).finish();
        assert_eq!(written(&mut app, entity).written(), 1);
    }
    assert_eq!(names(&folder), ["file", "mended"]);
}

#[test]
fn rates_out_of_range_are_said_once_and_clamped() {
    let folder = folder("rates");
    // Frames in two seconds at the nearest valid rate, for updates of 0.1 s.
    for (rate, frames) in [(0.0, 1), (-1.0, 1), (f32::NAN, 21), (f32::INFINITY, 21)] {
        let writer = RecordingWriter {
            rate,
            queue: 1000,
            ..writer(&folder, &format!("rate_{rate}_#.xyz"))
        };
        let (mut app, entity) = recorded(&folder, writer, 0.1);
        for _ in 0..21 {
            app.update();
        }
        written(&mut app, entity).finish();
        let written = written(&mut app, entity);
        assert_eq!((written.written(), written.error()), (frames, None));
        let line = format!("entity {entity}: `RecordingWriter::rate` is {rate};");
        assert_eq!(log::count(&line), 1, "{line}");
    }
}

#[test]
fn frames_that_would_wait_too_long_are_left_out() {
    let folder = folder("slow_disk");
    let writer = RecordingWriter {
        rate: 10.0,
        queue: 2,
        ..writer(&folder, "age_#.xyz")
    };
    let (mut app, entity) = recorded(&folder, writer, 0.1);
    let release = slow_disk();
    for _ in 0..6 {
        app.update();
    }
    assert_eq!(written(&mut app, entity).waiting(), 2);
    assert_eq!(written(&mut app, entity).dropped(), 4);
    drop(release);
    written(&mut app, entity).finish();
    app.update();
    written(&mut app, entity).finish();
    assert_eq!(
        names(&folder),
        ["age.fluid.ron", "age_0.xyz", "age_1.xyz", "age_6.xyz"]
    );
    assert_eq!(log::count("slow_disk/age_#.xyz is written too slowly"), 1);
}

#[test]
fn another_pattern_is_described_even_where_its_first_frame_is_left_out() {
    let folder = folder("other_pattern");
    let first = RecordingWriter {
        rate: 10.0,
        queue: 1,
        ..writer(&folder, "one_#.xyz")
    };
    let (mut app, entity) = recorded(&folder, first, 0.1);
    let release = slow_disk();
    app.update();
    let mut changed = app.world_mut().get_mut::<RecordingWriter>(entity).unwrap();
    changed.frames = writer(&folder, "other_#.xyz").frames;
    app.update();
    assert_eq!(written(&mut app, entity).dropped(), 1);
    drop(release);
    written(&mut app, entity).finish();
    assert_eq!(
        written(&mut app, entity).written(),
        0,
        "only the other's count"
    );
    app.update();
    written(&mut app, entity).finish();
    assert_eq!(written(&mut app, entity).written(), 1);
    let expected = [
        "one.fluid.ron",
        "one_0.xyz",
        "other.fluid.ron",
        "other_1.xyz",
    ];
    assert_eq!(names(&folder), expected);
}

#[test]
fn what_waits_is_written_when_the_fluid_goes() {
    let folder = folder("despawned");
    let (mut app, entity) = recorded(&folder, writer(&folder, "age_#.xyz"), 0.1);
    app.update();
    app.world_mut().despawn(entity);
    let last = folder.join("age.fluid.ron");
    wait(&mut app, |_| last.exists());
    assert_eq!(names(&folder), ["age.fluid.ron", "age_0.xyz"]);
}
