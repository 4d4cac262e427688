//! Liquids in motion: salva3d's DFSPH between walls of boundary particles.

use bevy::prelude::*;
use salva3d::{
    LiquidWorld,
    math::Vector,
    object::{Boundary, Fluid, FluidHandle, interaction_groups::InteractionGroups},
    solver::{ArtificialViscosity, DFSPHSolver},
};

/// Smoothing length over particle diameter.
const SMOOTHING: f32 = 2.0;
const GRAVITY: f32 = -9.81;
/// Steps a frame: with one, the solver throws water about.
const SUBSTEPS: u32 = 2;
/// A slow machine slows the liquid down rather than the program.
const LONGEST_STEP: f32 = 1.0 / 30.0;

/// A liquid in a tank.
#[derive(Resource)]
pub struct Simulation {
    world: LiquidWorld,
    fluid: FluidHandle,
    /// Where centres of particles may be.
    low: Vec3,
    high: Vec3,
}

impl Simulation {
    /// Liquid particles of `radius` (m) at rest at `liquid`, in a `tank` (width, height, depth; m)
    /// that stands on y = 0 about the origin, among `solid` particles.
    pub fn new(tank: Vec3, radius: f32, liquid: Vec<Vec3>, solid: Vec<Vec3>) -> Self {
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

    /// Moves on by `delta` seconds.
    pub fn step(&mut self, delta: f32) {
        let gravity = Vector::y() * GRAVITY;
        for _ in 0..SUBSTEPS {
            self.world
                .step(delta.min(LONGEST_STEP) / SUBSTEPS as f32, &gravity);
            self.contain();
        }
    }

    /// What has slipped between the particles of a wall is put back to it.
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

    /// Where the particles are.
    pub fn positions(&self) -> Vec<Vec3> {
        let mut positions = Vec::new();
        self.write_positions(&mut positions);
        positions
    }

    /// The same, into a buffer that is used again.
    pub fn write_positions(&self, positions: &mut Vec<Vec3>) {
        positions.clear();
        if let Some(fluid) = self.world.fluids().get(self.fluid) {
            positions.extend(fluid.positions.iter().map(|p| vec3(p.x, p.y, p.z)));
        }
    }
}

/// A block of liquid at the left wall of a tank, as deep as the tank: `dam` wide and high.
pub fn dam(tank: Vec3, dam: Vec2, radius: f32) -> Vec<Vec3> {
    let low = vec3(-0.5 * tank.x, 0.0, -0.5 * tank.z);
    let high = low + vec3(dam.x, dam.y, tank.z);
    lattice(low + radius, high - radius, 2.0 * radius)
}

fn vectors(points: Vec<Vec3>) -> Vec<Vector<f32>> {
    points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect()
}

/// Points from `low` to `high`, both included where they are a multiple of `spacing` apart.
pub fn lattice(low: Vec3, high: Vec3, spacing: f32) -> Vec<Vec3> {
    let steps = ((high - low) / spacing + 1e-3).floor().as_ivec3();
    let mut points = Vec::new();
    for x in 0..=steps.x {
        for y in 0..=steps.y {
            for z in 0..=steps.z {
                points.push(low + ivec3(x, y, z).as_vec3() * spacing);
            }
        }
    }
    points
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

/// The mantle of an upright cylinder (foot, radius), in particles of `radius`.
pub fn cylinder((foot, size): (Vec2, f32), height: f32, radius: f32) -> Vec<Vec3> {
    let around = (core::f32::consts::TAU * size / (2.0 * radius)).ceil() as u32;
    let up = (height / (2.0 * radius)).ceil() as u32;
    let mut points = Vec::new();
    for i in 0..around {
        let angle = core::f32::consts::TAU * i as f32 / around as f32;
        let side = foot + (size - radius) * Vec2::from_angle(angle);
        points.extend((0..up).map(|j| vec3(side.x, (2 * j + 1) as f32 * radius, side.y)));
    }
    points
}
