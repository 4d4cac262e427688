//! The particles of an emitter, and the systems that emit and move them.

use bevy::{
    math::{Affine3A, Vec3A},
    prelude::*,
};
use rayon::prelude::*;

use super::{
    EmitterBounds, ExternalMotion, ParticleCollider, ParticleEmitter,
    colliders::{ColliderPath, Colliders},
    emission::{Birth, Emission},
    flight::Forces,
    motion::Step,
    step,
};
use crate::{settings::Checked, source::particles::FluidParticles};

/// Particles that one task moves.
const CHUNK: usize = 4096;
/// Beyond this there are no particles. Unit: m.
const EVERYWHERE: EmitterBounds = EmitterBounds {
    min: Vec3::splat(-1e30),
    max: Vec3::splat(1e30),
};
/// The age of particles that are to vanish.
const DEAD: f32 = f32::INFINITY;

/// The particles of an emitter, oldest first, in world space. With [`ExternalMotion`] there are
/// none.
#[derive(Component, Clone, Debug, Default)]
pub struct EmittedParticles {
    positions: Vec<Vec3>,
    velocities: Vec<Vec3>,
    /// Negative at the beginning of a step for particles born within it.
    ages: Vec<f32>,
    /// The transform that [`FluidParticles`] has been written with.
    written: Option<Affine3A>,
    /// Whether the transform has no inverse, so that particles have no place in the entity's space.
    is_nowhere: bool,
}

impl EmittedParticles {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Positions. Unit: m.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Velocities. Unit: m/s.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// Ages. Unit: s.
    pub fn ages(&self) -> &[f32] {
        &self.ages
    }

    fn clear(&mut self) {
        self.positions.clear();
        self.velocities.clear();
        self.ages.clear();
    }

    /// Lets the oldest vanish in this step, if there are more than `capacity`.
    fn keep_newest(&mut self, capacity: usize) {
        let surplus = self.len().saturating_sub(capacity);
        self.ages[..surplus].fill(DEAD);
    }

    /// Moves all by a step, writes them in the emitter's space to `local`, and lets those vanish
    /// that are too old or out of bounds.
    fn advance(
        &mut self,
        step: &Step,
        emitter: &ParticleEmitter,
        local_from_world: &Affine3A,
        local: &mut Vec<Vec3>,
    ) {
        local.resize(self.len(), Vec3::ZERO);
        let chunk = Chunk {
            step,
            lifetime: emitter.lifetime,
            bounds: emitter.bounds.unwrap_or(EVERYWHERE),
            local_from_world,
        };
        let (positions, velocities, ages) =
            (&mut self.positions, &mut self.velocities, &mut self.ages);
        let any_dead = if positions.len() <= CHUNK {
            chunk.advance(positions, velocities, ages, local)
        } else {
            positions
                .par_chunks_mut(CHUNK)
                .zip(velocities.par_chunks_mut(CHUNK))
                .zip(ages.par_chunks_mut(CHUNK))
                .zip(local.par_chunks_mut(CHUNK))
                .map(|(((positions, velocities), ages), local)| {
                    chunk.advance(positions, velocities, ages, local)
                })
                .reduce(|| false, |a, b| a | b)
        };
        if any_dead {
            self.bury(local);
        }
    }

    /// Closes the gaps of the dead; the others stay in order.
    fn bury(&mut self, local: &mut Vec<Vec3>) {
        let Some(first) = self.ages.iter().position(|&age| age == DEAD) else {
            return;
        };
        let mut kept = first;
        for i in first + 1..self.ages.len() {
            if self.ages[i] < DEAD {
                self.positions[kept] = self.positions[i];
                self.velocities[kept] = self.velocities[i];
                self.ages[kept] = self.ages[i];
                local[kept] = local[i];
                kept += 1;
            }
        }
        self.positions.truncate(kept);
        self.velocities.truncate(kept);
        self.ages.truncate(kept);
        local.truncate(kept);
    }
}

/// The work on a part of the particles, by one thread.
struct Chunk<'a> {
    step: &'a Step<'a>,
    lifetime: f32,
    bounds: EmitterBounds,
    local_from_world: &'a Affine3A,
}

