//! What the tests share: an app without a picture, and water in a tank.

use std::time::Duration;

use bevy::{asset::AssetPlugin, mesh::MeshPlugin, prelude::*, time::TimeUpdateStrategy};
use bevy_fluid::{
    prelude::*,
    salva::{SalvaLoad, SalvaStatus},
};

pub(crate) const RADIUS: f32 = 0.05;
pub(crate) const GRAVITY: f32 = 9.81;
pub(crate) const WATER: f32 = 1000.0;
/// One step an update.
pub(crate) const STEP: f32 = 1.0 / 120.0;

/// An app in lockstep, without anything that draws.
pub(crate) fn app() -> App {
    let mut app = bare_app();
    app.add_plugins(SalvaPlugin).insert_resource(SalvaSettings {
        mode: SalvaMode::Lockstep,
        ..default()
    });
    app.finish();
    app.cleanup();
    // The first update has no time yet.
    app.update();
    app
}

/// The same without the plugin.
pub(crate) fn bare_app() -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        MeshPlugin,
    ))
    .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
        STEP,
    )));
    app
}

pub(crate) fn run(app: &mut App, seconds: f32) {
    for _ in 0..(seconds / STEP).round() as u32 {
        app.update();
    }
}

/// Particles two radii apart, one radius off the walls of a block.
pub(crate) fn block(low: Vec3, high: Vec3) -> Vec<Vec3> {
    let counts = ((high - low) / (2.0 * RADIUS)).round().as_ivec3();
    let mut particles = Vec::new();
    for x in 0..counts.x {
        for y in 0..counts.y {
            for z in 0..counts.z {
                particles.push(low + (ivec3(x, y, z).as_vec3() + 0.5) * 2.0 * RADIUS);
            }
        }
    }
    particles
}

/// A tank that stands on y = 0 about the origin, filled up to `depth`.
pub(crate) fn pool(app: &mut App, size: Vec3, depth: f32) -> (Entity, Entity) {
    let tank = app.world_mut().spawn((
        SalvaBoundary::tank(size),
        SalvaLoad::default(),
        Transform::from_xyz(0.0, 0.5 * size.y, 0.0),
    ));
    let tank = tank.id();
    let low = vec3(-0.5 * size.x, 0.0, -0.5 * size.z);
    let water = block(low, vec3(-low.x, depth, -low.z));
    (tank, spawn_water(app, water))
}

pub(crate) fn spawn_water(app: &mut App, particles: Vec<Vec3>) -> Entity {
    let particles = FluidParticles::new(particles, RADIUS);
    app.world_mut().spawn((particles, SalvaFluid::WATER)).id()
}

pub(crate) fn particles(app: &App, fluid: Entity) -> &[Vec3] {
    &app.world().get::<FluidParticles>(fluid).unwrap().positions
}

pub(crate) fn status(app: &App) -> &SalvaStatus {
    app.world().resource::<SalvaStatus>()
}

pub(crate) fn mean(values: impl Iterator<Item = f32>) -> f32 {
    let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
    sum / count as f32
}

pub(crate) fn weight_of(count: usize) -> f32 {
    count as f32 * (2.0 * RADIUS).powi(3) * WATER * GRAVITY
}

pub(crate) fn load(app: &App, solid: Entity) -> SalvaLoad {
    *app.world().get::<SalvaLoad>(solid).unwrap()
}

/// Mass of a particle of water, kg.
pub(crate) fn particle_mass() -> f32 {
    (2.0 * RADIUS).powi(3) * WATER
}
