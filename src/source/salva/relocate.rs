//! The simulation, when the whole world or a part of it has been put elsewhere.

use bevy::prelude::*;

use super::{SalvaSettings, runner::Simulation, world::Relocation};
use crate::relocation::{Relocated, Teleports};

impl Simulation {
    fn relocate(&mut self, relocation: Relocation) {
        if self.is_untouched() {
            return;
        }
        relocation.apply(&mut self.from);
        relocation.apply(&mut self.to);
        let told = self.tell(relocation.command());
        self.remember(told, relocation);
    }
}

pub(super) fn shift(
    mut simulation: ResMut<Simulation>,
    mut settings: ResMut<SalvaSettings>,
    relocated: Res<Relocated>,
) {
    let by = relocated.shift;
    settings.low += by;
    settings.high += by;
    for solid in simulation.solids.values_mut() {
        solid.shift(by);
    }
    simulation.relocate(Relocation::World(by));
}

pub(super) fn teleport(mut simulation: ResMut<Simulation>, teleports: Teleports) {
    let simulation = &mut *simulation;
    for (&entity, solid) in &mut simulation.solids {
        solid.jumps |= teleports.of(entity).is_some();
    }
    let fluids = simulation.fluids.keys();
    let carried: Vec<_> = fluids
        .filter_map(|&entity| Some((entity, teleports.of(entity)??)))
        .collect();
    for (entity, way) in carried {
        simulation.relocate(Relocation::Fluid(entity.to_bits(), way));
    }
}
