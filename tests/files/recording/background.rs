//! Loading: never in the way, never more than the cache may hold.

use std::{path::Path, sync::Arc, time::Duration};

use bevy::{
    asset::io::{
        AssetReader, AssetReaderError, AssetSourceBuilder, PathStream, Reader, memory::Dir,
    },
    prelude::*,
};
use bevy_fluid::{
    particles::ShapedFluid,
    prelude::{FluidParticles, FluidPlugin},
    recording::{
        FluidRecording, Interpolation, RecordingPlayer, RecordingPlugin, RecordingSettings,
    },
};

use super::gates::{GatedReader, Gates};
use super::{
    app, dot, folder, frames, log, open, play, player, seek, set_time_step, slowly, stop_clock,
    wait, write_dots, x,
};

/// Files that open when they are told to: one dot each, whose x is its number.
fn gated(count: u32) -> (App, Gates) {
    gated_with(count, |app| {
        app.add_plugins(RecordingPlugin);
    })
}

fn gated_with(count: u32, plugins: impl FnOnce(&mut App)) -> (App, Gates) {
    log::listen();
    let (files, gates) = (Dir::default(), Gates::default());
    for number in 0..count {
        let bytes = [number as f32, 0.0, 0.0].map(f32::to_le_bytes).concat();
        files.insert_asset(Path::new(&format!("dot_{number}.xyz")), bytes);
    }
    let reader = GatedReader {
        gates: gates.clone(),
        files,
    };
    let mut app = App::new();
    app.register_asset_source(
        "gated",
        AssetSourceBuilder::new(move || Box::new(reader.clone())),
    )
    .add_plugins((MinimalPlugins, AssetPlugin::default()));
    plugins(&mut app);
    stop_clock(&mut app);
    (app, gates)
}

fn gate(gates: &Gates, number: u32) {
    gates.open(&format!("dot_{number}.xyz"));
}

fn shows(entity: Entity, number: u32) -> impl Fn(&World) -> bool {
    move |world| frames(world, entity).shown() == Some(number)
}

/// Starts to play what has only its first frame yet.
fn start(app: &mut App, gates: &Gates, cache: usize) -> Entity {
    let recording = open(app, slowly("gated://dot_#.xyz"));
    let player = RecordingPlayer {
        interpolation: Interpolation::None,
        cache,
        ..RecordingPlayer::new(recording)
    };
    let entity = app.world_mut().spawn(player).id();
    set_time_step(app, 0.5);
    for _ in 0..50 {
        std::thread::sleep(Duration::from_millis(1));
        app.update();
    }
    assert_eq!(frames(app.world(), entity).shown(), None);
    assert_eq!(
        player_time(app, entity),
        0.0,
        "the clock starts with the first frame"
    );
    set_time_step(app, 0.0);
    gate(gates, 0);
    wait(app, shows(entity, 0));
    entity
}

fn player_time(app: &mut App, entity: Entity) -> f64 {
    player(app, entity).time
}

#[test]
fn a_frame_that_is_not_there_holds_the_last_and_not_the_program() {
    let (mut app, gates) = gated(6);
    let entity = start(&mut app, &gates, 8);
    set_time_step(&mut app, 0.5);
    for _ in 0..7 {
        app.update();
        assert_eq!(x(&app, entity), 0.0);
        assert!(player_time(&mut app, entity) < 1.0 || frames(app.world(), entity).is_waiting());
    }
    assert_eq!(player_time(&mut app, entity), 3.5, "time goes on");

    // A late one is better than none, in order; one from the future is not shown.
    set_time_step(&mut app, 0.0);
    gate(&gates, 5);
    gate(&gates, 2);
    wait(&mut app, shows(entity, 2));
    assert!(frames(app.world(), entity).is_waiting());
    gate(&gates, 1);
    gate(&gates, 3);
    wait(&mut app, shows(entity, 3));
    assert_eq!(x(&app, entity), 3.0);
    assert!(!frames(app.world(), entity).is_waiting());
}

#[test]
fn frames_slower_than_play_are_still_shown() {
    let (mut app, gates) = gated(30);
    let entity = start(&mut app, &gates, 3);
    for (now, late) in [(4.0, 1), (8.0, 2), (12.0, 8)] {
        set_time_step(&mut app, 4.0);
        app.update();
        set_time_step(&mut app, 0.0);
        assert_eq!(player_time(&mut app, entity), now);
        // What has been asked for is not given up for being late.
        gate(&gates, late);
        wait(&mut app, shows(entity, late));
        assert!(frames(app.world(), entity).held() <= 3);
        app.update();
    }
}

