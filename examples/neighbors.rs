//! Several fluids in one view, in both orders of depth: honey in front of water and water in front
//! of honey; smoke in front of a pool and behind one.
//!
//! Turn the camera with the mouse: the order follows. `--out FILE.png` writes a picture instead.

use bevy::prelude::*;
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins,
    scenery::{Scenery, orbit_camera},
};

/// Particle radius of the liquids, m.
const RADIUS: f32 = 0.03;
const TO_SUN: Vec3 = vec3(-0.5, 0.8, 0.5);

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 1,
        title: "neighbors · bevy_fluid".into(),
        ..default()
    };
    App::new()
        .add_plugins((stage.with_args(), FluidPlugin::default()))
        .add_systems(Startup, setup)
        .run()
}

fn setup(mut scenery: Scenery) {
    scenery.checker_floor(Vec3::ZERO, 8.0, 24);
    scenery.sun(TO_SUN, 20.0, true);
    let sky = scenery.sky(TO_SUN);
    for (x, near, far) in [
        (-1.9, FluidMaterial::HONEY, FluidMaterial::WATER),
        (-0.6, FluidMaterial::WATER, FluidMaterial::HONEY),
    ] {
        ball(&mut scenery, vec3(x, 0.4, 0.5), near);
        ball(&mut scenery, vec3(x + 0.25, 0.4, -0.6), far);
    }
    for (x, smoke) in [(0.7, vec3(0.15, 0.5, 0.65)), (2.0, vec3(0.1, 0.42, -0.85))] {
        pool(&mut scenery, vec3(x, 0.0, 0.0));
        puff(&mut scenery, vec3(x, 0.0, 0.0) + smoke);
    }
    scenery.commands.spawn((
        orbit_camera(vec3(0.1, 1.3, 4.4), vec3(0.1, 0.4, 0.0)),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
}

fn ball(scenery: &mut Scenery, at: Vec3, material: FluidMaterial) {
    scenery.commands.spawn((
        FluidParticles::new(fluid_stage::ball(0.36, RADIUS), RADIUS),
        material,
        Transform::from_translation(at),
    ));
}

fn pool(scenery: &mut Scenery, foot: Vec3) {
    let counts = uvec3(18, 8, 14);
    let places = |count: u32| (0..count).map(move |i| (2 * i + 1) as f32 * RADIUS);
    let particles = places(counts.x)
        .flat_map(|x| places(counts.y).map(move |y| vec2(x, y)))
        .flat_map(|xy| places(counts.z).map(move |z| xy.extend(z)));
    scenery.commands.spawn((
        FluidParticles::new(particles.collect(), RADIUS),
        FluidMaterial::WATER,
        Transform::from_translation(foot - RADIUS * vec3(18.0, 0.0, 14.0)),
    ));
}

/// A cloud of balls that overlap, some of them farther out than the rest.
fn puff(scenery: &mut Scenery, at: Vec3) {
    let core = fluid_stage::ball(0.3, 0.03).into_iter();
    // Bulges of a few waves along the surface.
    let bulge = |p: Vec3| 1.0 + 0.35 * (9.0 * p.x).sin() * (11.0 * p.y + 7.0 * p.z).sin();
    let positions = core.map(|place| place * bulge(place) * vec3(1.0, 0.8, 1.0));
    let mut smoke = FluidMaterial::SMOKE;
    smoke.medium.scattering_density *= 0.05;
    smoke.medium.absorption_density *= 0.05;
    scenery.commands.spawn((
        FluidParticles::new(positions.collect(), 0.09),
        SurfaceKernel::PUFFS,
        smoke,
        Transform::from_translation(at),
    ));
}
