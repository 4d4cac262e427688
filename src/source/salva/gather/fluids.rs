//! Fluids: new ones, changed ones, and particles written by other code.

use bevy::{ecs::change_detection::Tick, prelude::*, transform::helper::TransformHelper};

use crate::{
    settings::Checked,
    source::emitter::ParticleEmitter,
    source::particles::{FluidParticles, ParticleSpace},
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
    /// The radius that its emitter asked for, if it has one.
    asked: Option<f32>,
    /// The limits sent for its particles, if an emitter feeds it.
    pub(crate) limits: Option<Limits>,
}

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
        let asked = emitter.map(|emitter| emitter.particle_radius);
        if asked.is_none()
            && let Some(entry) = simulation.fluids.get_mut(&entity)
            && entry.limits.take().is_some()
        {
            // Particles that the emitter limited stay now.
            simulation.tell(Command::Limit(entity.to_bits(), Limits::default()));
        }
        let taken = simulation.take_fluid(entity, &fluid, &mut particles, asked, &transforms);
        if let Some(error) = warned.news(entity, taken) {
            warn!("fluid {entity} is not simulated: {error}");
        }
    }
}

impl Simulation {
    /// Takes over particles that other code has written. `asked` is the radius that the fluid's
    /// emitter asks for, in its own space.
    fn take_fluid(
        &mut self,
        entity: Entity,
        fluid: &Ref<Checked<SalvaFluid>>,
        particles: &mut Mut<FluidParticles>,
        asked: Option<f32>,
        transforms: &TransformHelper,
    ) -> Result<(), SalvaError> {
        let id = entity.to_bits();
        let written = particles.last_changed();
        let known = self.fluids.get_mut(&entity);
        let mut known = known.filter(|known| known.written == written);
        if known.as_ref().is_none_or(|known| known.asked != asked) {
            let place = transforms.compute_global_transform(entity);
            let place = place.map_err(|_| SalvaError::Transform)?;
            let space = particles.world_from_particles(&place);
            let own = match (asked, particles.space) {
                (Some(asked), ParticleSpace::World) => asked * mean_scale(&place),
                (Some(asked), ParticleSpace::Local) => asked,
                (None, _) => particles.radius,
            };
            let radius = own * mean_scale(&space);
            if let Some(known) = known.as_mut().filter(|known| is_like(known.radius, radius)) {
                known.asked = asked;
            } else {
                if particles.radius != own {
                    particles.radius = own;
                }
                let entry = self.begin_fluid(entity, fluid, particles, radius, &space)?;
                self.fluids.insert(entity, FluidEntry { asked, ..entry });
                return Ok(());
            }
        }
        if fluid.is_changed() {
            self.tell(Command::Substance(id, Substance::from(&***fluid)));
        }
        Ok(())
    }

    fn begin_fluid(
        &mut self,
        entity: Entity,
        fluid: &SalvaFluid,
        particles: &mut Mut<FluidParticles>,
        radius: f32,
        space: &GlobalTransform,
    ) -> Result<FluidEntry, SalvaError> {
        let id = entity.to_bits();
        if !(radius.is_finite() && radius > 0.0) {
            return Err(SalvaError::Radius(particles.radius));
        }
        if self.fluids.remove(&entity).is_some() {
            self.tell(Command::RemoveFluid(id));
        }
        if let Some(other) = self.fluids.values().next() {
            let others = other.radius;
            if !is_like(radius, others) {
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
            positions: places.map(|&place| space.transform_point(place)).collect(),
            velocities: vec![fluid.velocity],
        };
        // Those of particles that have been replaced.
        particles.velocities.clear();
        particles.ids.clear();
        let told = self.tell(Command::Fluid(id, Substance::from(fluid), newborn));
        Ok(FluidEntry {
            radius,
            written: particles.last_changed(),
            told,
            asked: None,
            limits: None,
        })
    }
}

/// Whether two radii are the same but for rounding in transforms.
fn is_like(a: f32, b: f32) -> bool {
    (a / b - 1.0).abs() <= SAME_RADIUS
}

/// The scale of a sphere of the same volume.
fn mean_scale(transform: &GlobalTransform) -> f32 {
    transform.affine().matrix3.determinant().abs().cbrt()
}
