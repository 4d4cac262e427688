//! Motion vectors of the liquid against those of meshes at the same place, and what reads them.

mod antialiasing;
mod read;

use bevy::{
    core_pipeline::prepass::{MotionVectorPrepass, NoBackgroundMotionVectors},
    prelude::*,
    render::camera::TemporalJitter,
};
use bevy_fluid::{
    particles::ParticleSpace,
    prelude::*,
    render::{Surface, TextureMemory},
};
use core::time::Duration;
use fluid_stage::{set_time_step, settle, step};

use self::read::motion_vectors;
use crate::common::*;

const VIEW: View = View::new(
    96,
    Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
);
const RADIUS: f32 = 0.6;
const FRAME: f32 = 1.0 / 60.0;

/// What is drawn at a place: liquid, or a mesh of the same shape.
#[derive(Clone, Copy, PartialEq)]
enum Thing {
    Liquid,
    Mesh,
}

const BOTH: [Thing; 2] = [Thing::Liquid, Thing::Mesh];

/// A ball about its entity: one particle, or a mesh.
fn spawn(world: &mut World, thing: Thing, place: Transform) -> Entity {
    if thing == Thing::Liquid {
        let ball = fluid(&[Vec3::ZERO], RADIUS, BULK);
        return world.spawn((ball, place)).id();
    }
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(RADIUS).mesh().uv(128, 64));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    world
        .spawn((Mesh3d(mesh), MeshMaterial3d(material), place))
        .id()
}

/// A camera that has motion vectors, and a ball.
fn ball(thing: Thing, settings: ScreenSpaceFluid, place: Transform) -> (App, Entity) {
    let mut ball = Entity::PLACEHOLDER;
    let mut app = show(&VIEW, settings, |world| ball = spawn(world, thing, place));
    look(&mut app, MotionVectorPrepass);
    set_time_step(&mut app, Duration::from_secs_f32(FRAME));
    (app, ball)
}

fn place(app: &mut App, entity: Entity, place: Transform) {
    *app.world_mut().get_mut::<Transform>(entity).unwrap() = place;
}

/// Where a ball of 0.6 m is seen, a pixel off its silhouette.
fn seen_ball(center: Vec3, pixel: UVec2) -> bool {
    let ndc = (pixel.as_vec2() + 0.5) / VIEW.size.as_vec2() * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    let ray = (ndc * (0.5_f32 * 0.7).tan()).extend(-1.0).normalize();
    let away = (center - center.dot(ray) * ray).length();
    away < RADIUS - center.length() * 0.7 / VIEW.size.y as f32
}

/// The vectors of the pixels that show a ball at `center`, one frame after `moves`.
fn after(app: &mut App, center: Vec3, moves: impl FnOnce(&mut App)) -> Vec<Vec2> {
    step(app, 2);
    moves(app);
    step(app, 1);
    assert_sound(app);
    let vectors = motion_vectors(app);
    let seen = pixels(VIEW.size).filter(|it| seen_ball(center, *it));
    seen.map(|it| vectors[(it.y * VIEW.size.x + it.x) as usize])
        .collect()
}

/// Asserts that liquid moves as a mesh does, within a part of a pixel, and that it moves at all.
#[track_caller]
fn assert_equal(liquid: &[Vec2], mesh: &[Vec2], within: f32) {
    assert!(liquid.len() > 500, "{}", liquid.len());
    let mean = mesh.iter().map(|it| it.length()).sum::<f32>() / mesh.len() as f32;
    assert!(mean > 1.5, "{mean}");
    for (liquid, mesh) in liquid.iter().zip(mesh) {
        let error = liquid.distance(*mesh);
        assert!(error < within, "{liquid}, not {mesh}");
    }
}

const AT: Vec3 = vec3(0.3, -0.2, -4.0);

#[test]
fn a_still_liquid_moves_on_screen_as_a_mesh_when_the_camera_moves() {
    // It may lie anywhere, where f32 holds fractions of a millimetre.
    for origin in [Vec3::ZERO, vec3(3000.0, -500.0, 4000.0)] {
        let [liquid, mesh] = BOTH.map(|thing| {
            let at = |way: Vec3, turn: f32| {
                Transform::from_translation(origin + way).with_rotation(Quat::from_rotation_y(turn))
            };
            let (mut app, _) = ball(thing, RAW, at(AT, 0.0));
            let camera = only::<Camera3d>(&mut app);
            place(&mut app, camera, at(vec3(0.1, 0.05, -0.2), 0.03));
            after(&mut app, AT, |app| place(app, camera, at(Vec3::ZERO, 0.0)))
        });
        assert_equal(&liquid, &mesh, 0.1);
    }
}

