//! A dam breaks in a glass tank, simulated live; a crate, a plank and a ball are carried away.
//!
//! Liquid runs past an opaque pillar; a ball lies in front of the tank, pillars stand behind it.
//! Turn the camera with the mouse; press R to start over. `--out FILE.png [--frames N]` writes a
//! picture instead.

use bevy::{math::bounding::Aabb3d, prelude::*};
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins, dam,
    scenery::{Scenery, frame_camera, orbit_camera},
};

/// Inside of the tank, m.
const TANK: Vec3 = vec3(2.4, 1.3, 1.0);
/// The dam: width and height of the block of water at the left wall, as deep as the tank.
const DAM: Vec2 = vec2(0.95, 1.05);
/// Particle radius, m: about 8,000 particles fill the dam.
const RADIUS: f32 = 0.025;
/// The pillar in the tank: its foot's centre and its radius.
const PILLAR: (Vec2, f32) = (vec2(0.45, -0.1), 0.13);
const TO_SUN: Vec3 = vec3(0.55, 0.9, 0.45);

/// A floating body and its initial transform.
#[derive(Component)]
struct Floating(Transform);

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 60,
        title: "dam break · bevy_fluid".into(),
        ..default()
    };
    let stage = stage.with_args();
    let mode = match stage.out {
        // A picture needs the simulation in step with its frames.
        Some(_) => SalvaMode::Lockstep,
        None => SalvaMode::Background,
    };
    App::new()
        .add_plugins((stage, FluidPlugin::default(), SalvaPlugin))
        .insert_resource(SalvaSettings { mode, ..default() })
        .add_systems(Startup, setup)
        .add_systems(Update, restart)
        .run()
}

fn water() -> Vec<Vec3> {
    dam(TANK, DAM, RADIUS)
}

fn setup(mut scenery: Scenery) {
    let inside = Aabb3d::new(Vec3::Y * 0.5 * TANK.y, 0.5 * TANK);
    scenery.checker_floor(Vec3::ZERO, 5.0, 20);
    scenery.pillars(inside, 5);
    scenery.tank(inside);
    scenery.sun(TO_SUN, 6.0, true);
    let sky = scenery.sky(TO_SUN);

    // Walls twice as high for the water: nothing spills.
    let walls = TANK * vec3(1.0, 2.0, 1.0);
    scenery.commands.spawn((
        SalvaBoundary::tank(walls),
        Transform::from_xyz(0.0, TANK.y, 0.0),
    ));
    let (foot, radius) = PILLAR;
    let height = TANK.y * 0.9;
    let at = Transform::from_xyz(foot.x, 0.5 * height, foot.y);
    let orange = Color::srgb(0.9, 0.45, 0.1);
    let pillar = Cylinder::new(radius, height);
    opaque(&mut scenery, pillar, at, orange).insert(SalvaBoundary::new(pillar));
    let ball = Transform::from_xyz(-0.35, 0.2, 0.5 * TANK.z + 0.45);
    let red = Color::srgb(0.75, 0.1, 0.2);
    opaque(&mut scenery, Sphere::new(0.2), ball, red);

    float(&mut scenery);
    scenery.commands.spawn((
        FluidParticles::new(water(), RADIUS),
        SalvaFluid::WATER,
        FluidMaterial {
            // A lake's water, so that depth shows in a tank.
            medium: Medium::absorbing(LinearRgba::rgb(0.3, 0.72, 0.8), 1.0),
            ..FluidMaterial::WATER
        },
    ));
    let (eye, target) = frame_camera(inside, 0.7, 16.0 / 9.0);
    scenery.commands.spawn((
        orbit_camera(eye, target),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
}

fn float(scenery: &mut Scenery) {
    let shape = Cuboid::from_length(0.26);
    let at = Transform::from_xyz(0.95, 0.13, 0.22).with_rotation(Quat::from_rotation_y(0.4));
    let wood = Color::srgb(0.55, 0.34, 0.16);
    let body = SalvaBody::new(shape, 350.0);
    opaque(scenery, shape, at, wood).insert((body, Floating(at)));

    let plank = Cuboid::new(0.5, 0.06, 0.16);
    let at = Transform::from_xyz(0.1, 0.03, 0.25).with_rotation(Quat::from_rotation_y(-0.5));
    let pine = Color::srgb(0.8, 0.62, 0.36);
    let body = SalvaBody::new(plank, 450.0);
    opaque(scenery, plank, at, pine).insert((body, Floating(at)));

    let ball = Sphere::new(0.11);
    let at = Transform::from_xyz(0.9, ball.radius, -0.25);
    let body = SalvaBody::new(ball, 250.0);
    let yellow = Color::srgb(0.95, 0.75, 0.1);
    opaque(scenery, ball, at, yellow).insert((body, Floating(at)));
}

fn opaque<'a>(
    scenery: &'a mut Scenery,
    shape: impl Into<Mesh>,
    at: Transform,
    color: Color,
) -> EntityCommands<'a> {
    let mesh = scenery.meshes.add(shape);
    let material = scenery.materials.add(color);
    scenery
        .commands
        .spawn((Mesh3d(mesh), MeshMaterial3d(material), at))
}

/// Restarts the scene: the simulation takes over positions and transforms written by others, at
/// rest.
fn restart(
    mut fluids: Query<&mut FluidParticles>,
    mut floating: Query<(&Floating, &mut Transform)>,
    keys: Res<ButtonInput<KeyCode>>,
) {
    if !keys.just_pressed(KeyCode::KeyR) {
        return;
    }
    for mut fluid in &mut fluids {
        fluid.positions = water();
    }
    for (start, mut transform) in &mut floating {
        *transform = start.0;
    }
}
