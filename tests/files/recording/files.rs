//! Files and what they are called.

use std::fs;

use bevy::{asset::LoadState, prelude::*};
use bevy_fluid::recording::{
    FluidRecording, ParticleFormat, ParticleFrame, RecordingPlayer, RecordingSettings,
};

use super::{app, dot, folder, log, open, play, slowly, wait, write_dots};

/// Everything that a file can hold, with ids that need all of their bits.
fn full() -> ParticleFrame {
    let index = |i: i32| vec3(i as f32, -0.25 * i as f32, 1e-3 * (i * i) as f32);
    ParticleFrame {
        positions: (0..50).map(index).collect(),
        ids: (0..50).map(|i| u32::MAX - 7 * i).collect(),
        velocities: (0..50).map(|i| index(50 - i)).collect(),
        radius: Some(0.025),
    }
}

#[test]
fn what_is_written_is_read_back() {
    let folder = folder("round_trip");
    let zipped = ["vtk.gz", "bgeo.gz", "ply.gz", "xyz.gz"];
    let extensions = ParticleFormat::EXTENSIONS.into_iter().chain(zipped);
    for extension in extensions.clone() {
        let path = folder.join("frame").with_extension(extension);
        for mut frame in [full(), dot(3.0), ParticleFrame::default()] {
            if extension.starts_with("xyz") {
                frame = ParticleFrame {
                    positions: frame.positions,
                    ..default()
                };
            }
            frame.write(&path).unwrap();
            let back = ParticleFrame::read(&path).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(back, frame, "{extension}");
        }
        let is_zipped = fs::read(&path).unwrap().starts_with(b"\x1f\x8b");
        assert_eq!(is_zipped, extension.ends_with(".gz"), "{extension}");
    }
    let files = fs::read_dir(&folder).unwrap().count();
    assert_eq!(files, extensions.count(), "no leftovers");
}

#[test]
fn every_format_is_an_asset() {
    let folder = folder("assets");
    let mut app = app(&folder);
    for extension in ParticleFormat::EXTENSIONS
        .into_iter()
        .chain(["bgeo.gz", "PLY"])
    {
        let name = format!("frame.{extension}");
        full().write(&folder.join(&name)).unwrap();
        let handle = app.world().resource::<AssetServer>().load(&name);
        let loaded = |world: &World| {
            world
                .resource::<Assets<ParticleFrame>>()
                .get(&handle)
                .cloned()
        };
        wait(&mut app, |world| loaded(world).is_some());
        let frame = loaded(app.world()).unwrap();
        assert_eq!(frame.positions, full().positions, "{name}");
        let has_ids = extension != "xyz";
        assert_eq!(frame.ids.len(), if has_ids { 50 } else { 0 }, "{name}");
    }
}

#[test]
fn attributes_of_other_tools_are_found() {
    let text = "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n\
                property double z\nproperty int particle_id\nproperty float pscale\nend_header\n\
                1 2 3 8 0.5\n4 5 6 9 0.25\n";
    let frame = ParticleFrame::parse("a.ply", text.as_bytes()).unwrap();
    assert_eq!(frame.positions, [vec3(1.0, 2.0, 3.0), vec3(4.0, 5.0, 6.0)]);
    assert_eq!(frame.ids, [8, 9]);
    assert_eq!(frame.radius, Some(0.375), "the mean");

    let text = "# vtk DataFile Version 4.1\nparticles\nASCII\nDATASET POLYDATA\nPOINTS 2 double\n\
                1 2 3 4 5 6\nPOINT_DATA 2\nFIELD attributes 2\nids 1 2 long\n8 9\n\
                velocities 3 2 float\n0 1 0 0 2 0\n";
    let frame = ParticleFrame::parse("a.vtk", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(frame.positions.len(), 2);
    assert_eq!(frame.ids, [8, 9]);
    assert_eq!(frame.velocities, [Vec3::Y, 2.0 * Vec3::Y]);
}

#[test]
fn ids_that_are_none_count_as_none() {
    for (id, known) in [
        ("7", true),
        ("-1", false),
        ("0.5", false),
        ("5000000000.0", false),
    ] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
             property float z\nproperty double id\nend_header\n1 2 3 {id}\n"
        );
        let frame = ParticleFrame::parse("a.ply", text.as_bytes()).unwrap();
        assert_eq!(frame.ids.len(), usize::from(known), "{id}");
    }
}

