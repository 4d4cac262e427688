//! What stands on a fluid to be simulated.

use bevy::prelude::*;

use crate::{emitter::ExternalMotion, particles::FluidParticles, range::SettingRange};

/// A fluid that salva moves.
///
/// The positions of the [`FluidParticles`] beside it are where it starts; from then on they are
/// overwritten. Particles within a solid (that is no mesh) are taken out at the start. To start
/// anew, write positions yourself: they are taken over, at [`velocity`](Self::velocity). Neighbours
/// at rest are two radii apart: fill with a lattice of that spacing, one radius off the walls.
///
/// All fluids have one radius in the world, that of the first; another is said once in the log, and
/// stays where it is. Fluids of different [`density`](Self::density) press on each other and part.
///
/// A [`ParticleEmitter`](crate::ParticleEmitter) beside it lets particles into the simulation, no
/// more than fit beside each other; its lifetime, capacity and bounds hold, its gravity and drag do
/// not.
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
#[require(FluidParticles, ExternalMotion)]
pub struct SalvaFluid {
    /// Density at rest. Unit: kg/m³, range 1..=100000, default 1000. Against it bodies float or
    /// sink.
    #[reflect(@SettingRange::new(1.0, 1e5).unit("kg/m³").logarithmic())]
    pub density: f32,
    /// Kinematic viscosity. Unit: m²/s, range 0..=10, default 0.01. That is honey's; water's own
    /// (1e-6) is far below what particles of some centimetres resolve, and less than about 0.005
    /// only lets them rattle. Above about 0.08 radius² / step (0.06 for 2.5 cm at the default step)
    /// it has no further effect.
    #[reflect(@SettingRange::new(0.0, 10.0).unit("m²/s").logarithmic())]
    pub viscosity: f32,
    /// The same between the fluid and solids: how much they hold it back, or drag it along.
    /// Unit: m²/s, range 0..=10, default 0.002. 0: it slips.
    #[reflect(@SettingRange::new(0.0, 10.0).unit("m²/s").logarithmic())]
    pub wall_viscosity: f32,
    /// Share of its velocity that each particle loses to the air. Unit: 1/s, range 0..=1000,
    /// default 0.
    #[reflect(@SettingRange::new(0.0, 1e3).unit("1/s").logarithmic())]
    pub drag: f32,
    /// How much the surface contracts: γ of Akinci et al. 2013. Range 0..=10, default 0; about 1
    /// for drops of water. It costs a third more time.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub surface_tension: f32,
    /// How much it clings to solids: β of Akinci et al. 2013. Range 0..=10, default 0.
    #[reflect(@SettingRange::new(0.0, 10.0))]
    pub adhesion: f32,
    /// What it starts with, in the world's space. Unit: m/s, default 0.
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

    /// Honey: heavy, slow, and it clings.
    pub const HONEY: Self = Self {
        density: 1420.0,
        viscosity: 0.05,
        wall_viscosity: 0.05,
        adhesion: 1.0,
        ..Self::WATER
    };
}

impl Default for SalvaFluid {
    fn default() -> Self {
        Self::WATER
    }
}