#[test]
fn a_fluid_that_is_moved_turned_and_scaled_has_the_vectors_of_a_mesh() {
    let before = Transform {
        translation: AT + vec3(-0.3, 0.1, 0.2),
        rotation: Quat::from_rotation_z(0.2) * Quat::from_rotation_x(0.1),
        scale: Vec3::splat(0.9),
    };
    let [liquid, mesh] = BOTH.map(|thing| {
        let (mut app, ball) = ball(thing, RAW, before);
        after(&mut app, AT, |app| {
            place(app, ball, Transform::from_translation(AT));
        })
    });
    assert_equal(&liquid, &mesh, 0.1);
}

/// Smoothing moves the surface, and particles are smaller than what they make up.
#[test]
fn a_smooth_body_of_particles_has_the_vectors_of_a_mesh() {
    let before = Transform {
        translation: AT + vec3(-0.1, 0.05, 0.1),
        rotation: Quat::from_rotation_y(0.1),
        ..default()
    };
    let [liquid, mesh] = BOTH.map(|thing| {
        let (mut app, mut entity) = ball(thing, ScreenSpaceFluid::default(), before);
        if thing == Thing::Liquid {
            let particles = FluidParticles::new(fluid_stage::ball(RADIUS, 0.05), 0.05);
            pour(&mut app, (particles, before));
            entity = only::<FluidParticles>(&mut app);
        }
        after(&mut app, AT, |app| {
            place(app, entity, Transform::from_translation(AT));
        })
    });
    assert_equal(&liquid, &mesh, 0.5);
    let errors = liquid.iter().zip(&mesh).map(|(a, b)| a.distance(*b));
    let mean = errors.sum::<f32>() / mesh.len() as f32;
    assert!(mean < 0.1, "{mean} pixels");
}

/// Moves the only particle of a fluid, whose columns `more` fills.
fn move_particle(app: &mut App, way: Vec3, more: impl FnOnce(&mut FluidParticles)) {
    let fluid = only::<FluidParticles>(app);
    let mut particles = app.world_mut().get_mut::<FluidParticles>(fluid).unwrap();
    particles.positions[0] += way;
    more(&mut particles);
}

#[test]
fn particles_have_the_vectors_of_a_mesh_by_their_velocities_or_ids() {
    let way = vec3(0.2, 0.1, 0.15);
    let start = Transform::from_translation(AT - way);
    let (mut app, entity) = ball(Thing::Mesh, RAW, start);
    let mesh = after(&mut app, AT, |app| {
        place(app, entity, Transform::from_translation(AT));
    });

    let moved = |more: fn(&mut FluidParticles)| {
        let (mut app, _) = ball(Thing::Liquid, RAW, start);
        // Without effect before it moves.
        move_particle(&mut app, Vec3::ZERO, more);
        after(&mut app, AT, |app| move_particle(app, way, more))
    };
    let by_id = moved(|particles| particles.ids = vec![7]);
    assert_equal(&by_id, &mesh, 0.1);
    let by_velocity = moved(|particles| {
        particles.velocities = vec![vec3(0.2, 0.1, 0.15) / FRAME];
    });
    assert_equal(&by_velocity, &mesh, 0.1);
    // It is not known to have moved.
    let by_neither = moved(|_| ());
    assert!(by_neither.iter().all(|it| it.length() < 0.01));
}

#[test]
fn particles_that_rest_again_have_no_vectors() {
    let (mut app, _) = ball(Thing::Liquid, RAW, Transform::from_translation(AT));
    let ids = |particles: &mut FluidParticles| particles.ids = vec![7];
    move_particle(&mut app, Vec3::ZERO, ids);
    let moved = after(&mut app, AT, |app| {
        move_particle(app, Vec3::X * 0.1, ids);
    });
    assert!(moved.iter().any(|it| it.length() > 1.0));
    let rests = after(&mut app, AT + Vec3::X * 0.1, |_| ());
    assert!(rests.iter().all(|it| *it == Vec2::ZERO));
}

#[test]
fn jitter_is_no_motion() {
    let (mut app, _) = ball(
        Thing::Liquid,
        ScreenSpaceFluid::default(),
        Transform::from_translation(AT),
    );
    for offset in [vec2(0.3, -0.4), vec2(-0.45, 0.1), vec2(0.0, 0.5)] {
        look(&mut app, TemporalJitter { offset });
        let still = after(&mut app, AT, |_| ());
        let most = still.iter().map(|it| it.length()).fold(0.0, f32::max);
        assert!(most < 0.01, "{offset}: {most} pixels");
    }
}

/// A floating origin moves everything, which is no motion.
#[test]
fn a_shift_of_the_world_is_no_motion() {
    for space in [ParticleSpace::Local, ParticleSpace::World] {
        let mut app = show(&VIEW, RAW, |world| {
            let mut particles = FluidParticles::new(vec![Vec3::ZERO], RADIUS);
            particles.space = space;
            particles.ids = vec![1];
            let mut place = Transform::from_translation(AT);
            if space == ParticleSpace::World {
                particles.positions[0] = AT;
                place = Transform::IDENTITY;
            }
            world.spawn((particles, BULK, place));
        });
        look(&mut app, MotionVectorPrepass);
        let shifted = after(&mut app, AT, |app| {
            let way = vec3(512.0, 0.0, -256.0);
            let world = app.world_mut();
            let mut all = world.query::<&mut Transform>();
            for mut place in all.iter_mut(world) {
                place.translation += way;
            }
            world.write_message(WorldShift(way));
        });
        let most = shifted.iter().map(|it| it.length()).fold(0.0, f32::max);
        assert!(most < 0.05, "{space:?}: {most} pixels");
    }
}

