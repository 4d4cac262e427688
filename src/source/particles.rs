//! The particle component, and the system that shapes fluids.

use bevy::prelude::*;

use crate::{
    material::FluidMaterial,
    schedule::FluidSystems,
    settings::Checked,
    shape::{FluidSplats, RADIUS, ShapeTimes, ShapeWorkspace, SurfaceKernel},
};

/// A fluid: particles of one radius in the entity's space.
///
/// A fluid is shaped again only when this component, or the [`SurfaceKernel`] on its entity,
/// changes; an unchanged fluid costs nothing.
#[derive(Component, Clone, Debug, Default, Reflect)]
#[reflect(Component, Default, Clone)]
#[require(FluidMaterial, SurfaceKernel, ShapedFluid, Transform, Visibility)]
pub struct FluidParticles {
    /// Centres in the entity's space. Unit: m, default: none. Particles that are not finite are
    /// dropped and counted in [`ShapedFluid::dropped`].
    pub positions: Vec<Vec3>,
    /// Radius of every particle, half the distance between neighbours at rest. Unit: m, range
    /// 1e-9..=1e9, default 0, valid only without particles. Particles of an invalid radius are not
    /// drawn; that is logged once.
    #[reflect(@RADIUS)]
    pub radius: f32,
}

impl FluidParticles {
    /// A fluid of particles at `positions`, each of `radius`.
    pub fn new(positions: Vec<Vec3>, radius: f32) -> Self {
        Self { positions, radius }
    }
}

/// The result of shaping a fluid. The splats themselves go to the render world.
#[derive(Component, Clone, Debug, Default)]
pub struct ShapedFluid {
    pub(crate) splats: FluidSplats,
    fresh: bool,
    generation: u64,
    /// Why the fluid is not drawn; logged when it changes.
    error: Option<String>,
}

impl ShapedFluid {
    /// Number of bulk particles near a surface.
    pub fn bulk(&self) -> u32 {
        self.splats.bulk
    }

    /// Number of bulk particles that no visible surface passes through.
    pub fn interior(&self) -> u32 {
        self.splats.interior
    }

    /// Number of spray particles.
    pub fn spray(&self) -> u32 {
        self.splats.spray
    }

    /// Number of particles dropped because their position is not finite.
    pub fn dropped(&self) -> u32 {
        self.splats.dropped
    }

    /// How long the last shaping took.
    pub fn times(&self) -> ShapeTimes {
        self.splats.times
    }

    /// How many times the fluid has been shaped.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Whether the splats are new since the last call.
    pub(crate) fn take_fresh(&mut self) -> bool {
        core::mem::take(&mut self.fresh)
    }
}

/// Shapes every fluid whose particles or kernel have changed.
pub(crate) fn shape_fluids(
    mut fluids: Query<
        (
            Entity,
            &FluidParticles,
            &Checked<SurfaceKernel>,
            &mut ShapedFluid,
        ),
        Or<(Changed<FluidParticles>, Changed<Checked<SurfaceKernel>>)>,
    >,
    mut workspace: Local<ShapeWorkspace>,
) {
    for (entity, particles, kernel, mut shaped) in &mut fluids {
        let splats = &mut shaped.splats;
        let result = workspace.shape(&particles.positions, particles.radius, kernel, splats);
        let error = result.err().map(|error| error.to_string());
        if let Some(error) = error.as_ref().filter(|_| error != shaped.error) {
            warn!("fluid {entity} is not drawn: {error}");
        }
        shaped.error = error;
        shaped.fresh = true;
        shaped.generation += 1;
    }
}

pub(crate) fn plugin(app: &mut App) {
    app.add_systems(PostUpdate, shape_fluids.in_set(FluidSystems::Shape));
}
