//! Liquids in motion: salva3d's DFSPH between walls of boundary particles.

use bevy::prelude::*;
use fluid_stage::lattice;
use salva3d::{
    LiquidWorld,
    math::Vector,
    object::{Boundary, Fluid, FluidHandle, interaction_groups::InteractionGroups},
    solver::{ArtificialViscosity, DFSPHSolver},
};

/// Smoothing length over particle diameter.
const SMOOTHING: f32 = 2.0;
const GRAVITY: f32 = -9.81;
/// Substeps per frame: with one, the solver is unstable and throws water about.
const SUBSTEPS: u32 = 2;
/// Longest step, s: a slow machine slows down the liquid rather than the program.
const LONGEST_STEP: f32 = 1.0 / 30.0;

/// A liquid in a tank.
#[derive(Resource)]
pub(crate) struct Simulation {
    world: LiquidWorld,
    fluid: FluidHandle,
    /// Bounds for the centres of particles.
    low: Vec3,
    high: Vec3,
}

impl Simulation {
    /// Liquid particles of `radius` (m) at rest at `liquid`, in a `tank` (width, height, depth; m)
    /// on y = 0 about the origin, among `solid` particles.
    pub(crate) fn new(tank: Vec3, radius: f32, liquid: Vec<Vec3>, solid: Vec<Vec3>) -> Self {
        let solver: DFSPHSolver = DFSPHSolver::new();
        let mut world = LiquidWorld::new(solver, radius, SMOOTHING, 1.0);
        let mut fluid = Fluid::new(vectors(liquid), radius, 1000.0, InteractionGroups::all());
        let viscosity = ArtificialViscosity::new(0.5, 0.0);
        fluid.nonpressure_forces.push(Box::new(viscosity));
        let fluid = world.add_fluid(fluid);
        let solid = walls(tank, radius).into_iter().chain(solid).collect();
        world.add_boundary(Boundary::new(vectors(solid), InteractionGroups::all()));
        let low = vec3(-0.5 * tank.x, 0.0, -0.5 * tank.z);
        Self {
            world,
            fluid,
            low: low + radius,
            high: vec3(0.5 * tank.x, 2.0 * tank.y, 0.5 * tank.z) - radius,
        }
    }

    /// Advances the simulation by `delta` seconds.
    pub(crate) fn step(&mut self, delta: f32) {
        let gravity = Vector::y() * GRAVITY;
        for _ in 0..SUBSTEPS {
            self.world
                .step(delta.min(LONGEST_STEP) / SUBSTEPS as f32, &gravity);
            self.contain();
        }
    }

    /// Moves particles that have slipped through a wall back to it.
    fn contain(&mut self) {
        let Some(fluid) = self.world.fluids_mut().get_mut(self.fluid) else {
            return;
        };
        for (position, velocity) in fluid.positions.iter_mut().zip(&mut fluid.velocities) {
            for axis in 0..3 {
                let inside = position[axis].clamp(self.low[axis], self.high[axis]);
                if inside != position[axis] {
                    position[axis] = inside;
                    velocity[axis] = 0.0;
                }
            }
        }
    }

    /// The positions of the particles.
    pub(crate) fn positions(&self) -> Vec<Vec3> {
        let mut positions = Vec::new();
        self.write_positions(&mut positions);
        positions
    }

    /// Writes the positions into a reused buffer.
    pub(crate) fn write_positions(&self, positions: &mut Vec<Vec3>) {
        positions.clear();
        if let Some(fluid) = self.world.fluids().get(self.fluid) {
            positions.extend(fluid.positions.iter().map(|p| vec3(p.x, p.y, p.z)));
        }
    }
}

fn vectors(points: Vec<Vec3>) -> Vec<Vector<f32>> {
    points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect()
}

/// Floor and four walls (higher than the tank: nothing spills), two layers just outside of it.
fn walls(tank: Vec3, radius: f32) -> Vec<Vec3> {
    let mut points = Vec::new();
    for layer in [1.0, 3.0] {
        let low = vec3(-0.5 * tank.x, 0.0, -0.5 * tank.z) - layer * radius;
        let high = vec3(0.5 * tank.x, 1.6 * tank.y, 0.5 * tank.z) + layer * radius;
        for (from, to) in [
            (low, high.with_y(low.y)),
            (low, high.with_x(low.x)),
            (low.with_x(high.x), high),
            (low, high.with_z(low.z)),
            (low.with_z(high.z), high),
        ] {
            points.extend(lattice(from, to, 2.0 * radius));
        }
    }
    points
}