#[test]
fn frames_come_by_number_and_from_anywhere() {
    let folder = folder("order");
    write_dots(&folder, [10, 9, 0, 100]);
    fs::write(folder.join("dot_x.xyz"), b"").unwrap();
    fs::write(folder.join("note_1.xyz"), b"").unwrap();
    let mut app = app(&folder);
    let absolute = folder.join("dot_####.xyz");
    for (settings, expected) in [
        ("dot_#.xyz".into(), vec![0, 9, 10, 100]),
        (absolute.to_str().unwrap().into(), vec![0, 9, 10, 100]),
        ("dot_9.xyz".into(), vec![0]),
        (
            RecordingSettings {
                first: Some(1),
                ..RecordingSettings::from("dot_{}.xyz")
            },
            vec![9, 10, 100],
        ),
        (
            RecordingSettings {
                first: Some(8),
                last: Some(10),
                ..RecordingSettings::from("dot_#.xyz")
            },
            vec![8, 9, 10],
        ),
    ] {
        let handle = open(&app, settings);
        let found = |world: &World| {
            let recording = world.resource::<Assets<FluidRecording>>().get(&handle)?;
            Some(recording.numbers().collect::<Vec<_>>())
        };
        wait(&mut app, |world| found(world).is_some());
        assert_eq!(found(app.world()), Some(expected));
    }
}

#[test]
fn a_description_is_an_asset() {
    let folder = folder("description");
    fs::create_dir(folder.join("frames")).unwrap();
    write_dots(&folder.join("frames"), 0..3);
    let text = "(frames: \"frames/dot_#.xyz\", rate: 24, radius: 0.5)";
    fs::write(folder.join("dots.fluid.ron"), text).unwrap();
    let mut app = app(&folder);
    let handle = app.world().resource::<AssetServer>().load("dots.fluid.ron");
    let entity = play(&mut app, RecordingPlayer::new(handle.clone()));
    let recording = app
        .world()
        .resource::<Assets<FluidRecording>>()
        .get(&handle);
    assert_eq!(recording.map(FluidRecording::rate), Some(24.0));
    assert_eq!(super::particles(&app, entity).radius, 0.5);
}

#[test]
fn what_is_no_recording_is_named() {
    let folder = folder("none");
    let description = |name: &str, text: &str| {
        fs::write(folder.join(name), text).unwrap();
    };
    description("odd.fluid.ron", "(frames: \"odd_#.xyz\", speed: 3)");
    description("stopped.fluid.ron", "(frames: \"stopped_#.xyz\", rate: 0)");
    write_dots(&folder, [1]);
    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();
    for (handle, name) in [
        (open(&app, "absent_#.xyz"), "absent_#.xyz"),
        (open(&app, "nowhere/dot_#.xyz"), "nowhere"),
        (open(&app, "dot_#_#.xyz"), "dot_#_#.xyz"),
        (open(&app, "dot_#.txt"), "dot_#.txt"),
        (
            open(
                &app,
                RecordingSettings {
                    first: Some(0),
                    last: Some(u32::MAX),
                    ..slowly("endless_#.xyz")
                },
            ),
            "endless_#.xyz",
        ),
        (server.load("odd.fluid.ron"), "odd.fluid.ron"),
        (server.load("stopped.fluid.ron"), "stopped_#.xyz"),
    ] {
        let state = |world: &World| world.resource::<AssetServer>().load_state(&handle);
        wait(&mut app, |world| state(world).is_failed());
        let LoadState::Failed(error) = state(app.world()) else {
            panic!("{name} is found");
        };
        assert!(error.to_string().contains(name), "{error}");
        // It is said on another thread, after that.
        wait(&mut app, |_| log::count(name) > 0);
    }
}
