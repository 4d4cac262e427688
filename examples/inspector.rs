//! The inspector's window over a pool, a ball and a few drops of water.
//!
//! F1 closes and opens it; the mouse turns the camera outside the window. Press Tab to go from
//! setting to setting, arrows to change one. `--out FILE.png` writes a picture instead.
//!
//! Needs `--features inspector`.

use bevy::prelude::*;
use bevy_fluid::{
    inspector::{FluidInspectorPlugin, inspector_wants_pointer},
    prelude::*,
};
use fluid_stage::{
    StagePlugins,
    scenery::{PanOrbitCameraSystemSet, Scenery, orbit_camera},
};

/// Particle radius, m.
const RADIUS: f32 = 0.03;
const TO_SUN: Vec3 = vec3(0.4, 0.8, 0.5);

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 40,
        title: "inspector · bevy_fluid".into(),
        ..default()
    };
    App::new()
        .add_plugins((
            stage.with_args(),
            FluidPlugin::default(),
            FluidInspectorPlugin {
                open: true,
                ..default()
            },
        ))
        .configure_sets(
            PostUpdate,
            // Over the window, the mouse does not move the camera.
            PanOrbitCameraSystemSet.run_if(not(inspector_wants_pointer)),
        )
        .add_systems(Startup, setup)
        .add_systems(Update, wave)
        .run()
}

fn setup(mut scenery: Scenery) {
    scenery.checker_floor(Vec3::ZERO, 8.0, 24);
    scenery.sun(TO_SUN, 10.0, true);
    let sky = scenery.sky(TO_SUN);
    scenery.commands.spawn((
        Name::new("pool and drops"),
        FluidParticles::new(pool(0.0), RADIUS),
        FluidMaterial {
            // A lake's water, so that depth shows.
            medium: Medium::absorbing(LinearRgba::rgb(0.25, 0.7, 0.8), 1.0),
            ..FluidMaterial::WATER
        },
    ));
    scenery.commands.spawn((
        Name::new("ball"),
        FluidParticles::new(fluid_stage::ball(0.36, RADIUS), RADIUS),
        FluidMaterial::WATER,
        Transform::from_xyz(0.2, 0.95, 0.0),
    ));
    scenery.commands.spawn((
        Name::new("main camera"),
        orbit_camera(vec3(0.2, 1.7, 3.6), vec3(-0.65, 0.45, 0.0)),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
}

/// A pool with a standing wave, and drops above it.
fn pool(seconds: f32) -> Vec<Vec3> {
    let spacing = 2.0 * RADIUS;
    let drops = (0..9).map(|i| {
        let around = Vec2::from_angle(2.4 * i as f32) * 0.15 * (1.0 + i as f32).sqrt();
        vec3(0.2 + around.x, 0.55 + 0.03 * (i % 3) as f32, around.y)
    });
    (0..36 * 7 * 20)
        .map(|i| uvec3(i % 36, i / 36 % 7, i / (36 * 7)).as_vec3())
        .map(|cell| (cell - vec3(17.5, -0.5, 9.5)) * spacing + Vec3::X * 0.2)
        .map(|p| {
            let wave = 1.0 + 0.2 * (4.0 * p.x).cos() * (3.0 * seconds).cos();
            p * vec3(1.0, wave, 1.0)
        })
        .chain(drops)
        .collect()
}

fn wave(time: Res<Time>, mut fluids: Query<(&Name, &mut FluidParticles)>) {
    for (name, mut particles) in &mut fluids {
        if name.as_str() != "ball" && time.delta_secs() > 0.0 {
            particles.positions = pool(time.elapsed_secs());
        }
    }
}
