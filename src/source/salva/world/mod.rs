//! The simulation itself: salva's liquid and rapier's bodies. It does not depend on Bevy's world
//! and can move between threads.

mod command;
mod convert;
mod coupling;
mod forces;
mod frame;
mod geometry;
mod guard;
mod liquid;
mod relocation;
mod sampling;
mod solid;
mod step;
mod stops;

use std::collections::BTreeMap;

use bevy::prelude::*;
use salva3d::{LiquidWorld, rapier::pipeline::PhysicsWorld, solver::IISPHSolver};

pub(crate) use self::{
    command::{Command, Job, Report},
    frame::{Frame, blend},
    geometry::{Geometry, Recipe},
    liquid::{Limits, Newborn, Substance},
    relocation::Relocation,
    sampling::Triangle,
    solid::{Contact, Motion, Traits},
};
use self::{
    convert::{LiquidVector, from_liquid},
    coupling::Nearby,
    liquid::{Liquid, SMOOTHING},
    solid::Solid,
    stops::Stop,
};

/// The name of an entity in the simulation.
pub(crate) type Id = u64;

/// The solver iterates until the mean density predicted from motion alone exceeds the rest density
/// by no more than this, or until its most iterations. Measured on a column at rest: a third of it
/// makes its height better by 1 % and a step twice as expensive; three times as much makes no step
/// cheaper.
const DENSITY_ERROR: f32 = 0.01;
const MAX_ITERATIONS: usize = 30;

/// Liquids and solids.
pub(crate) struct World {
    liquid_world: LiquidWorld,
    rigid_world: PhysicsWorld,
    liquids: BTreeMap<Id, Liquid>,
    /// Of fluids that have gone. salva's solver would mix the others up if they were removed.
    free: Vec<Liquid>,
    solids: BTreeMap<Id, Solid>,
    nearby: Nearby,
    /// Positions before a step.
    before: Vec<Vec<LiquidVector>>,
    /// Particles that surfaces have stopped in a step.
    stops: Vec<Stop>,
    /// m/s, the fastest particle of the last step.
    fastest: f32,
    time: f64,
    /// Commands given so far.
    applied: u64,
    report: Report,
}

impl Default for World {
    fn default() -> Self {
        Self {
            liquid_world: new_liquid_world(0.05),
            rigid_world: PhysicsWorld::new(),
            liquids: default(),
            free: default(),
            solids: default(),
            nearby: default(),
            before: default(),
            stops: default(),
            fastest: 0.0,
            time: 0.0,
            applied: 0,
            report: default(),
        }
    }
}

fn new_liquid_world(radius: f32) -> LiquidWorld {
    // salva's DFSPH treats every solid as at rest in its divergence solve: moving ones would stir
    // the liquid for ever.
    let mut solver: IISPHSolver = IISPHSolver::new();
    solver.max_density_error = DENSITY_ERROR;
    solver.max_pressure_iter = MAX_ITERATIONS;
    LiquidWorld::new(solver, radius, SMOOTHING, 1.0)
}

fn default<T: Default>() -> T {
    T::default()
}

impl World {
    /// Writes the current state; loads are means over the `simulated` seconds of the job.
    fn write(&self, frame: &mut Frame, simulated: f32) {
        frame.time = self.time;
        frame.applied = self.applied;
        frame.liquids.resize_with(self.liquids.len(), default);
        for ((id, liquid), to) in self.liquids.iter().zip(&mut frame.liquids) {
            to.id = *id;
            to.ids.clone_from(&liquid.ids);
            to.positions.clear();
            to.velocities.clear();
            if let Some(fluid) = self.liquid_world.fluids().get(liquid.handle) {
                to.positions.extend(fluid.positions.iter().map(from_liquid));
                to.velocities
                    .extend(fluid.velocities.iter().map(from_liquid));
            }
        }
        frame.bodies.clear();
        frame.loads.clear();
        for (id, solid) in &self.solids {
            if solid.is_dynamic() {
                frame.bodies.push((*id, solid.at));
            }
            if solid.feels {
                let [force, torque] = [solid.pushed, solid.turned].map(|it| it / simulated);
                frame.loads.push((*id, force, torque));
            }
        }
    }
}
