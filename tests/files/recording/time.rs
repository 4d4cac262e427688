//! Which frame is shown when.

use std::fs;

use bevy::prelude::*;
use bevy_fluid::{
    prelude::FluidParticles,
    recording::{Interpolation, RecordingPlayer},
};

use super::{
    app, dot, folder, frames, log, open, particles, play, player, seek, set_time_step, slowly,
    wait, write_dots, x,
};

/// Holds all frames, and shows the one before each moment.
fn steps(recording: Handle<bevy_fluid::recording::FluidRecording>) -> RecordingPlayer {
    RecordingPlayer {
        interpolation: Interpolation::None,
        cache: 32,
        ..RecordingPlayer::new(recording)
    }
}

/// A player of these frames that has loaded them all.
fn all_loaded(test: &str, numbers: &[u32], change: fn(&mut RecordingPlayer)) -> (App, Entity) {
    let folder = folder(test);
    write_dots(&folder, numbers.iter().copied());
    let mut app = app(&folder);
    let mut player = steps(open(&app, slowly("dot_#.xyz")));
    change(&mut player);
    let entity = play(&mut app, player);
    let count = numbers.len();
    wait(&mut app, |world| {
        let frames = frames(world, entity);
        frames.held() == count && frames.loading() == 0
    });
    (app, entity)
}

/// What is shown in each of these updates.
fn shown(app: &mut App, entity: Entity, updates: usize) -> Vec<f32> {
    (0..updates)
        .map(|_| {
            app.update();
            x(app, entity)
        })
        .collect()
}

#[test]
fn a_gap_takes_its_time() {
    let (mut app, entity) = all_loaded("gaps", &[3, 4, 7, 9], |_| {});
    for (time, expected) in [
        (0.0, 3.0),
        (0.99, 3.0),
        (1.0, 4.0),
        (3.99, 4.0),
        (4.0, 7.0),
        (5.9, 7.0),
        (6.0, 9.0),
        (1e9, 9.0),
        (-5.0, 3.0),
    ] {
        seek(&mut app, entity, time);
        assert_eq!(x(&app, entity), expected, "at {time}");
    }
    assert_eq!(player(&mut app, entity).time, 0.0, "kept in range");
}

#[test]
fn it_plays_at_its_rate_and_stops_at_the_end() {
    let (mut app, entity) = all_loaded("rate", &[0, 1, 2, 3], |_| {});
    set_time_step(&mut app, 0.5);
    assert_eq!(shown(&mut app, entity, 8), [0., 1., 1., 2., 2., 3., 3., 3.]);
    assert_eq!(player(&mut app, entity).time, 3.0);

    player(&mut app, entity).rate = -2.0;
    assert_eq!(shown(&mut app, entity, 5), [2., 1., 0., 0., 0.]);
    player(&mut app, entity).rate = 0.0;
    assert_eq!(shown(&mut app, entity, 2), [0., 0.]);
    player(&mut app, entity).rate = 4.0;
    player(&mut app, entity).paused = true;
    assert_eq!(shown(&mut app, entity, 2), [0., 0.]);
    player(&mut app, entity).paused = false;
    assert_eq!(shown(&mut app, entity, 1), [2.]);
}

#[test]
fn it_starts_over_both_ways() {
    let (mut app, entity) = all_loaded("repeat", &[0, 1, 2], |player| player.repeat = true);
    set_time_step(&mut app, 0.5);
    assert_eq!(
        shown(&mut app, entity, 8),
        [0., 1., 1., 2., 2., 0., 0., 1.],
        "the last frame is shown as long as the others"
    );
    seek(&mut app, entity, 0.0);
    player(&mut app, entity).rate = -1.0;
    assert_eq!(shown(&mut app, entity, 6), [2., 2., 1., 1., 0., 0.]);
    seek(&mut app, entity, 7.25);
    assert_eq!(x(&app, entity), 1.0);
    assert_eq!(player(&mut app, entity).time, 1.25);
}

