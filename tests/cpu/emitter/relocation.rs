//! Shifts of the world, teleports, and moves too fast to be motions.

use std::f32::consts::PI;

use bevy::ecs::schedule::{IntoScheduleConfigs, ScheduleLabel};
use bevy_fluid::relocation::TeleportSettings;

use super::*;

const FRAME: f32 = 1.0 / 64.0;

/// The way to shift everything by, once.
#[derive(Resource, Default)]
struct Due(Option<Vec3>);

/// As a program with a floating origin does it.
fn shift(
    mut due: ResMut<Due>,
    mut roots: Query<&mut Transform, Without<ChildOf>>,
    mut shifts: MessageWriter<WorldShift>,
) {
    if let Some(way) = due.0.take() {
        for mut root in &mut roots {
            root.translation += way;
        }
        shifts.write(WorldShift(way));
    }
}

fn announce(due: Res<Due>, mut shifts: MessageWriter<WorldShift>) {
    if let Some(way) = due.0 {
        shifts.write(WorldShift(way));
    }
}

fn move_roots(mut due: ResMut<Due>, mut roots: Query<&mut Transform, Without<ChildOf>>) {
    if let Some(way) = due.0.take() {
        for mut root in &mut roots {
            root.translation += way;
        }
    }
}

/// A turning emitter on an arm, over a floor that rises and falls.
fn scene() -> (App, Entity) {
    let (mut app, entity) = emitting(ParticleEmitter {
        rate: 600.0,
        lifetime: 0.6,
        ..ParticleEmitter::fountain(600.0, 2.0)
    });
    app.init_resource::<Due>();
    let arm = app.world_mut().spawn(Transform::from_xyz(0.25, 0.5, -1.5));
    let arm = arm.id();
    app.world_mut().entity_mut(arm).add_child(entity);
    let floor = ParticleCollider {
        restitution: 0.5,
        ..ParticleCollider::ground()
    };
    app.world_mut().spawn((floor, Name::new("floor")));
    let rise = |mut floors: Query<&mut Transform, With<ParticleCollider>>, time: Res<Time>| {
        for mut floor in &mut floors {
            floor.translation.y += 0.5 * time.delta_secs() * (8.0 * time.elapsed_secs()).cos();
        }
    };
    let turn = |mut arms: Query<&mut Transform, With<Children>>, time: Res<Time>| {
        for mut arm in &mut arms {
            arm.rotate_z(2.0 * time.delta_secs());
        }
    };
    app.add_systems(PreUpdate, (rise, turn).chain());
    (app, entity)
}

/// Places of the particles about their emitter, as they are drawn, and their velocities.
fn relative(app: &App, entity: Entity) -> Vec<(Vec3, Vec3)> {
    let place = app.world().get::<GlobalTransform>(entity).unwrap();
    let velocities = particles(app, entity).velocities();
    let places = drawn(app, entity);
    places
        .into_iter()
        .map(|p| p - place.translation())
        .zip(velocities.iter().copied())
        .collect()
}

fn assert_like(now: &[(Vec3, Vec3)], expected: &[(Vec3, Vec3)], what: &str) {
    assert_eq!(now.len(), expected.len(), "{what}");
    for ((place, velocity), (place_before, velocity_before)) in now.iter().zip(expected) {
        // 1 km off, f32 is a multiple of 6e-5 m.
        let (off, other) = (
            place.distance(*place_before),
            velocity.distance(*velocity_before),
        );
        assert!(
            off < 2e-3 && other < 2e-2,
            "{what}: {off} m, {other} m/s off"
        );
    }
}

fn add_in<M>(
    app: &mut App,
    label: impl ScheduleLabel,
    systems: impl IntoScheduleConfigs<bevy::ecs::system::ScheduleSystem, M>,
) {
    app.add_systems(label, systems);
}

/// Wherever in the frame it is done: in no frame is anything elsewhere.
#[test]
fn a_shift_is_not_seen_from_within() {
    let ways: [(&str, fn(&mut App)); 6] = [
        ("First", |app| add_in(app, First, shift)),
        ("Update", |app| add_in(app, Update, shift)),
        ("announced", |app| {
            add_in(app, PreUpdate, announce);
            add_in(app, Update, move_roots);
        }),
        ("before Check", |app| {
            add_in(app, PostUpdate, shift.before(FluidSystems::Check));
        }),
        ("after Simulate", |app| {
            let late = shift.after(FluidSystems::Simulate);
            add_in(app, PostUpdate, late.before(TransformSystems::Propagate));
        }),
        ("Last", |app| add_in(app, Last, shift)),
    ];
    for (name, add) in ways {
        let (mut still, a) = scene();
        let (mut shifted, b) = scene();
        add(&mut shifted);
        run(&mut still, 0.5, 64.0);
        run(&mut shifted, 0.5, 64.0);
        assert_eq!(relative(&shifted, b), relative(&still, a));
        for frame in 0..16 {
            if frame % 5 == 1 {
                let way = vec3(-1000.0, 64.0, 500.0) * (frame as f32 - 5.0).signum();
                shifted.world_mut().resource_mut::<Due>().0 = Some(way);
            }
            step(&mut still, FRAME);
            step(&mut shifted, FRAME);
            let expected = relative(&still, a);
            assert!(expected.len() > 200);
            assert_like(
                &relative(&shifted, b),
                &expected,
                &format!("{name}, frame {frame}"),
            );
        }
    }
}

