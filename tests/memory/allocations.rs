//! A steady frame allocates nothing: the schedule that all our systems are in, counted.

use std::{fs, path::Path, thread, time::Duration};

use bevy::{
    core_pipeline::prepass::MotionVectorPrepass,
    ecs::schedule::{ScheduleLabel, SingleThreadedExecutor},
    prelude::*,
    render::{ExtractSchedule, Render, RenderApp, camera::CameraRenderGraph},
};
use bevy_fluid::{
    emitter::EmittedParticles,
    prelude::*,
    recording::{FluidRecording, LoadedFrames, ParticleFrame, RecordingPlayer, RecordingSettings},
};
use fluid_stage::{headless_app, settle};

use crate::heap;

const STEP: Duration = Duration::from_millis(16);

/// An app without a renderer. Bevy's own executor allocates with many threads, not with one.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default()))
        .add_plugins((FluidPlugin::default(), RecordingPlugin))
        .edit_schedule(PostUpdate, |schedule| {
            schedule.set_executor(SingleThreadedExecutor::new());
        });
    app.finish();
    app.cleanup();
    app
}

/// Frames of [`PostUpdate`] alone, which all our systems are in. The clock moves on by [`STEP`].
fn run(app: &mut App, frames: u32) {
    let world = app.world_mut();
    // As a thread of rayon's own: another one hands its work over in a queue, of which rayon
    // allocates a block from time to time.
    rayon::scope(|_| {
        for _ in 0..frames {
            world.resource_mut::<Time>().advance_by(STEP);
            world.run_schedule(PostUpdate);
        }
    });
}

/// How often memory is asked for in as many frames.
fn allocations(app: &mut App, frames: u32) -> usize {
    let before = heap::stats();
    run(app, frames);
    let after = heap::stats();
    after.allocations - before.allocations + after.reallocations - before.reallocations
}

#[test]
fn an_emitter_at_its_capacity() {
    let _alone = heap::alone();
    // In one task, and in several.
    for capacity in [3000, 10_000] {
        let mut app = app();
        let emitter = ParticleEmitter {
            capacity,
            // By age they would vanish a little later.
            lifetime: 1.1,
            ..ParticleEmitter::fountain(capacity as f32, 4.0)
        };
        let entity = app.world_mut().spawn(emitter).id();
        app.world_mut().spawn(ParticleCollider::ground());
        let sphere = ParticleCollider::from(Sphere::new(0.2));
        app.world_mut()
            .spawn((sphere, Transform::from_xyz(0.1, 0.6, 0.0)));
        // Those of every second are the same in number and others in place: buffers of the shape
        // stage grow to the most of a class.
        assert!(allocations(&mut app, 300) > 0, "it grows");
        assert_eq!(allocations(&mut app, 120), 0, "{capacity} particles");
        let world = app.world();
        let particles = world.get::<EmittedParticles>(entity).unwrap();
        assert!(particles.len() as u32 <= capacity);
        assert!(
            particles.len() as u32 > 9 * capacity / 10,
            "{}",
            particles.len()
        );
        let youngest = particles.ages().iter().copied().fold(f32::MAX, f32::min);
        assert!(youngest < STEP.as_secs_f32(), "births go on");
    }
}

#[test]
fn a_player_whose_frames_are_all_there() {
    let _alone = heap::alone();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("allocations");
    fs::create_dir_all(&folder).unwrap();
    for number in 0..6 {
        let at = |i: u32| vec3(i as f32, number as f32, 0.0) * 0.05;
        let frame = ParticleFrame {
            positions: (0..500).map(at).collect(),
            // One comes and one goes with every frame.
            ids: (0..500).map(|i| i + number).collect(),
            velocities: vec![Vec3::Y; 500],
            radius: Some(0.05),
        };
        frame
            .write(&folder.join(format!("line_{number}.vtk")))
            .unwrap();
    }
    let mut app = app();
    let settings = RecordingSettings {
        rate: 20.0,
        ..folder.join("line_#.vtk").to_str().unwrap().into()
    };
    let recording = FluidRecording::load(app.world().resource::<AssetServer>(), settings);
    let player = RecordingPlayer::new(recording).repeating();
    let entity = app.world_mut().spawn(player).id();
    let is_loaded = |app: &App| {
        let frames = app.world().get::<LoadedFrames>(entity).unwrap();
        frames.held() == 6 && frames.loading() == 0
    };
    while !is_loaded(&app) {
        app.update();
        thread::sleep(Duration::from_millis(1));
    }
    // A round, and all that is ever shown has its place.
    run(&mut app, 60);
    assert_eq!(allocations(&mut app, 120), 0);
    let before = app
        .world()
        .get::<FluidParticles>(entity)
        .unwrap()
        .positions
        .clone();
    run(&mut app, 1);
    let after = &app.world().get::<FluidParticles>(entity).unwrap().positions;
    assert!(*after != before, "it plays");
}

/// A camera that records no pass: those of Bevy and wgpu allocate.
#[derive(ScheduleLabel, Clone, Debug, Hash, PartialEq, Eq)]
struct NoPasses;

/// How often a frame without passes asks for memory, at the least, with `count` fluids of a colour
/// of their own in view, and with motion vectors or without.
fn prepared(count: usize, motion_vectors: bool) -> usize {
    let mut app = headless_app(UVec2::splat(64), |app| {
        app.add_plugins(FluidPlugin::default());
        for schedule in [
            First.intern(),
            PreUpdate.intern(),
            Update.intern(),
            PostUpdate.intern(),
        ] {
            app.edit_schedule(schedule, |it| {
                it.set_executor(SingleThreadedExecutor::new());
            });
        }
        let world = app.world_mut();
        let mut camera = world.spawn((
            Camera3d::default(),
            ScreenSpaceFluid::default(),
            CameraRenderGraph::new(NoPasses),
        ));
        if motion_vectors {
            camera.insert(MotionVectorPrepass);
        }
        for i in 0..count {
            let material = FluidMaterial {
                refractive_index: 1.3 + 0.1 * i as f32,
                ..FluidMaterial::WATER
            };
            let at = vec3(0.1 * i as f32, 0.0, -2.0);
            world.spawn((FluidParticles::new(vec![at, at + 0.1], 0.1), material));
        }
        let render_app = app.sub_app_mut(RenderApp);
        render_app.init_schedule(NoPasses);
        for schedule in [ExtractSchedule.intern(), Render.intern()] {
            render_app.edit_schedule(schedule, |it| {
                it.set_executor(SingleThreadedExecutor::new());
            });
        }
    })
    .unwrap();
    settle(&mut app).unwrap();
    let mut frame = || {
        let before = heap::stats();
        app.update();
        let after = heap::stats();
        after.allocations - before.allocations + after.reallocations - before.reallocations
    };
    (0..20).for_each(|_| {
        frame();
    });
    (0..20).map(|_| frame()).min().unwrap()
}

#[test]
fn surfaces_are_extracted_and_prepared_without_allocations() {
    let _alone = heap::alone();
    for motion_vectors in [false, true] {
        let [without, with] = [0, 12].map(|count| prepared(count, motion_vectors));
        // Bevy itself asks for a few, once there is anything that may be visible.
        assert!(
            with < without + 12,
            "{with} for 12 surfaces, {without} for none; motion vectors: {motion_vectors}"
        );
    }
}
