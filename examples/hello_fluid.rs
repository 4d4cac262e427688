//! The smallest program: a ball of water over a checkered floor.
//!
//! In a window, or `--out FILE.png` for a picture. Try `FluidMaterial::HONEY`.

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
    // Shells of evenly spread particles, the spacing of neighbours twice their radius.
    let positions = (1..=10).flat_map(|shell| {
        let (size, count) = (0.1 * shell as f32, 4 * 3 * shell * shell);
        (0..count).map(move |i| {
            let height = 1.0 - (2 * i + 1) as f32 / count as f32;
            let around = Vec2::from_angle(2.399963 * i as f32) * (1.0 - height * height).sqrt();
            vec3(around.x, height, around.y) * size + Vec3::Y * 1.2
        })
    });
    scenery.checker_floor(Vec3::ZERO, 6.0, 12);
    scenery.sun(vec3(0.5, 1.0, 0.5), 10.0, true);
    let sky = scenery.sky(vec3(0.5, 1.0, 0.5));
    scenery.commands.spawn((
        FluidParticles::new(positions.collect(), 0.05),
        FluidMaterial::WATER,
    ));
    scenery.commands.spawn((
        Camera3d::default(),
        ScreenSpaceFluid::default(),
        sky.bundle(),
        Transform::from_xyz(2.5, 2.5, 4.0).looking_at(Vec3::Y, Vec3::Y),
    ));
}