#[test]
fn a_seek_gives_up_what_is_on_its_way() {
    let (mut app, gates) = gated(30);
    let entity = start(&mut app, &gates, 4);
    player(&mut app, entity).seek(20.0);
    app.update();
    assert_eq!(x(&app, entity), 0.0, "held");
    assert!(frames(app.world(), entity).held() <= 4);
    gate(&gates, 20);
    wait(&mut app, shows(entity, 20));
    assert_eq!(player_time(&mut app, entity), 20.0);
}

#[test]
fn no_more_frames_are_held_than_the_cache_may() {
    let folder = folder("cache");
    write_dots(&folder, 0..40);
    let mut app = app(&folder);
    let recording = open(&app, slowly("dot_#.xyz"));
    let entity = play(
        &mut app,
        RecordingPlayer {
            cache: 3,
            interpolation: Interpolation::None,
            ..RecordingPlayer::new(recording).repeating()
        },
    );
    let mut most = 0;
    for rate in [1.0, -1.0] {
        player(&mut app, entity).rate = rate;
        for step in 0..50 {
            set_time_step(&mut app, 1.0);
            app.update();
            set_time_step(&mut app, 0.0);
            let now = player_time(&mut app, entity);
            wait(&mut app, |world| {
                assert!(frames(world, entity).held() <= 3);
                !frames(world, entity).is_waiting()
            });
            assert_eq!(f64::from(x(&app, entity)), now, "step {step}");
            most = most.max(frames(app.world(), entity).held());
        }
    }
    assert_eq!(most, 3, "it looks ahead");
    // Ahead is where it plays to.
    wait(&mut app, |world| frames(world, entity).loading() == 0);
    player(&mut app, entity).cache = 2;
    app.update();
    assert_eq!(frames(app.world(), entity).held(), 2);
    seek(&mut app, entity, 17.0);
    assert_eq!(x(&app, entity), 17.0);
}

#[test]
fn what_is_ahead_is_loaded_first() {
    for (rate, expected) in [(1.0, [10, 11, 12]), (-1.0, [10, 9, 8])] {
        let (mut app, gates) = gated(20);
        let recording = open(&app, slowly("gated://dot_#.xyz"));
        let entity = app
            .world_mut()
            .spawn(RecordingPlayer {
                cache: 3,
                rate,
                time: 10.0,
                ..RecordingPlayer::new(recording)
            })
            .id();
        wait(&mut app, |world| frames(world, entity).loading() == 3);
        for number in expected {
            assert!(frames(app.world(), entity).loading() > 0);
            gate(&gates, number);
        }
        wait(&mut app, |world| frames(world, entity).loading() == 0);
        assert_eq!(x(&app, entity), 10.0);
    }
}

#[test]
fn a_player_may_go_or_change_its_mind_while_frames_load() {
    let (mut app, gates) = gated(6);
    let entity = start(&mut app, &gates, 4);
    assert!(frames(app.world(), entity).loading() > 0);
    app.world_mut()
        .entity_mut(entity)
        .remove::<RecordingPlayer>();
    app.update();
    app.world_mut().despawn(entity);
    app.update();

    let (mut app, gates) = gated(6);
    let first = start(&mut app, &gates, 4);
    let other = open(
        &app,
        RecordingSettings {
            first: Some(5),
            last: Some(5),
            ..slowly("gated://dot_#.xyz")
        },
    );
    player(&mut app, first).recording = other;
    gate(&gates, 5);
    wait(&mut app, shows(first, 5));
    assert_eq!(x(&app, first), 5.0);
    assert_eq!(frames(app.world(), first).held(), 1);
}

#[test]
fn a_recording_that_is_replaced_is_played_anew() {
    let folder = folder("replaced");
    write_dots(&folder, 0..4);
    let mut app = app(&folder);
    let numbers = |first, last| RecordingSettings {
        first: Some(first),
        last: Some(last),
        ..slowly("dot_#.xyz")
    };
    let (one, other) = (open(&app, numbers(0, 1)), open(&app, numbers(2, 3)));
    let entity = play(&mut app, RecordingPlayer::new(one.clone()));
    wait(&mut app, |world| {
        let recordings = world.resource::<Assets<FluidRecording>>();
        recordings.contains(&other)
    });
    seek(&mut app, entity, 1.0);
    assert_eq!(x(&app, entity), 1.0);
    let mut recordings = app.world_mut().resource_mut::<Assets<FluidRecording>>();
    let replacement = recordings.get(&other).unwrap().clone();
    recordings.insert(&one, replacement).unwrap();
    wait(&mut app, shows(entity, 3));
    assert_eq!((x(&app, entity), player_time(&mut app, entity)), (3.0, 1.0));
}

