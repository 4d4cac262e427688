//! Emitters that feed a simulated fluid.

use bevy::{prelude::*, transform::helper::TransformHelper};

use super::{
    SalvaFluid, SalvaSettings,
    runner::Simulation,
    world::{Command, Limits, Newborn},
};
use crate::{
    relocation::SpeedLimit,
    settings::Checked,
    source::emitter::{Emission, ParticleEmitter, step},
};

/// Sends new particles to the simulation, and the limits of those that stay.
pub(crate) fn emit(
    mut simulation: ResMut<Simulation>,
    settings: Single<&Checked<SalvaSettings>>,
    mut emitters: Query<
        (
            Entity,
            Mut<ParticleEmitter>,
            &Checked<ParticleEmitter>,
            &mut Emission,
        ),
        With<SalvaFluid>,
    >,
    transforms: TransformHelper,
    fastest: SpeedLimit,
    time: Res<Time>,
) {
    // Where the liquid moves in slow motion, so does what comes out.
    let pace = if settings.paused {
        0.0
    } else {
        simulation.pace.rate
    };
    let seconds = step(&time) * pace;
    for (entity, mut emitter, checked, mut emission) in &mut emitters {
        let Ok(transform) = transforms.compute_global_transform(entity) else {
            continue;
        };
        let own = ParticleEmitter::take(&mut emitter, checked, seconds);
        let mut newborn = Newborn::default();
        emission.emit(&own, &transform, seconds, fastest.get(), |birth| {
            let fallen = 0.5 * birth.age * settings.gravity;
            newborn
                .positions
                .push(birth.position + birth.age * (birth.velocity + fallen));
            newborn
                .velocities
                .push(birth.velocity + birth.age * settings.gravity);
        });
        let Some(entry) = simulation.fluids.get_mut(&entity) else {
            continue;
        };
        let id = entity.to_bits();
        let to_space = Mat4::from(transform.affine().inverse());
        let limits = Limits {
            lifetime: own.lifetime,
            capacity: own.capacity as usize,
            // A space without an extent bounds nothing.
            bounds: own
                .bounds
                .filter(|_| to_space.is_finite())
                .map(|bounds| (to_space, [bounds.min, bounds.max])),
        };
        if entry.limits.replace(limits) != Some(limits) {
            simulation.tell(Command::Limit(id, limits));
        }
        if !newborn.positions.is_empty() {
            simulation.tell(Command::Add(id, newborn));
        }
    }
}
