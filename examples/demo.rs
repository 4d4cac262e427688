//! The demo: water at rest in a glass tank, then a breaking dam that runs around a pillar.
//!
//! Turn the camera with the mouse; press R to fill the dam again. `--out FILE.png [--frames N]` writes
//! a picture instead, with `--frames 0` of the water at rest. Try `FluidMaterial::MILK`.

mod simulation;

use std::{
    iter,
    sync::{
        Mutex,
        mpsc::{Receiver, sync_channel},
    },
    thread,
};

use bevy::{math::bounding::Aabb3d, prelude::*};
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins, cylinder, dam,
    scenery::{Scenery, frame_camera, orbit_camera},
};

use simulation::Simulation;

/// Inside of the tank, m.
const TANK: Vec3 = vec3(1.6, 0.9, 0.7);
/// The dam: width and height of the block of water at the left wall, as deep as the tank.
const DAM: Vec2 = vec2(0.6, 0.7);
/// Particle radius, m: about 4,600 particles fill the dam.
const RADIUS: f32 = 0.02;
/// The pillar in the tank: its foot's centre and its radius.
const PILLAR: (Vec2, f32) = (vec2(0.3, -0.06), 0.09);
const TO_SUN: Vec3 = vec3(0.55, 0.9, 0.45);
/// Simulated frames a second.
const RATE: f64 = 60.0;
/// Frames that the water rests in a window before the dam breaks.
const REST: usize = 90;

/// Positions of the particles, one frame after the other, from a thread that simulates them.
#[derive(Resource)]
struct Water {
    frames: Mutex<Receiver<Vec<Vec3>>>,
    /// Whether the picture waits for the next frame; a window goes on without it.
    waits: bool,
}

impl Water {
    fn new(waits: bool) -> Self {
        let (sender, frames) = sync_channel(1);
        let rest = if waits { 0 } else { REST };
        thread::spawn(move || {
            let start = dam(TANK, DAM, RADIUS);
            let pillar = cylinder(PILLAR, TANK.y, RADIUS);
            let mut simulation = Simulation::new(TANK, RADIUS, start.clone(), pillar);
            let flowing = iter::repeat_with(|| {
                simulation.step(RATE.recip() as f32);
                simulation.positions()
            });
            for frame in iter::repeat_n(start, rest).chain(flowing) {
                // Nobody receives it once the dam has been filled again.
                if sender.send(frame).is_err() {
                    break;
                }
            }
        });
        let frames = Mutex::new(frames);
        Self { frames, waits }
    }

    fn next(&mut self) -> Option<Vec<Vec3>> {
        let frames = self.frames.get_mut().ok()?;
        if self.waits {
            frames.recv().ok()
        } else {
            frames.try_recv().ok()
        }
    }
}

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 55,
        size: uvec2(960, 540),
        title: "bevy_fluid".into(),
        ..default()
    };
    let stage = stage.with_args();
    let is_picture = stage.out.is_some();
    App::new()
        .add_plugins((stage, FluidPlugin::default()))
        .insert_resource(Time::<Fixed>::from_hz(RATE))
        .insert_resource(Water::new(is_picture))
        .add_systems(Startup, setup)
        .add_systems(FixedUpdate, flow)
        .add_systems(Update, fill_again)
        .run()
}

fn setup(mut scenery: Scenery) {
    let inside = Aabb3d::new(Vec3::Y * 0.5 * TANK.y, 0.5 * TANK);
    scenery.checker_floor(Vec3::ZERO, 4.0, 20);
    scenery.pillars(inside, 5);
    scenery.tank(inside);
    scenery.sun(TO_SUN, 6.0, true);
    let sky = scenery.sky(TO_SUN);

    let (foot, radius) = PILLAR;
    let height = 0.9 * TANK.y;
    let pillar = scenery.meshes.add(Cylinder::new(radius, height));
    let orange = scenery.materials.add(Color::srgb(0.9, 0.45, 0.1));
    scenery.commands.spawn((
        Mesh3d(pillar),
        MeshMaterial3d(orange),
        Transform::from_xyz(foot.x, 0.5 * height, foot.y),
    ));

    scenery.commands.spawn((
        FluidParticles::new(dam(TANK, DAM, RADIUS), RADIUS),
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

fn flow(mut water: ResMut<Water>, mut fluid: Single<&mut FluidParticles>) {
    if let Some(positions) = water.next() {
        fluid.positions = positions;
    }
}

fn fill_again(mut water: ResMut<Water>, keys: Res<ButtonInput<KeyCode>>) {
    if keys.just_pressed(KeyCode::KeyR) {
        *water = Water::new(water.waits);
    }
}