#[test]
fn multisampled_vectors_are_the_same() {
    let [single, multi] = [Msaa::Off, Msaa::Sample4].map(|msaa| {
        let before = Transform::from_translation(AT + vec3(0.2, 0.1, 0.3));
        let (mut app, ball) = ball(Thing::Liquid, RAW, before);
        look(&mut app, msaa);
        after(&mut app, AT, |app| {
            place(app, ball, Transform::from_translation(AT));
        })
    });
    assert_equal(&multi, &single, 0.001);
}

/// What is in front of the liquid, and beside it, keeps its own vectors.
#[test]
fn a_still_mesh_before_a_moving_liquid_keeps_its_vectors() {
    let before = Transform::from_translation(AT + vec3(0.3, 0.0, 0.0));
    let (mut app, ball) = ball(Thing::Liquid, ScreenSpaceFluid::default(), before);
    let at = Transform::from_translation(AT * 0.5);
    spawn_box(app.world_mut(), vec3(0.2, 0.2, 0.02), at);
    settle(&mut app).unwrap();
    let vectors = after(&mut app, AT, |app| {
        place(app, ball, Transform::from_translation(AT));
    });
    let still = vectors.iter().filter(|it| **it == Vec2::ZERO).count();
    let moving = vectors.iter().filter(|it| it.length() > 4.0).count();
    assert!(still > 150 && moving > 500, "{still} {moving}");
    assert_eq!(still + moving, vectors.len());
}

/// Surfaces write their depth after all are painted, and their vectors where their own depth is left.
#[test]
fn each_of_two_liquids_has_its_own_vectors() {
    let before = Transform::from_translation(AT + vec3(0.2, 0.0, 0.1));
    let beside = vec3(-0.7, 0.5, -5.0);
    let [liquid, mesh] = BOTH.map(|thing| {
        let (mut app, ball) = ball(thing, RAW, before);
        let milk = spawn(
            app.world_mut(),
            Thing::Liquid,
            Transform::from_translation(beside),
        );
        app.world_mut().entity_mut(milk).insert(FluidMaterial::MILK);
        settle(&mut app).unwrap();
        let move_ball = |app: &mut App| place(app, ball, Transform::from_translation(AT));
        let ball = after(&mut app, AT, move_ball);
        let vectors = motion_vectors(&app);
        let still = pixels(VIEW.size)
            .filter(|it| seen_ball(beside, *it) && !seen_ball(AT, *it))
            .filter(|it| vectors[(it.y * VIEW.size.x + it.x) as usize] == Vec2::ZERO);
        assert!(still.count() > 200);
        ball
    });
    assert_equal(&liquid, &mesh, 0.1);
}

/// There is no front, and what is seen is its far surface.
#[test]
fn an_eye_in_moving_liquid_has_vectors_that_are_numbers() {
    let before = Transform::from_xyz(0.1, 0.0, 0.2);
    let (mut app, ball) = ball(Thing::Liquid, RAW, before);
    step(&mut app, 2);
    place(&mut app, ball, default());
    step(&mut app, 1);
    assert_sound(&app);
    let vectors = motion_vectors(&app);
    assert!(vectors.iter().all(|it| it.is_finite()));
    let moving = vectors.iter().filter(|it| it.length() > 1.0).count();
    assert!(moving > 1000, "{moving}");
}

#[test]
fn textures_for_motion_are_there_while_a_camera_asks_for_it() {
    let mut app = show(&VIEW, RAW, |world| {
        spawn(world, Thing::Liquid, Transform::from_translation(AT));
    });
    let bytes = |app: &App| app.world().resource::<TextureMemory>().bytes();
    let asks = |app: &App| {
        let (surface, _): (&Surface, _) = surface(app);
        surface.plan().unwrap().motion_vectors
    };
    let before = bytes(&app);
    assert!(!asks(&app));
    // Bevy itself does not bear that motion vectors are removed, but for those of the background.
    look(&mut app, (MotionVectorPrepass, NoBackgroundMotionVectors));
    assert!(asks(&app) && bytes(&app) > before);
    let camera = only::<Camera3d>(&mut app);
    app.world_mut()
        .entity_mut(camera)
        .remove::<MotionVectorPrepass>();
    settle(&mut app).unwrap();
    assert_sound(&app);
    assert!(!asks(&app));
    assert_eq!(bytes(&app), before);
}