/// Also of what no emitter feeds any more; what is in its entity's space is the program's to move.
#[test]
fn every_fluid_in_the_world_is_shifted_and_no_other() {
    let mut app = app();
    let spawn = |app: &mut App, space| {
        let mut fluid = FluidParticles::new(vec![Vec3::X], 0.1);
        fluid.space = space;
        app.world_mut().spawn(fluid).id()
    };
    let world = spawn(&mut app, ParticleSpace::World);
    let local = spawn(&mut app, ParticleSpace::Local);
    step(&mut app, FRAME);
    app.world_mut().write_message(WorldShift(Vec3::Y * 8.0));
    app.world_mut().write_message(WorldShift(Vec3::Z));
    step(&mut app, FRAME);
    let place = |entity| app.world().get::<FluidParticles>(entity).unwrap().positions[0];
    assert_eq!([place(world), place(local)], [vec3(1.0, 8.0, 1.0), Vec3::X]);
}

#[test]
fn many_shifts_add_up_to_none() {
    let (mut app, entity) = emitting(ParticleEmitter {
        gravity: Vec3::ZERO,
        ..one(0.0, Vec3::Y)
    });
    place(&mut app, entity).translation = vec3(0.123, 0.456, -0.789);
    step(&mut app, FRAME);
    let (before, _) = single(&app, entity);
    for _ in 0..100 {
        for way in [vec3(10_000.0, 0.0, 300.0), vec3(-10_000.0, 0.0, -300.0)] {
            app.world_mut().write_message(WorldShift(way));
            place(&mut app, entity).translation += way;
            step(&mut app, FRAME);
        }
    }
    let (after, velocity) = single(&app, entity);
    assert_eq!(velocity, Vec3::ZERO);
    assert!(
        after.distance(before) < 1.5e-3,
        "{before}, {after}: a step of f32 at 10 km is 1 mm"
    );
}

#[test]
fn a_way_to_nowhere_is_logged_once() {
    let (mut app, entity) = scene();
    run(&mut app, 0.2, 64.0);
    let sound = |app: &App| {
        let places = drawn(app, entity);
        !places.is_empty() && places.iter().all(|place| place.length() < 10.0)
    };
    for way in [Vec3::NAN, Vec3::X * f32::INFINITY] {
        app.world_mut().write_message(WorldShift(way));
        let teleport = Teleport::of(entity).carrying(way);
        app.world_mut().write_message(teleport);
        step(&mut app, FRAME);
        assert!(sound(&app));
    }
    assert_eq!(log::count("`WorldShift` is"), 1);
    assert_eq!(log::count("`Teleport::particles`"), 1);
}

/// How many particles hang between two places along x, at rest.
fn between(app: &App, entity: Entity, from: f32, to: f32) -> usize {
    let places = particles(app, entity).positions().iter();
    places.filter(|p| p.x > from && p.x < to).count()
}

/// A nozzle from which particles drop, on an arm.
fn hanging() -> (App, Entity, Entity) {
    let (mut app, nozzle) = emitting(ParticleEmitter {
        rate: 1000.0,
        speed: 0.0,
        ..EXACT
    });
    let arm = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().entity_mut(arm).add_child(nozzle);
    run(&mut app, 0.5, 64.0);
    (app, nozzle, arm)
}

#[test]
fn h64_a_jump_leaves_no_trail() {
    // 3200 m/s: nothing needs to be told.
    let (mut app, nozzle, arm) = hanging();
    place(&mut app, arm).translation.x += 50.0;
    step(&mut app, FRAME);
    assert_eq!(between(&app, nozzle, 1e-3, 49.999), 0);
    assert!(between(&app, nozzle, 49.999, 50.001) >= 15);
    // 19 m/s is a motion, unless told otherwise: before, later or by a part of it.
    for told in [false, true] {
        let (mut app, nozzle, arm) = hanging();
        place(&mut app, arm).translation.x += 0.3;
        if told {
            app.world_mut().write_message(Teleport::of(arm));
        }
        step(&mut app, FRAME);
        let trail = between(&app, nozzle, 1e-3, 0.299);
        assert!(if told { trail == 0 } else { trail >= 14 }, "{trail}");
        // The next move is a motion again.
        place(&mut app, arm).translation.x += 0.3;
        step(&mut app, FRAME);
        assert!(between(&app, nozzle, 0.301, 0.599) >= 14);
    }
    // What is put elsewhere after the particles have moved is seen there, and did not move there.
    let (mut app, nozzle, arm) = hanging();
    app.add_systems(
        Last,
        move |mut transforms: Query<&mut Transform>, mut teleports: MessageWriter<Teleport>| {
            transforms.get_mut(arm).unwrap().translation.x += 0.3;
            teleports.write(Teleport::of(nozzle));
        },
    );
    for _ in 0..3 {
        step(&mut app, FRAME);
    }
    let at = |x: f32| between(&app, nozzle, x - 1e-3, x + 1e-3);
    assert!(at(0.3) >= 15 && at(0.6) >= 15);
    assert_eq!(between(&app, nozzle, 1e-3, 0.9), at(0.3) + at(0.6));
}

