//! The smallest program: a ball of water over a checkered floor.
//!
//! In a window, or `--out FILE.png` for a picture. Try other materials and radii.

use bevy::prelude::*;
use bevy_fluid::prelude::*;
use fluid_stage::{StagePlugins, scenery::Scenery};

fn main() -> AppExit {
    App::new()
        // In your own program: `DefaultPlugins`.
        .add_plugins((StagePlugins::from_args(), FluidPlugin::default()))
        .add_systems(Startup, setup)
        .run()
}

fn setup(mut scenery: Scenery) {
    let steps = -12..=12;
    let positions = steps
        .clone()
        .flat_map(|x| steps.clone().map(move |y| (x, y)))
        .flat_map(|(x, y)| steps.clone().map(move |z| ivec3(x, y, z).as_vec3() * 0.1))
        .filter(|p| p.length() < 1.0)
        .map(|p| p + Vec3::Y * 1.1)
        .collect();
    scenery.checker_floor(Vec3::ZERO, 6.0, 12);
    scenery.sun(vec3(0.5, 1.0, 0.5), 10.0, true);
    let sky = scenery.sky(vec3(0.5, 1.0, 0.5));
    let mut commands = scenery.commands;
    commands.spawn((FluidParticles::new(positions, 0.05), FluidMaterial::WATER));
    commands.spawn((
        Camera3d::default(),
        ScreenSpaceFluid::default(),
        sky.bundle(),
        Transform::from_xyz(2.5, 2.5, 4.0).looking_at(Vec3::Y, Vec3::Y),
    ));
}
