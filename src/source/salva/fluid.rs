//! The component of a simulated fluid.

use bevy::prelude::*;

use crate::{
    settings::{Checked, SettingRange, Settings},
    source::{emitter::ExternalMotion, particles::FluidParticles},
};

/// A fluid simulated by salva.
///
/// The simulation starts with the positions of the [`FluidParticles`] on its entity, and overwrites
/// them from then on. Particles within a solid (other than a mesh) are removed at the start. To
/// restart, write positions yourself: the simulation continues with them, at
/// [`velocity`](Self::velocity). To put them elsewhere together with their tank, use a
/// [`Teleport`](crate::relocation::Teleport) that carries them. Neighbours at rest are two radii
/// apart: fill with a lattice of that spacing, one radius off the walls.
///
/// All fluids have one radius in world space, that of the first; a fluid with another radius is
/// logged once and not simulated. Fluids of different [`density`](Self::density) press on each
/// other and separate.
///
/// A [`ParticleEmitter`](crate::emitter::ParticleEmitter) on its entity emits particles into the simulation,
/// no more than fit beside each other; its lifetime, capacity and bounds apply, its gravity and
/// drag do not. Values out of range are logged once and clamped.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_fluid::prelude::*;
/// fn setup(mut commands: Commands) {
///     commands.spawn((
///         SalvaBoundary::tank(vec3(1.0, 0.8, 1.0)),
///         Transform::from_xyz(0.0, 0.4, 0.0),
///     ));
///     let column = (0..4000)
///         .map(|i| ivec3(i % 10, i / 200, i / 10 % 20).as_vec3() * 0.05)
///         .map(|place| place + vec3(-0.475, 0.025, -0.475))
///         .collect();
///     commands.spawn((FluidParticles::new(column, 0.025), SalvaFluid::WATER));
/// }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(FluidParticles, ExternalMotion, Checked<Self>)]
pub struct SalvaFluid {
    /// Density at rest. Unit: kg/m³, range 1..=100000, default 1000. Lighter bodies float, heavier
    /// ones sink.
    #[reflect(@SettingRange::new(1.0, 1e5).unit("kg/m³").logarithmic())]
    pub density: f32,
    /// Kinematic viscosity. Unit: m²/s, range 0..=10, default 0.01, that of honey. Water's (1e-6)
    /// is far below what particles of some centimetres resolve; below about 0.005 particles only
    /// jitter. Clamped to 0.32 radius² / step (0.024 for 2.5 cm at the default step; higher with
    /// substeps).
    #[reflect(@SettingRange::new(0.0, 10.0).unit("m²/s").logarithmic())]
    pub viscosity: f32,
    /// Kinematic viscosity between the fluid and solids, which hold it back or drag it along. Unit:
    /// m²/s, range 0..=10, default 0.002. 0: it slips.
    #[reflect(@SettingRange::new(0.0, 10.0).unit("m²/s").logarithmic())]
    pub wall_viscosity: f32,
    /// Air drag: rate at which particles lose velocity. Unit: 1/s, range 0..=1000, default 0.
    #[reflect(@SettingRange::new(0.0, 1e3).unit("1/s").logarithmic())]
    pub drag: f32,
    /// Surface tension: γ of Akinci et al. 2013. Range 0..=10, default 0; about 1 for drops of
    /// water. It costs a third more time.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub surface_tension: f32,
    /// Adhesion to solids: β of Akinci et al. 2013. Range 0..=10, default 0.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub adhesion: f32,
    /// Initial velocity, in world space. Unit: m/s, default 0.
    #[reflect(@SettingRange::new(-100.0, 100.0).unit("m/s").open())]
    pub velocity: Vec3,
}

impl SalvaFluid {
    /// Water in particles of some centimetres: the default.
    pub const WATER: Self = Self {
        density: 1000.0,
        viscosity: 0.01,
        wall_viscosity: 0.002,
        drag: 0.0,
        surface_tension: 0.0,
        adhesion: 0.0,
        velocity: Vec3::ZERO,
    };

    /// Honey: heavy, viscous and adhesive.
    pub const HONEY: Self = Self {
        density: 1420.0,
        viscosity: 0.05,
        wall_viscosity: 0.05,
        adhesion: 1.0,
        ..Self::WATER
    };
}

impl Settings for SalvaFluid {}

impl Default for SalvaFluid {
    fn default() -> Self {
        Self::WATER
    }
}
