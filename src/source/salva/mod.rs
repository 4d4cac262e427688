//! Live simulation of liquids: [salva3d](https://docs.rs/salva3d) moves the particles, rapier the
//! bodies among them. Feature `salva`.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::prelude::*;
//!
//! fn setup(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>) {
//!     // A tank that stands on y = 0, with water in a block of it.
//!     let tank = vec3(2.0, 1.0, 1.0);
//!     commands.spawn((SalvaBoundary::tank(tank), Transform::from_xyz(0.0, 0.5, 0.0)));
//!     let water = (0..8000)
//!         .map(|i| ivec3(i % 20, i / 400, i / 20 % 20).as_vec3() * 0.05)
//!         .map(|place| place + vec3(-0.975, 0.025, -0.475))
//!         .collect();
//!     commands.spawn((
//!         FluidParticles::new(water, 0.025),
//!         FluidMaterial::WATER,
//!         SalvaFluid::WATER,
//!     ));
//!     // A crate that will float.
//!     let cube = Cuboid::from_length(0.3);
//!     commands.spawn((
//!         SalvaBody::new(cube, 400.0),
//!         Mesh3d(meshes.add(cube)),
//!         Transform::from_xyz(0.5, 0.8, 0.0),
//!     ));
//! }
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, FluidPlugin::default(), SalvaPlugin))
//!     .add_systems(Startup, setup)
//!     .run();
//! ```
//!
//! # What happens in a frame
//!
//! In [`FluidSystems::Simulate`](crate::FluidSystems::Simulate), finished steps are collected,
//! changes are gathered, the next steps begin on other threads, and positions interpolated between
//! the last two finished states are written to
//! [`FluidParticles`](crate::particles::FluidParticles) and to the bodies'
//! `Transform`. The app never waits, not even for the hulls and trees of meshes: the picture lags a
//! frame and a step behind, and where the machine is too slow the liquid moves in slow motion
//! ([`SalvaStatus::speed`]), but boundaries do not. [`SalvaSettings::budget`] limits how much of a
//! frame's time the simulation takes; [`SalvaMode::Lockstep`] waits, and is deterministic, bit for
//! bit.
//!
//! # What is simulated
//!
//! IISPH (Ihmsen et al. 2014) with salva's pressure solver, in as many substeps as the fastest
//! particle needs. At rest liquid takes 2 to 5 % less room than it should: particles lie up to 0.2
//! radii nearer to walls, so finer particles lose less. Solids are sampled by particles near liquid
//! (Akinci et al. 2012); a ray along each particle's path through a step ensures that none passes a
//! surface. Momentum is conserved to float precision: a particle that a solid stops pushes the
//! solid.
//!
//! # Cost
//!
//! On one core of a shared server a step takes 6 µs per particle (2000 particles: 11.6 ms; 6750:
//! 41 ms), and 10 µs beyond the cache (16,000: 159 ms; 54,000: 521 ms), in the first half second
//! of a dam break in a tank twice as wide, boundary particles near liquid included (measured by
//! `scripts/test --test cpu -- --ignored --nocapture cost`). A desktop with many cores simulates
//! some 10,000 particles live.
//!
//! # Limitations
//!
//! - All fluids have one particle radius. Thin sheets and fine spray are no finer.
//! - Bodies of a rapier world outside of this plugin are not coupled; see [`SalvaLoad`].
//! - Impacts: water that hits at 40 m/s gains energy (half as much again, measured on a block and a
//!   body of particles of 5 cm); at 20 m/s it does not.
//! - Threads: it does not run on the web.

mod emit;
mod error;
mod fluid;
mod gather;
mod pace;
mod relocate;
mod runner;
mod settings;
mod shape;
mod show;
mod solids;
#[cfg(test)]
mod tests;
mod world;

use bevy::{
    asset::AssetEventSystems, mesh::mark_3d_meshes_as_changed_if_their_assets_changed, prelude::*,
};

pub use self::{
    error::SalvaError,
    fluid::SalvaFluid,
    settings::{SalvaMode, SalvaSettings, SalvaStatus},
    solids::{SalvaBody, SalvaBoundary, SalvaLoad, SalvaShape},
};

use crate::{
    needs::need_time,
    relocation,
    schedule::Movers,
    settings::check,
    source::{
        emitter::{self, ParticleEmitter},
        particles,
    },
};

/// Simulates every [`SalvaFluid`] among [`SalvaBoundary`]s and [`SalvaBody`]s.
/// Part of [`FluidPlugins`](crate::FluidPlugins). [`FluidPlugin`](crate::FluidPlugin) draws the
/// fluids; the simulation also runs without it.
///
/// It runs in [`FluidSystems::Simulate`](crate::FluidSystems::Simulate): anything moved or spawned
/// before that takes part in the steps that begin there.
#[derive(Clone, Copy, Debug, Default)]
pub struct SalvaPlugin;

impl Plugin for SalvaPlugin {
    fn build(&self, app: &mut App) {
        check::<SalvaFluid>(app);
        check::<SalvaBoundary>(app);
        check::<SalvaBody>(app);
        check::<SalvaSettings>(app);
        check::<ParticleEmitter>(app);
        particles::carried(app);
        emitter::relocated(app);
        relocation::on_shift(app, relocate::shift);
        relocation::on_teleport(app, relocate::teleport);
        app.register_type::<SalvaFluid>()
            .register_type::<SalvaBoundary>()
            .register_type::<SalvaBody>()
            .register_type::<SalvaLoad>()
            .register_type::<SalvaSettings>()
            .register_type::<SalvaStatus>()
            .init_resource::<SalvaSettings>()
            .init_resource::<SalvaStatus>()
            .init_resource::<runner::Simulation>()
            .add_observer(gather::start_anew::<SalvaBoundary>)
            .add_observer(gather::start_anew::<SalvaBody>)
            .add_systems(
                PostUpdate,
                (
                    runner::collect,
                    (gather::gather_fluids, gather::gather_solids)
                        .chain()
                        .run_if(runner::goes_on),
                    runner::advance,
                    (show::show_fluids, show::show_bodies, show::show_loads)
                        .chain()
                        .run_if(runner::goes_on),
                    // From where nozzles are seen, into the steps of the next frame.
                    emit::emit.run_if(runner::goes_on),
                )
                    .chain()
                    .in_set(Movers::Simulation)
                    // Meshes that have changed are told of there.
                    .after(AssetEventSystems)
                    .after(mark_3d_meshes_as_changed_if_their_assets_changed),
            );
    }

    fn finish(&self, app: &mut App) {
        need_time(app, "SalvaPlugin");
    }
}
