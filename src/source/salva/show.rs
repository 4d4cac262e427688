//! From finished states to components.

use bevy::prelude::*;

use super::{
    SalvaBody, SalvaFluid, SalvaLoad,
    runner::Simulation,
    shape::split,
    world::{Frame, blend},
};
use crate::source::particles::{FluidParticles, ParticleSpace};

/// The state shown last, which is not written again.
#[derive(Default, PartialEq, Clone, Copy)]
pub(crate) struct Shown {
    from: f64,
    to: f64,
    at: f64,
}

impl Shown {
    fn of(simulation: &Simulation) -> Self {
        Self {
            from: simulation.from.time,
            to: simulation.to.time,
            at: simulation.shown,
        }
    }

    /// Whether the state to show has changed.
    fn update(&mut self, simulation: &Simulation) -> bool {
        let now = Self::of(simulation);
        core::mem::replace(self, now) != now
    }
}

/// Writes the particles of fluids.
pub(crate) fn show_fluids(
    mut simulation: ResMut<Simulation>,
    mut fluids: Query<(Entity, &mut FluidParticles), With<SalvaFluid>>,
    mut shown: Local<Shown>,
) {
    if !shown.update(&simulation) {
        return;
    }
    let share = simulation.share();
    let Simulation {
        from,
        to,
        fluids: entries,
        ..
    } = &mut *simulation;
    for (entity, mut particles) in &mut fluids {
        let Some(entry) = entries.get_mut(&entity) else {
            continue;
        };
        let id = entity.to_bits();
        // The state may date from before its particles were replaced.
        let Some(end) = to.liquid(id).filter(|_| to.applied >= entry.told) else {
            continue;
        };
        let start = from.liquid(id).filter(|_| from.applied >= entry.told);
        let fluid = &mut *particles;
        fluid.space = ParticleSpace::World;
        fluid.radius = entry.radius;
        fluid.ids.clone_from(&end.ids);
        fluid.positions.clear();
        fluid.velocities.clear();
        for (place, velocity) in blend(start, end, share) {
            fluid.positions.push(place);
            fluid.velocities.push(velocity);
        }
        entry.written = particles.last_changed();
    }
}

/// Writes the transforms of bodies.
pub(crate) fn show_bodies(
    mut simulation: ResMut<Simulation>,
    mut bodies: Query<(Entity, &mut Transform), With<SalvaBody>>,
    mut shown: Local<Shown>,
) {
    if !shown.update(&simulation) {
        return;
    }
    let share = simulation.share();
    let Simulation {
        from, to, solids, ..
    } = &mut *simulation;
    for (entity, mut transform) in &mut bodies {
        let Some(entry) = solids.get_mut(&entity) else {
            continue;
        };
        let place = |frame: &Frame| {
            let is_known = frame.applied >= entry.told;
            frame.body(entity.to_bits()).filter(|_| is_known)
        };
        let Some(end) = place(to) else {
            continue;
        };
        let start = place(from).unwrap_or(end);
        transform.translation = start.translation.lerp(end.translation, share).into();
        transform.rotation = start.rotation.slerp(end.rotation, share);
        // As it will be read from the transform, to detect writes by other code.
        if let Ok((at, _)) = split(&GlobalTransform::from(*transform)) {
            entry.at = at;
        }
    }
}

/// Writes the forces on solids that have a [`SalvaLoad`].
pub(crate) fn show_loads(simulation: Res<Simulation>, mut loads: Query<&mut SalvaLoad>) {
    for &(id, force, torque) in &simulation.to.loads {
        if let Ok(mut load) = loads.get_mut(Entity::from_bits(id)) {
            load.set_if_neq(SalvaLoad { force, torque });
        }
    }
}