#[test]
fn how_fast_a_jump_is_is_a_setting() {
    let (mut app, nozzle, arm) = hanging();
    app.insert_resource(TeleportSettings {
        speed: f32::INFINITY,
    });
    place(&mut app, arm).translation.x += 50.0;
    step(&mut app, FRAME);
    assert!(between(&app, nozzle, 1e-3, 49.999) >= 14);
}

#[test]
fn a_teleport_takes_particles_along_or_leaves_them() {
    for (turn, way) in [
        (Quat::IDENTITY, vec3(50.0, 1.0, -2.0)),
        (Quat::from_rotation_z(PI / 2.0), vec3(0.0, 30.0, 0.0)),
    ] {
        let way = Isometry3d::new(way, turn);
        let (mut app, nozzle, arm) = hanging();
        let before = relative(&app, nozzle);
        let place_before = Isometry3d::default();
        *place(&mut app, arm) = Transform::from_isometry(way * place_before);
        app.world_mut()
            .write_message(Teleport::of(arm).carrying(way));
        // No time passes: everything is where it was, about the nozzle.
        step(&mut app, 0.0);
        let after = relative(&app, nozzle);
        let turned: Vec<_> = before.iter().map(|(p, v)| (turn * *p, turn * *v)).collect();
        assert_like(&after, &turned, "carried");
        app.world_mut().write_message(Teleport::of(nozzle));
        step(&mut app, 0.0);
        assert_eq!(relative(&app, nozzle), after);
    }
}

/// 500 particles at rest on a floor, `frames` a second, and the floor.
fn resting(app_rate: f32) -> (App, Entity, Entity) {
    let (mut app, entity) = emitting(ParticleEmitter {
        nozzle_radius: 0.5,
        speed: 0.0,
        rate: 0.0,
        pending_burst: 500,
        ..EXACT
    });
    place(&mut app, entity).translation.y = 0.1;
    let floor = app.world_mut().spawn(ParticleCollider {
        restitution: 0.2,
        ..ParticleCollider::ground()
    });
    let floor = floor.id();
    run(&mut app, 2.0, app_rate);
    assert!(fastest(&app, entity) < 1e-3);
    (app, entity, floor)
}

fn fastest(app: &App, entity: Entity) -> f32 {
    let velocities = particles(app, entity).velocities().iter();
    velocities.map(|v| v.length()).fold(0.0, f32::max)
}

fn lowest(app: &App, entity: Entity) -> f32 {
    let places = particles(app, entity).positions().iter();
    places.map(|p| p.y).fold(f32::INFINITY, f32::min)
}

#[test]
fn a_floor_that_jumps_throws_nothing() {
    // At 60 frames a second a metre is 60 m/s: a jump. At 20 it has to be told.
    for (frames, told) in [(60.0, false), (20.0, true)] {
        let (mut app, entity, floor) = resting(frames);
        for way in [1.0, -1.0] {
            place(&mut app, floor).translation.y += way;
            if told {
                app.world_mut().write_message(Teleport::of(floor));
            }
            step(&mut app, 1.0 / frames);
            assert!(fastest(&app, entity) < 1.0, "{}", fastest(&app, entity));
            let height = place(&mut app, floor).translation.y;
            assert!(lowest(&app, entity) > height + 0.0199);
        }
    }
    // As a motion it throws them up.
    let (mut app, entity, floor) = resting(20.0);
    place(&mut app, floor).translation.y += 1.0;
    step(&mut app, 0.05);
    assert!(fastest(&app, entity) > 20.0);
    assert!(lowest(&app, entity) > 1.0199);
}

/// A plate under the particles that is turned over in a frame is where it was.
#[test]
fn what_is_turned_over_throws_nothing() {
    let (mut app, entity, floor) = resting(60.0);
    app.world_mut()
        .entity_mut(floor)
        .insert(ParticleCollider::new(Cuboid::new(4.0, 0.2, 4.0)));
    place(&mut app, floor).translation.y = -0.1;
    run(&mut app, 0.1, 60.0);
    place(&mut app, floor).rotate_x(PI);
    step(&mut app, 1.0 / 60.0);
    assert!(fastest(&app, entity) < 0.1, "{}", fastest(&app, entity));
    assert!(lowest(&app, entity) > 0.0199);
}
