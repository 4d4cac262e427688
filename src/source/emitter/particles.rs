//! The particles of an emitter, and the systems that emit and move them.

use bevy::{
    math::{Affine3A, Vec3A},
    prelude::*,
    transform::helper::TransformHelper,
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
use crate::{
    relocation::SpeedLimit,
    settings::Checked,
    source::particles::{FluidParticles, ParticleSpace},
};

/// Particles that one task moves.
const CHUNK: usize = 4096;
/// Beyond this there are no particles. Unit: m.
const FARTHEST: f32 = 1e30;
/// The age of particles that are to vanish.
const DEAD: f32 = f32::INFINITY;
/// Two radii that are the same but for the rounding of a scale.
const SAME_RADIUS: f32 = 1e-5;

/// What an emitter knows of its particles beside their [`FluidParticles`], oldest first. With
/// [`ExternalMotion`] there are none.
#[derive(Component, Clone, Debug, Default)]
pub struct EmittedParticles {
    /// Negative at the beginning of a step for particles born within it.
    ages: Vec<f32>,
    /// Whether the transform has no inverse, so that particles have no place in the entity's space.
    is_nowhere: bool,
}

impl EmittedParticles {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.ages.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.ages.is_empty()
    }

    /// Ages. Unit: s.
    pub fn ages(&self) -> &[f32] {
        &self.ages
    }

    /// Lets the oldest vanish in this step, if there are more than `capacity`.
    fn keep_newest(&mut self, capacity: usize) {
        let surplus = self.len().saturating_sub(capacity);
        self.ages[..surplus].fill(DEAD);
    }

    /// Drops all particles that not every column has: other code may have written the fluid's.
    fn truncate_to_columns(&mut self, fluid: &mut Mut<FluidParticles>) {
        let lengths = [
            self.ages.len(),
            fluid.positions.len(),
            fluid.velocities.len(),
            fluid.ids.len(),
        ];
        let shortest = lengths.into_iter().fold(usize::MAX, usize::min);
        if fluid.space == ParticleSpace::World && lengths == [shortest; 4] {
            return;
        }
        let kept = match fluid.space {
            ParticleSpace::World => shortest,
            ParticleSpace::Local => 0,
        };
        self.truncate(fluid, kept);
        fluid.space = ParticleSpace::World;
    }

    fn truncate(&mut self, fluid: &mut FluidParticles, count: usize) {
        self.ages.truncate(count);
        fluid.positions.truncate(count);
        fluid.velocities.truncate(count);
        fluid.ids.truncate(count);
    }

    /// Moves all by a step, and lets those vanish that are too old or out of bounds.
    fn advance(&mut self, fluid: &mut FluidParticles, chunk: &Chunk) {
        let columns = (&mut fluid.positions, &mut fluid.velocities, &mut self.ages);
        let (positions, velocities, ages) = columns;
        let any_dead = if positions.len() <= CHUNK {
            chunk.advance(positions, velocities, ages)
        } else {
            positions
                .par_chunks_mut(CHUNK)
                .zip(velocities.par_chunks_mut(CHUNK))
                .zip(ages.par_chunks_mut(CHUNK))
                .map(|((positions, velocities), ages)| chunk.advance(positions, velocities, ages))
                .reduce(|| false, |a, b| a | b)
        };
        if any_dead {
            self.bury(fluid);
        }
    }

    /// Closes the gaps of the dead; the others stay in order.
    fn bury(&mut self, fluid: &mut FluidParticles) {
        let Some(first) = self.ages.iter().position(|&age| age == DEAD) else {
            return;
        };
        let mut kept = first;
        for i in first + 1..self.ages.len() {
            if self.ages[i] < DEAD {
                self.ages[kept] = self.ages[i];
                fluid.positions[kept] = fluid.positions[i];
                fluid.velocities[kept] = fluid.velocities[i];
                fluid.ids[kept] = fluid.ids[i];
                kept += 1;
            }
        }
        self.truncate(fluid, kept);
    }
}

/// The work on a part of the particles, by one thread.
struct Chunk<'a> {
    step: Step<'a>,
    lifetime: f32,
    /// A box, and the transform into its space.
    bounds: Option<(Affine3A, EmitterBounds)>,
}