#[test]
fn a_description_that_is_reloaded_has_its_frames_read_again() {
    let folder = folder("reloaded");
    write_dots(&folder, 0..1);
    let description = folder.join("dot.fluid.ron");
    std::fs::write(&description, "(frames: \"dot_#.xyz\")").unwrap();
    let mut app = app(&folder);
    let server = app.world().resource::<AssetServer>().clone();
    let entity = play(&mut app, RecordingPlayer::new(server.load("dot.fluid.ron")));
    dot(7.0).write(&folder.join("dot_0.xyz")).unwrap();
    server.reload("dot.fluid.ron");
    wait(&mut app, |world| {
        let particles: &FluidParticles = world.get(entity).unwrap();
        particles.positions[0].x == 7.0
    });
}

#[test]
fn a_player_without_a_frame_yet_is_no_cause_for_complaint() {
    let (mut app, gates) = gated_with(1, |app| {
        app.add_plugins(TransformPlugin)
            .add_plugins((FluidPlugin::default(), RecordingPlugin));
    });
    let recording = open(&app, slowly("gated://dot_#.xyz"));
    let player = RecordingPlayer {
        radius: Some(0.5),
        ..RecordingPlayer::new(recording)
    };
    // The log is the whole process's: the fluid's name is that of no other test's.
    let others = std::iter::repeat_n((), 4321);
    app.world_mut().spawn_batch(others).for_each(drop);
    let entity = app.world_mut().spawn(player).id();
    wait(&mut app, |world| frames(world, entity).loading() == 1);
    let shaped = |app: &App| app.world().get::<ShapedFluid>(entity).unwrap().clone();
    assert_eq!((shaped(&app).generation(), shaped(&app).spray()), (1, 0));
    gate(&gates, 0);
    wait(&mut app, shows(entity, 0));
    assert_eq!((shaped(&app).generation(), shaped(&app).spray()), (2, 1));
    assert_eq!(log::count(&format!("fluid {entity} is not drawn")), 0);
}

/// A reader that tells whether it is still there.
#[derive(Clone)]
struct Counted(
    GatedReader,
    #[expect(dead_code, reason = "only counted")] Arc<()>,
);

impl AssetReader for Counted {
    async fn read<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        self.0.read(path).await
    }

    async fn read_meta<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        self.0.read_meta(path).await
    }

    async fn read_directory<'a>(
        &'a self,
        path: &'a Path,
    ) -> Result<Box<PathStream>, AssetReaderError> {
        self.0.read_directory(path).await
    }

    async fn is_directory<'a>(&'a self, path: &'a Path) -> Result<bool, AssetReaderError> {
        self.0.is_directory(path).await
    }
}

#[test]
fn an_app_that_ends_takes_its_asset_server_along() {
    let (files, gates, count) = (Dir::default(), Gates::default(), Arc::new(()));
    files.insert_asset(Path::new("dot_0.xyz"), vec![0; 12]);
    files.insert_asset(
        Path::new("dot.fluid.ron"),
        b"(frames: \"dot_#.xyz\")".to_vec(),
    );
    gates.open("dot.fluid.ron");
    let gated = GatedReader { gates, files };
    let reader = Counted(gated, count.clone());
    let mut app = App::new();
    app.register_asset_source(
        "counted",
        AssetSourceBuilder::new(move || Box::new(reader.clone())),
    )
    .add_plugins((MinimalPlugins, AssetPlugin::default(), RecordingPlugin));
    let recording: Handle<FluidRecording> = app
        .world()
        .resource::<AssetServer>()
        .load("counted://dot.fluid.ron");
    wait(&mut app, |world| {
        world
            .resource::<Assets<FluidRecording>>()
            .contains(&recording)
    });
    assert!(Arc::strong_count(&count) > 1);
    drop(app);
    assert_eq!(Arc::strong_count(&count), 1);
}

/// The order of plugins does not matter to players.
#[test]
fn the_asset_plugin_may_come_after_the_recordings() {
    let folder = folder("late_assets");
    write_dots(&folder, 0..2);
    log::listen();
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        RecordingPlugin,
        AssetPlugin {
            file_path: folder.to_str().unwrap().into(),
            ..default()
        },
    ));
    stop_clock(&mut app);
    app.finish();
    app.cleanup();
    let recording = open(&app, slowly("dot_#.xyz"));
    let player = play(&mut app, RecordingPlayer::new(recording));
    seek(&mut app, player, 1.0);
    assert_eq!(x(&app, player), 1.0);
}
