//! Fluids: new ones, changed ones, and particles written by other code.

use bevy::{
    ecs::change_detection::Tick, math::Affine3A, prelude::*, transform::helper::TransformHelper,
};

use crate::{
    settings::Checked,
    source::emitter::ParticleEmitter,
    source::particles::FluidParticles,
    source::salva::{
        SalvaError, SalvaFluid,
        error::Warned,
        runner::Simulation,
        world::{Command, Limits, Newborn, Substance},
    },
};

/// State of a simulated fluid.
pub(crate) struct FluidEntry {
    /// World-space radius of its particles, m.
    pub(crate) radius: f32,
    /// When its particles were written last, by this plugin or as taken over.
    pub(crate) written: Tick,
    /// Number of commands that the world must have applied to have these particles.
    pub(crate) told: u64,
    /// The transform that its particles were written with.
    pub(crate) space: Affine3A,
    /// The limits sent for its particles, if an emitter feeds it.
    pub(crate) limits: Option<Limits>,
}

/// Two radii that are the same but for rounding in transforms.
const SAME_RADIUS: f32 = 1e-3;

impl From<&SalvaFluid> for Substance {
    fn from(fluid: &SalvaFluid) -> Self {
        Self {
            density: fluid.density,
            viscosity: fluid.viscosity,
            wall_viscosity: fluid.wall_viscosity,
            drag: fluid.drag,
            surface_tension: fluid.surface_tension,
            adhesion: fluid.adhesion,
        }
    }
}

/// Sends new, changed and removed fluids to the simulation.
pub(crate) fn gather_fluids(
    mut simulation: ResMut<Simulation>,
    mut fluids: Query<(
        Entity,
        Ref<Checked<SalvaFluid>>,
        &mut FluidParticles,
        Option<&Checked<ParticleEmitter>>,
    )>,
    mut gone: RemovedComponents<SalvaFluid>,
    mut without_particles: RemovedComponents<FluidParticles>,
    transforms: TransformHelper,
    mut warned: Local<Warned>,
) {
    for entity in gone.read().chain(without_particles.read()) {
        warned.forget(entity);
        if simulation.fluids.remove(&entity).is_some() {
            simulation.tell(Command::RemoveFluid(entity.to_bits()));
        }
    }
    for (entity, fluid, mut particles, emitter) in &mut fluids {
        if let Some(emitter) = emitter {
            let radius = emitter.particle_radius;
            if particles.radius != radius {
                particles.radius = radius;
            }
        } else if let Some(entry) = simulation.fluids.get_mut(&entity)
            && entry.limits.take().is_some()
        {
            // Particles that the emitter limited stay now.
            simulation.tell(Command::Limit(entity.to_bits(), Limits::default()));
        }
        let taken = simulation.take_fluid(entity, &fluid, &particles, &transforms);
        if let Some(error) = warned.news(entity, taken) {
            warn!("fluid {entity} is not simulated: {error}");
        }
    }
}

impl Simulation {
    fn take_fluid(
        &mut self,
        entity: Entity,
        fluid: &Ref<Checked<SalvaFluid>>,
        particles: &Mut<FluidParticles>,
        transforms: &TransformHelper,
    ) -> Result<(), SalvaError> {
        let id = entity.to_bits();
        let known = self.fluids.get(&entity);
        let is_written = known.is_some_and(|known| known.written == particles.last_changed());
        if is_written {
            if fluid.is_changed() {
                self.tell(Command::Substance(id, Substance::from(&***fluid)));
            }
            return Ok(());
        }
        let space = transforms.compute_global_transform(entity);
        let space = space.map_err(|_| SalvaError::Transform)?.affine();
        let radius = particles.radius * space.matrix3.determinant().abs().cbrt();
        if !(radius.is_finite() && radius > 0.0) {
            return Err(SalvaError::Radius(particles.radius));
        }
        if self.fluids.remove(&entity).is_some() {
            self.tell(Command::RemoveFluid(id));
        }
        if let Some(other) = self.fluids.values().next() {
            let others = other.radius;
            if (radius / others - 1.0).abs() > SAME_RADIUS {
                return Err(SalvaError::OtherRadius {
                    own: radius,
                    others,
                });
            }
        } else {
            self.tell(Command::Radius(radius));
        }
        let places = particles.positions.iter();
        let newborn = Newborn {
            positions: places.map(|&place| space.transform_point3(place)).collect(),
            velocities: vec![fluid.velocity],
        };
        let told = self.tell(Command::Fluid(id, Substance::from(&***fluid), newborn));
        let entry = FluidEntry {
            radius,
            written: particles.last_changed(),
            told,
            space,
            limits: None,
        };
        self.fluids.insert(entity, entry);
        Ok(())
    }
}
