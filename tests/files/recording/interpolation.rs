//! What is shown between frames, against closed forms.

use bevy::prelude::*;
use bevy_fluid::recording::{Interpolation, ParticleFrame, RecordingPlayer, RecordingSettings};

use super::{app, folder, open, particles, play, player, seek, slowly, write_dots, x};

/// Cubics: what the Hermite form reproduces.
fn position(id: u32, t: f32) -> Vec3 {
    let k = id as f32;
    vec3(k, 0.1 * k - t, 0.5) + t * vec3(0.5, k, -1.0) + t * t * vec3(0.2, -0.5, 0.1)
        - t * t * t * vec3(0.05, 0.02 * k, 0.0)
}

fn velocity(id: u32, t: f32) -> Vec3 {
    let k = id as f32;
    vec3(0.0, -1.0, 0.0) + vec3(0.5, k, -1.0) + 2.0 * t * vec3(0.2, -0.5, 0.1)
        - 3.0 * t * t * vec3(0.05, 0.02 * k, 0.0)
}

/// Two frames a second of particles with these ids, in this order.
fn frame(ids: &[u32], number: u32) -> ParticleFrame {
    let t = 0.5 * number as f32;
    ParticleFrame {
        positions: ids.iter().map(|&id| position(id, t)).collect(),
        velocities: ids.iter().map(|&id| velocity(id, t)).collect(),
        ids: ids.to_vec(),
        radius: Some(0.1),
    }
}

fn write(test: &str, extension: &str, frames: &[ParticleFrame]) -> (App, Entity) {
    let folder = folder(test);
    for (number, frame) in frames.iter().enumerate() {
        let path = folder.join(format!("cubic_{number}.{extension}"));
        frame.write(&path).unwrap();
    }
    let mut app = app(&folder);
    let recording = open(
        &app,
        RecordingSettings {
            rate: 2.0,
            ..slowly(&format!("cubic_#.{extension}"))
        },
    );
    let entity = play(
        &mut app,
        RecordingPlayer {
            paused: true,
            ..RecordingPlayer::new(recording)
        },
    );
    (app, entity)
}

#[track_caller]
fn assert_close(found: &[Vec3], expected: &[Vec3]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            found.distance(*expected) < 1e-5,
            "{found} is not {expected}"
        );
    }
}

#[test]
fn particles_are_followed_by_their_ids() {
    // Another order in each frame, as simulations sort them.
    let orders = [[4, 0, 9, 2], [0, 2, 4, 9], [9, 4, 2, 0], [2, 9, 0, 4]];
    let frames: Vec<_> = (0..4).map(|n| frame(&orders[n as usize], n)).collect();
    for extension in ["vtk", "bgeo", "ply"] {
        let (mut app, entity) = write(&format!("ids_{extension}"), extension, &frames);
        for time in [0.0, 0.1, 0.25, 0.5, 0.7, 1.2, 1.49, 1.5] {
            seek(&mut app, entity, time);
            let cubic = [0, 2, 4, 9].map(|id| position(id, time as f32));
            assert_close(&particles(&app, entity).positions, &cubic);
        }
        player(&mut app, entity).interpolation = Interpolation::Linear;
        for (time, share) in [(0.1, 0.2), (0.7, 0.4), (1.4, 0.8)] {
            seek(&mut app, entity, time);
            let from = 0.5 * (2.0 * time).floor() as f32;
            let line = [0, 2, 4, 9].map(|id| {
                let ends = [from, from + 0.5].map(|t| position(id, t));
                ends[0].lerp(ends[1], share)
            });
            assert_close(&particles(&app, entity).positions, &line);
        }
    }
}

#[test]
fn who_appears_or_vanishes_is_there_in_the_nearer_half() {
    let (mut app, entity) = write(
        "appearing",
        "ply",
        &[frame(&[1, 3], 0), frame(&[3, 5], 1), frame(&[], 2)],
    );
    for (time, ids) in [
        (0.1, vec![1, 3]),
        (0.24, vec![1, 3]),
        (0.26, vec![3, 5]),
        (0.5, vec![3, 5]),
        (0.7, vec![3, 5]),
        (0.8, vec![]),
        (1.0, vec![]),
    ] {
        seek(&mut app, entity, time);
        let found = &particles(&app, entity).positions;
        assert_eq!(found.len(), ids.len(), "at {time}");
        // The one that both have is where it should be; the other moves on at its speed.
        if time < 0.5 {
            let common = ids.iter().position(|&id| id == 3).unwrap();
            assert_close(&[found[common]], &[position(3, time as f32)]);
        }
        if time == 0.1 {
            let straight = position(1, 0.0) + 0.1 * velocity(1, 0.0);
            assert_close(&[found[0]], &[straight]);
        }
    }
}

#[test]
fn without_ids_the_nearer_frame_is_shown() {
    let folder = folder("nearest");
    write_dots(&folder, 0..3);
    let mut app = app(&folder);
    let recording = open(&app, slowly("dot_#.xyz"));
    let entity = play(&mut app, RecordingPlayer::new(recording));
    for (time, expected) in [
        (0.0, 0.0),
        (0.49, 0.0),
        (0.51, 1.0),
        (1.3, 1.0),
        (1.5, 2.0),
        (2.0, 2.0),
    ] {
        seek(&mut app, entity, time);
        assert_eq!(x(&app, entity), expected, "at {time}");
    }
}

#[test]
fn ids_that_are_there_twice_say_nothing() {
    let twice = |number| ParticleFrame {
        ids: vec![7, 7],
        ..frame(&[1, 2], number)
    };
    let (mut app, entity) = write("twice", "vtk", &[twice(0), twice(1)]);
    for (time, shown) in [(0.2, 0.0), (0.3, 0.5)] {
        seek(&mut app, entity, time);
        let expected = [1, 2].map(|id| position(id, shown));
        assert_close(&particles(&app, entity).positions, &expected);
    }
}

#[test]
fn the_radius_is_the_files_then_the_players_then_the_recordings() {
    let with_radius = [frame(&[1], 0)];
    let without = [ParticleFrame {
        radius: None,
        ..frame(&[1], 0)
    }];
    for (files, player_has, expected) in [
        (&with_radius, Some(0.3), 0.1),
        (&without, Some(0.3), 0.3),
        (&without, None, 0.2),
    ] {
        let (mut app, _) = write("radius", "vtk", files);
        let recording = open(
            &app,
            RecordingSettings {
                radius: Some(0.2),
                ..slowly("cubic_#.vtk")
            },
        );
        let entity = play(
            &mut app,
            RecordingPlayer {
                radius: player_has,
                ..RecordingPlayer::new(recording)
            },
        );
        assert_eq!(particles(&app, entity).radius, expected);
    }
}
