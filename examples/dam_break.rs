//! A dam breaks in a glass tank: salva3d simulates, `bevy_fluid` draws.
//!
//! Liquid runs past an opaque pillar that stands in it; a ball lies in front of the tank, pillars
//! stand behind it. Turn the camera with the mouse; press R to start over. `--out FILE.png
//! [--frames N]` writes a picture instead.

use bevy::{math::bounding::Aabb3d, prelude::*};
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins,
    scenery::{Scenery, frame_camera, orbit_camera},
    simulation::{Simulation, cylinder, dam},
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

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 45,
        title: "dam break · bevy_fluid".into(),
        ..default()
    };
    App::new()
        .add_plugins((stage.with_args(), FluidPlugin::default()))
        .insert_resource(dam_break())
        .add_systems(Startup, setup)
        .add_systems(Update, restart)
        .add_systems(PostUpdate, simulate.in_set(FluidSystems::Simulate))
        .run()
}

fn dam_break() -> Simulation {
    let pillar = cylinder(PILLAR, TANK.y, RADIUS);
    Simulation::new(TANK, RADIUS, dam(TANK, DAM, RADIUS), pillar)
}

fn setup(mut scenery: Scenery, water: Res<Simulation>) {
    let inside = Aabb3d::new(Vec3::Y * 0.5 * TANK.y, 0.5 * TANK);
    scenery.checker_floor(Vec3::ZERO, 5.0, 20);
    scenery.pillars(inside, 5);
    scenery.tank(inside);
    scenery.sun(TO_SUN, 6.0, true);
    let sky = scenery.sky(TO_SUN);

    let (foot, radius) = PILLAR;
    opaque(
        &mut scenery,
        Cylinder::new(radius, TANK.y * 0.9),
        vec3(foot.x, 0.45 * TANK.y, foot.y),
        Color::srgb(0.9, 0.45, 0.1),
    );
    opaque(
        &mut scenery,
        Sphere::new(0.2),
        vec3(-0.35, 0.2, 0.5 * TANK.z + 0.45),
        Color::srgb(0.75, 0.1, 0.2),
    );

    scenery.commands.spawn((
        FluidParticles::new(water.positions(), RADIUS),
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

fn opaque(scenery: &mut Scenery, shape: impl Into<Mesh>, at: Vec3, color: Color) {
    let mesh = scenery.meshes.add(shape);
    let material = scenery.materials.add(color);
    scenery.commands.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Transform::from_translation(at),
    ));
}

fn simulate(
    mut water: ResMut<Simulation>,
    mut fluids: Query<&mut FluidParticles>,
    time: Res<Time>,
) {
    if time.delta_secs() == 0.0 {
        return;
    }
    water.step(time.delta_secs());
    for mut fluid in &mut fluids {
        water.write_positions(&mut fluid.positions);
    }
}

fn restart(mut water: ResMut<Simulation>, keys: Res<ButtonInput<KeyCode>>) {
    if keys.just_pressed(KeyCode::KeyR) {
        *water = dam_break();
    }
}
