//! What the crate's own sources do is recorded, and played back between its frames.

use std::collections::HashMap;

use bevy::prelude::*;
use bevy_fluid::{
    prelude::*,
    recording::{RecordingPlayer, RecordingWriter, WrittenFrames},
    salva::SalvaMode,
};

use super::{app, folder, frames, log, particles, set_time_step, stop_clock, wait};

const STEP: f64 = 0.05;

/// Places and velocities by id, in the entity's space.
type Moment = HashMap<u32, [Vec3; 2]>;

fn moment(app: &App, entity: Entity) -> Moment {
    let fluid = particles(app, entity);
    assert_eq!(fluid.ids.len(), fluid.positions.len());
    assert_eq!(fluid.velocities.len(), fluid.positions.len());
    let place = app.world().get::<GlobalTransform>(entity).unwrap();
    let to_entity = place.affine().inverse() * fluid.world_from_particles(place).affine();
    let columns = fluid.positions.iter().zip(&fluid.velocities);
    let states = columns.map(|(&place, &velocity)| {
        [
            to_entity.transform_point3(place),
            to_entity.transform_vector3(velocity),
        ]
    });
    fluid.ids.iter().copied().zip(states).collect()
}

/// What is to be seen a `share` of the way from one moment to the next.
fn between(before: &Moment, after: &Moment, share: f32) -> HashMap<u32, Vec3> {
    let step = STEP as f32;
    let mut expected = HashMap::new();
    for (id, &[from, start]) in before {
        if let Some(&[to, end]) = after.get(id) {
            let curve = CubicHermite::new([from, to], [start * step, end * step]);
            let curve = curve.to_curve().unwrap();
            expected.insert(*id, curve.position(share));
        } else if share < 0.5 {
            expected.insert(*id, from + start * share * step);
        }
    }
    for (id, &[to, end]) in after {
        if !before.contains_key(id) && share >= 0.5 {
            expected.insert(*id, to - end * (1.0 - share) * step);
        }
    }
    expected
}

fn assert_recorded(name: &str, source: impl Bundle) {
    let folder = folder(name);
    let mut recording = App::new();
    recording
        .add_plugins((MinimalPlugins, AssetPlugin::default(), TransformPlugin))
        .add_plugins((FluidPlugin::default(), RecordingPlugin, SalvaPlugin));
    let mut salva = recording.world_mut().resource_mut::<SalvaSettings>();
    salva.mode = SalvaMode::Lockstep;
    stop_clock(&mut recording);
    recording.update();
    set_time_step(&mut recording, STEP);
    let writer = RecordingWriter {
        rate: (1.0 / STEP) as f32,
        queue: 100,
        ..RecordingWriter::new(folder.join("source_##.vtk").to_str().unwrap())
    };
    let emitter = ParticleEmitter {
        lifetime: 0.32,
        particle_radius: 0.02,
        drag: 0.0,
        ..ParticleEmitter::fountain(300.0, 2.0)
    };
    let place = Transform::from_xyz(1.0, 2.0, -3.0)
        .with_rotation(Quat::from_rotation_z(0.4))
        .with_scale(Vec3::splat(2.0));
    let fluid = recording
        .world_mut()
        .spawn((emitter, place, writer, source))
        .id();
    let mut moments = Vec::new();
    for _ in 0..16 {
        recording.update();
        moments.push(moment(&recording, fluid));
    }
    let mut written = recording
        .world_mut()
        .get_mut::<WrittenFrames>(fluid)
        .unwrap();
    written.finish();
    assert_eq!((written.written(), written.error()), (16, None));
    let deaths = moments[8].keys().filter(|id| !moments[15].contains_key(id));
    assert!(deaths.count() > 5 && moments[15].len() > 5, "{name}");

    let mut app = app(&folder);
    let file = app
        .world()
        .resource::<AssetServer>()
        .load("source.fluid.ron");
    let player = RecordingPlayer {
        rate: 0.5,
        cache: 20,
        ..RecordingPlayer::new(file)
    };
    let player = app.world_mut().spawn(player).id();
    wait(&mut app, |world| {
        let frames = frames(world, player);
        frames.held() == 16 && frames.loading() == 0
    });
    set_time_step(&mut app, 0.3 * STEP);
    let mut seen = 0;
    loop {
        app.update();
        let time = app.world().get::<RecordingPlayer>(player).unwrap().time / STEP;
        if time > 14.99 {
            break;
        }
        let share = time.fract() as f32;
        // Near a frame either of two may be shown, and in the middle either half.
        if !(0.01..0.99).contains(&share) || (share - 0.5).abs() < 0.01 {
            continue;
        }
        let [before, after] = [0, 1].map(|next| &moments[time as usize + next]);
        let expected = between(before, after, share);
        let found = particles(&app, player);
        assert_eq!(found.positions.len(), expected.len(), "{name} at {time}");
        for (id, &place) in found.ids.iter().zip(&found.positions) {
            let apart = place.distance(expected[id]);
            assert!(apart < 1e-4, "{name} at {time}: {id} is {apart} m off");
            seen += 1;
        }
        // The radius is the entity's too.
        assert!((found.radius - 0.02).abs() < 1e-6);
    }
    assert!(seen > 200, "{name}: {seen}");
    assert_eq!(log::count(name), 0);
}

#[test]
fn emitted_particles_play_between_frames() {
    assert_recorded("emitted", ());
}

#[test]
fn simulated_particles_play_between_frames() {
    assert_recorded("simulated", SalvaFluid::WATER);
}

#[test]
fn a_moving_emitter_is_played_on_lines() {
    let folder = folder("moving");
    let mut app = app(&folder);
    let positions = vec![Vec3::ZERO];
    let fluid = FluidParticles {
        velocities: vec![Vec3::X],
        ids: vec![7],
        space: ParticleSpace::World,
        ..FluidParticles::new(positions, 0.1)
    };
    let writer = RecordingWriter {
        rate: 10.0,
        queue: 100,
        ..RecordingWriter::new(folder.join("moving_#.ply").to_str().unwrap())
    };
    let entity = app.world_mut().spawn((fluid, writer)).id();
    set_time_step(&mut app, 0.1);
    for frame in 0..4 {
        // It stands still, moves on once and stands still again.
        let x = if frame < 2 { 0.0 } else { -3.0 };
        app.world_mut()
            .get_mut::<Transform>(entity)
            .unwrap()
            .translation
            .x = x;
        app.update();
    }
    let mut written = app.world_mut().get_mut::<WrittenFrames>(entity).unwrap();
    written.finish();
    for (frame, x, velocities) in [(0, 0.0, 1), (1, 0.0, 1), (2, 3.0, 0), (3, 3.0, 1)] {
        let path = folder.join(format!("moving_{frame}.ply"));
        let read = bevy_fluid::recording::ParticleFrame::read(&path).unwrap();
        assert_eq!(read.positions, [Vec3::X * x]);
        assert_eq!(
            (read.ids.len(), read.velocities.len()),
            (1, velocities),
            "{frame}"
        );
    }
}