impl Chunk<'_> {
    /// Returns whether any are to vanish.
    fn advance(
        &self,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
        ages: &mut [f32],
        local: &mut [Vec3],
    ) -> bool {
        let step = self.step;
        let whole = step.forces.over(step.seconds);
        let [min, max] = [self.bounds.min, self.bounds.max].map(Vec3A::from);
        let mut any_dead = false;
        for (((position, velocity), age), local) in
            positions.iter_mut().zip(velocities).zip(ages).zip(local)
        {
            let is_new = *age < 0.0;
            *age += step.seconds;
            if *age >= self.lifetime {
                *age = DEAD;
                any_dead = true;
                continue;
            }
            let (mut place, mut speed) = (Vec3A::from(*position), Vec3A::from(*velocity));
            if is_new {
                let flight = step.forces.over(*age);
                step.advance(&mut place, &mut speed, &flight, *age);
            } else {
                step.advance(&mut place, &mut speed, &whole, step.seconds);
            }
            let here = self.local_from_world.transform_point3a(place);
            (*position, *velocity, *local) = (place.into(), speed.into(), here.into());
            // NaN is never within.
            let is_within = (here.cmpge(min) & here.cmple(max)).all();
            if !is_within {
                *age = DEAD;
                any_dead = true;
            }
        }
        any_dead
    }
}

/// An emitter that is inserted again elsewhere has not moved there from here.
pub(super) fn stop(
    removed: On<Remove, ParticleEmitter>,
    mut emitters: Query<(&mut Emission, &mut EmittedParticles)>,
) {
    if let Ok((mut emission, mut particles)) = emitters.get_mut(removed.entity) {
        *emission = default();
        particles.is_nowhere = false;
    }
}

/// Emits particles.
pub(super) fn emit(
    mut emitters: Query<
        (
            Mut<ParticleEmitter>,
            &Checked<ParticleEmitter>,
            &GlobalTransform,
            &mut Emission,
            &mut EmittedParticles,
        ),
        Without<ExternalMotion>,
    >,
    time: Res<Time>,
) {
    let seconds = step(&time);
    for (mut emitter, checked, transform, mut emission, mut particles) in &mut emitters {
        let settings = ParticleEmitter::take(&mut emitter, checked, seconds);
        emission.emit(&settings, transform, seconds, |birth: Birth| {
            particles.positions.push(birth.position);
            particles.velocities.push(birth.velocity);
            particles.ages.push(birth.age - seconds as f32);
        });
        if seconds > 0.0 {
            particles.keep_newest(settings.capacity as usize);
        }
    }
}

/// Moves all particles.
pub(super) fn simulate(
    mut emitters: Query<
        (
            Entity,
            &Checked<ParticleEmitter>,
            &GlobalTransform,
            &mut EmittedParticles,
            &mut FluidParticles,
        ),
        Without<ExternalMotion>,
    >,
    mut colliders: Query<(
        &Checked<ParticleCollider>,
        &GlobalTransform,
        &mut ColliderPath,
    )>,
    mut list: Local<Colliders>,
    time: Res<Time>,
) {
    let seconds = step(&time) as f32;
    list.gather(&mut colliders);
    for (entity, emitter, transform, mut particles, mut fluid) in &mut emitters {
        if fluid.radius != emitter.particle_radius {
            fluid.radius = emitter.particle_radius;
        }
        let world_from_local = transform.affine();
        let is_moved = particles.written != Some(world_from_local);
        if particles.is_empty() && fluid.positions.is_empty() || seconds == 0.0 && !is_moved {
            continue;
        }
        let local_from_world = world_from_local.inverse();
        particles.written = Some(world_from_local);
        let local = &mut fluid.positions;
        let was_nowhere = particles.is_nowhere;
        particles.is_nowhere = !local_from_world.is_finite();
        if particles.is_nowhere {
            if !was_nowhere {
                warn!(
                    "emitter {entity}: its `GlobalTransform` has no inverse; its particles vanish"
                );
            }
            particles.clear();
            local.clear();
            continue;
        }
        if seconds == 0.0 {
            local.clear();
            local.extend(
                particles
                    .positions
                    .iter()
                    .map(|&place| local_from_world.transform_point3(place)),
            );
            continue;
        }
        let scale = world_from_local.matrix3.determinant().abs().cbrt();
        let step = Step {
            forces: Forces {
                gravity: emitter.gravity.into(),
                drag: emitter.drag,
            },
            seconds,
            colliders: &list,
            radius: emitter.particle_radius * scale,
        };
        particles.advance(&step, emitter, &local_from_world, local);
    }
}
