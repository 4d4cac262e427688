//! Emitters and colliders in a hierarchy whose scale changes, passes zero and mirrors.

use super::*;

const FRAME: f32 = 1.0 / 64.0;

/// A scale through zero, with a frame there and without one on the way back, along these axes.
fn scales(axes: Vec3) -> impl Iterator<Item = Vec3> {
    let there = (-8..=8).map(|i| i as f32 / 8.0);
    let back = (-8..8).rev().map(|i| (i as f32 + 0.5) / 8.0);
    there
        .chain(back)
        .map(move |scale| Vec3::ONE + (scale - 1.0) * axes)
}

#[test]
fn h72_particles_come_out_where_the_nozzle_points() {
    for axes in [Vec3::ONE, Vec3::X, Vec3::Y, vec3(1.0, 0.0, 1.0)] {
        let (mut app, nozzle) = emitting(ParticleEmitter {
            rate: 640.0,
            speed: 2.0,
            direction: vec3(0.0, 1.0, 0.0),
            gravity: Vec3::ZERO,
            ..EXACT
        });
        // The log is the whole process's: the emitter's name is that of no other test's.
        let nozzle = {
            let emitter = *emitter(&mut app, nozzle);
            let world = app.world_mut();
            world.despawn(nozzle);
            world.spawn_batch((0..2345).map(|_| ())).for_each(drop);
            world.spawn(emitter).remove::<SurfaceKernel>().id()
        };
        let arm = app.world_mut().spawn(Transform::default()).id();
        app.world_mut().entity_mut(arm).add_child(nozzle);
        *place(&mut app, nozzle) =
            Transform::from_xyz(1.0, 0.0, 0.0).with_rotation(Quat::from_rotation_x(0.5));
        for scale in scales(axes) {
            place(&mut app, arm).scale = scale;
            step(&mut app, FRAME);
            let particles = particles(&app, nozzle);
            if scale.x * scale.y * scale.z == 0.0 {
                assert!(particles.is_empty(), "there is nothing at {scale}");
                continue;
            }
            let nozzle = app.world().get::<GlobalTransform>(nozzle).unwrap();
            let direction = nozzle.affine().transform_vector3(Vec3::Y).normalize();
            let young: Vec<_> = particles
                .velocities()
                .iter()
                .zip(particles.ages())
                .filter(|(_, age)| **age < 0.999 * FRAME)
                .map(|(velocity, _)| velocity.normalize())
                .collect();
            assert!(young.len() >= 9, "{} at {scale}", young.len());
            // Within what it turned since the last frame.
            let off = young.iter().map(|it| it.angle_between(direction));
            let off = off.fold(0.0, f32::max);
            assert!(off < 0.6, "{off} rad off at {scale}");
            let last = young[young.len() - 1].angle_between(direction);
            assert!(last < 0.1, "the last {last} rad off at {scale}");
        }
    }
}

#[test]
fn h72_a_solid_that_vanishes_and_mirrors_throws_nothing() {
    for axes in [Vec3::ONE, Vec3::X, Vec3::Y] {
        let (mut app, entity) = emitting(ParticleEmitter {
            nozzle_radius: 0.4,
            speed: 0.0,
            rate: 0.0,
            gravity: Vec3::ZERO,
            pending_burst: 500,
            ..EXACT
        });
        let arm = app.world_mut().spawn(Transform::from_xyz(0.0, -1.0, 0.0));
        let arm = arm.id();
        let plate: ParticleCollider = Cuboid::new(1.0, 0.5, 1.0).into();
        let plate = app
            .world_mut()
            .spawn((plate, Transform::from_xyz(0.3, 0.0, 0.0)));
        let plate = plate.id();
        app.world_mut().entity_mut(arm).add_child(plate);
        step(&mut app, FRAME);
        for scale in scales(axes) {
            place(&mut app, arm).scale = scale;
            // It goes away where it has no extent.
            place(&mut app, arm).translation.y = if scale.element_product() == 0.0 {
                -9.0
            } else {
                -1.0
            };
            step(&mut app, FRAME);
            let still = particles(&app, entity).velocities().iter();
            assert!(still.clone().all(|v| v.length() < 1e-3), "at {scale}");
        }
    }
}

/// What goes with a despawned parent, and what stays when an emitter is no more.
#[test]
fn particles_go_with_their_entity_and_stay_without_their_emitter() {
    let (mut app, nozzle) = emitting(EXACT);
    let arm = app.world_mut().spawn(Transform::default()).id();
    app.world_mut().entity_mut(arm).add_child(nozzle);
    run(&mut app, 0.5, 64.0);
    let count = |app: &mut App| {
        let mut fluids = app.world_mut().query::<&FluidParticles>();
        let fluids = fluids.iter(app.world());
        fluids.map(|fluid| fluid.positions.len()).sum::<usize>()
    };
    assert_eq!(count(&mut app), 500);
    // Stopped, they fly on.
    emitter(&mut app, nozzle).stop();
    let before = drawn(&app, nozzle);
    step(&mut app, FRAME);
    assert_eq!(count(&mut app), 500);
    assert_ne!(drawn(&app, nozzle), before);
    // Without it, they hang where they are, and still come along with the world.
    app.world_mut()
        .entity_mut(nozzle)
        .remove::<ParticleEmitter>();
    let before = drawn(&app, nozzle);
    app.world_mut().write_message(WorldShift(Vec3::X * 1024.0));
    step(&mut app, FRAME);
    let moved = before.iter().map(|p| *p + Vec3::X * 1024.0);
    assert_eq!(drawn(&app, nozzle), moved.collect::<Vec<_>>());
    app.world_mut().despawn(arm);
    step(&mut app, FRAME);
    assert_eq!(count(&mut app), 0);
}