impl Chunk<'_> {
    /// Returns whether any are to vanish.
    fn advance(&self, positions: &mut [Vec3], velocities: &mut [Vec3], ages: &mut [f32]) -> bool {
        let step = &self.step;
        let whole = step.forces.over(step.seconds);
        let mut any_dead = false;
        for ((position, velocity), age) in positions.iter_mut().zip(velocities).zip(ages) {
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
            (*position, *velocity) = (place.into(), speed.into());
            if !self.is_within(place) {
                *age = DEAD;
                any_dead = true;
            }
        }
        any_dead
    }

    /// NaN is never within.
    #[inline]
    fn is_within(&self, place: Vec3A) -> bool {
        match &self.bounds {
            None => place.abs().cmple(Vec3A::splat(FARTHEST)).all(),
            Some((to_space, bounds)) => {
                let here = to_space.transform_point3a(place);
                (here.cmpge(bounds.min.into()) & here.cmple(bounds.max.into())).all()
            }
        }
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
            Entity,
            Mut<ParticleEmitter>,
            &Checked<ParticleEmitter>,
            &mut Emission,
            &mut EmittedParticles,
            &mut FluidParticles,
        ),
        Without<ExternalMotion>,
    >,
    transforms: TransformHelper,
    fastest: SpeedLimit,
    time: Res<Time>,
) {
    let seconds = step(&time);
    for (entity, mut emitter, checked, mut emission, mut particles, mut fluid) in &mut emitters {
        let Ok(transform) = transforms.compute_global_transform(entity) else {
            continue;
        };
        particles.truncate_to_columns(&mut fluid);
        let settings = ParticleEmitter::take(&mut emitter, checked, seconds);
        let fastest = fastest.get();
        emission.emit(&settings, &transform, seconds, fastest, |birth: Birth| {
            particles.ages.push(birth.age - seconds as f32);
            fluid.positions.push(birth.position);
            fluid.velocities.push(birth.velocity);
            fluid.ids.push(birth.id);
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
            &mut EmittedParticles,
            &mut FluidParticles,
        ),
        Without<ExternalMotion>,
    >,
    mut colliders: Query<(Entity, &Checked<ParticleCollider>, &mut ColliderPath)>,
    transforms: TransformHelper,
    mut list: Local<Colliders>,
    fastest: SpeedLimit,
    time: Res<Time>,
) {
    let seconds = step(&time) as f32;
    list.gather(&mut colliders, &transforms, fastest.get() * seconds);
    for (entity, emitter, mut particles, mut fluid) in &mut emitters {
        let Ok(transform) = transforms.compute_global_transform(entity) else {
            continue;
        };
        let world_from_local = transform.affine();
        let scale = world_from_local.matrix3.determinant().abs().cbrt();
        let radius = emitter.particle_radius * scale;
        // A turning emitter must not change a fluid that stands still.
        let is_same = (fluid.radius - radius).abs() <= SAME_RADIUS * radius;
        if !is_same && radius.is_finite() && radius > 0.0 {
            fluid.radius = radius;
        }
        let local_from_world = world_from_local.inverse();
        let was_nowhere = particles.is_nowhere;
        particles.is_nowhere = !local_from_world.is_finite();
        if particles.is_nowhere && !was_nowhere {
            warn!("emitter {entity}: its `GlobalTransform` has no inverse; its particles vanish");
        }
        if particles.is_empty() {
            continue;
        }
        if particles.is_nowhere {
            particles.truncate(&mut fluid, 0);
            continue;
        }
        if seconds == 0.0 {
            continue;
        }
        let step = Step {
            forces: Forces {
                gravity: emitter.gravity.into(),
                drag: emitter.drag,
            },
            seconds,
            colliders: &list,
            radius: fluid.radius,
        };
        let chunk = Chunk {
            step,
            lifetime: emitter.lifetime,
            bounds: emitter.bounds.map(|bounds| (local_from_world, bounds)),
        };
        particles.advance(&mut fluid, &chunk);
    }
}