#[test]
fn what_makes_no_sense_is_said_once_and_played_in_range() {
    let (mut app, entity) = all_loaded("senseless", &[0, 1, 2], |player| player.repeat = true);
    let fluid = format!("entity {entity}");
    for (field, change) in [
        (
            "RecordingPlayer::rate",
            (|p| p.rate = f32::NAN) as fn(&mut RecordingPlayer),
        ),
        ("RecordingPlayer::rate", |p| p.rate = f32::INFINITY),
        ("RecordingPlayer::time", |p| p.time = f64::NAN),
        ("RecordingPlayer::cache", |p| p.cache = 0),
        ("RecordingPlayer::radius", |p| p.radius = Some(-1.0)),
    ] {
        let said = |_: &App| log::count(&format!("{fluid}: `{field}`"));
        *player(&mut app, entity) = RecordingPlayer {
            repeat: true,
            ..steps(player(&mut app, entity).recording.clone())
        };
        app.update();
        let before = said(&app);
        change(&mut player(&mut app, entity));
        set_time_step(&mut app, 0.5);
        for _ in 0..4 {
            app.update();
        }
        assert_eq!(said(&app), before + 1, "{field}");
        assert!(player(&mut app, entity).time.is_finite());
        assert!(frames(app.world(), entity).held() <= 32);
    }
    player(&mut app, entity).rate = f32::NAN;
    set_time_step(&mut app, 0.0);
    seek(&mut app, entity, 0.0);
    wait(&mut app, |world| frames(world, entity).loading() == 0);
    set_time_step(&mut app, 0.5);
    assert_eq!(shown(&mut app, entity, 2), [0., 1.], "as at the default");
}

#[test]
fn a_damaged_frame_is_named_once_and_skipped() {
    let folder = folder("damaged");
    write_dots(&folder, [0, 1, 3, 4]);
    fs::write(folder.join("dot_2.xyz"), [0; 13]).unwrap();
    let mut app = app(&folder);
    let recording = open(&app, slowly("dot_#.xyz"));
    let entity = play(&mut app, steps(recording).repeating());
    wait(&mut app, |world| frames(world, entity).skipped() == 1);
    assert_eq!(log::count("dot_2.xyz is damaged"), 1);
    wait(&mut app, |world| frames(world, entity).loading() == 0);
    set_time_step(&mut app, 1.0);
    // Twice around; the damaged frame's time is the one's before it.
    let expected = [1., 1., 3., 4., 0., 1., 1., 3., 4., 0.];
    assert_eq!(shown(&mut app, entity, 10), expected);
    assert_eq!(log::count("dot_2.xyz"), 1);
}

#[test]
fn a_missing_frame_is_named_and_one_of_none_ends_it() {
    let folder = folder("missing");
    dot(0.0).write(&folder.join("seen_0.xyz")).unwrap();
    let mut app = app(&folder);
    let recording = open(
        &app,
        bevy_fluid::recording::RecordingSettings {
            first: Some(0),
            last: Some(2),
            ..slowly("seen_#.xyz")
        },
    );
    let entity = play(&mut app, steps(recording));
    wait(&mut app, |world| frames(world, entity).skipped() == 2);
    for name in ["seen_1.xyz", "seen_2.xyz"] {
        assert_eq!(log::count(name), 1, "{name}");
    }
    seek(&mut app, entity, 2.0);
    assert_eq!(x(&app, entity), 0.0);

    let recording = open(&app, "unseen.vtk");
    let entity = app.world_mut().spawn(steps(recording)).id();
    wait(&mut app, |world| frames(world, entity).skipped() == 1);
    assert_eq!(log::count(&format!("fluid {entity} has no frame")), 1);
    assert!(!frames(app.world(), entity).is_waiting());
}

#[derive(Resource, Default)]
struct Changes(u32);

fn count_changes(app: &mut App) {
    app.init_resource::<Changes>().add_systems(
        Last,
        |changed: Query<(), Changed<FluidParticles>>, mut changes: ResMut<Changes>| {
            changes.0 += changed.iter().count() as u32;
        },
    );
}

#[test]
fn particles_change_with_what_is_shown_only() {
    let (mut app, entity) = all_loaded("unchanged", &[0, 1, 2], |_| {});
    count_changes(&mut app);
    app.update();
    app.world_mut().resource_mut::<Changes>().0 = 0;
    set_time_step(&mut app, 0.1);
    // 0.1 … 2.0, and the end: frames 1 and 2 come.
    shown(&mut app, entity, 25);
    assert_eq!(app.world().resource::<Changes>().0, 2);
}

#[test]
fn a_radius_that_is_none_counts_as_not_given() {
    let (mut app, entity) = all_loaded("radius", &[0, 1, 2], |_| {});
    count_changes(&mut app);
    app.world_mut()
        .get_mut::<FluidParticles>(entity)
        .unwrap()
        .radius = 0.25;
    for radius in [-1.0, 0.0, f32::NAN, f32::INFINITY] {
        player(&mut app, entity).radius = Some(radius);
        app.update();
        app.world_mut().resource_mut::<Changes>().0 = 0;
        shown(&mut app, entity, 3);
        assert_eq!(particles(&app, entity).radius, 0.25, "{radius}");
        assert_eq!(app.world().resource::<Changes>().0, 0, "{radius}");
    }
    player(&mut app, entity).radius = Some(0.5);
    app.update();
    assert_eq!(particles(&app, entity).radius, 0.5);
}
