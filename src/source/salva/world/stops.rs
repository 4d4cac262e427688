//! Particles that hit surfaces: found along their paths through a step, and their exchange of
//! momentum with the solids.

use bevy::prelude::*;
use rayon::prelude::*;
use salva3d::{object::Fluid, rapier::pipeline::PhysicsWorld};

use super::{
    convert::{LiquidVector, from_liquid, liquid},
    guard::{self, GuardedSurface},
    solid::Solid,
};

/// A particle that a surface has stopped.
pub(crate) struct Stop {
    /// Indices of the fluid, the particle in it, and the solid.
    fluid: usize,
    particle: usize,
    solid: usize,
    /// Where it is now.
    position: Vec3,
    /// Out of the surface.
    normal: Vec3,
    /// How fast it ran into the surface, m/s.
    speed: f32,
}

/// Where the particles of a fluid have gone in a substep.
pub(crate) struct Ways<'a> {
    pub(crate) index: usize,
    pub(crate) fluid: &'a Fluid,
    pub(crate) before: &'a [LiquidVector],
    /// s.
    pub(crate) step: f32,
}

impl Ways<'_> {
    /// Finds those that meet a surface, in their order, and the speed of the fastest (m/s).
    pub(crate) fn follow(
        &self,
        surfaces: &[GuardedSurface],
        margin: f32,
        stops: &mut Vec<Stop>,
    ) -> f32 {
        let ways = self.fluid.positions.par_iter().zip(self.before);
        let (fastest, mut found) = ways
            .enumerate()
            .fold(
                || (0.0_f32, Vec::new()),
                |(fastest, mut stops), (particle, (to, from))| {
                    let (from, to) = (from_liquid(from), from_liquid(to));
                    stops.extend(self.stop(surfaces, margin, particle, from, to));
                    (fastest.max((to - from).length() / self.step), stops)
                },
            )
            .reduce(
                || (0.0, Vec::new()),
                |(fastest, mut stops), (other, mut others)| {
                    stops.append(&mut others);
                    (fastest.max(other), stops)
                },
            );
        stops.append(&mut found);
        fastest
    }

    fn stop(
        &self,
        surfaces: &[GuardedSurface],
        margin: f32,
        particle: usize,
        from: Vec3,
        to: Vec3,
    ) -> Option<Stop> {
        let stopped = guard::stop(surfaces, from, to, margin)?;
        let way = from - to + stopped.surface_motion;
        Some(Stop {
            fluid: self.index,
            particle,
            solid: stopped.surface,
            position: stopped.position,
            normal: stopped.normal,
            speed: (way.dot(stopped.normal) / self.step).max(0.0),
        })
    }
}

/// Puts particles where they were stopped, and exchanges momentum as if everything that a solid has
/// stopped moved on with it.
///
/// Handled one by one, many particles together would hand a light body more than it can take, and
/// throw it back faster than they came.
pub(crate) fn apply(
    stops: &[Stop],
    fluids: &mut [Fluid],
    solids: &mut [&mut Solid],
    rigid_world: &PhysicsWorld,
) {
    // By how much all stops together would change a solid's velocity, over theirs.
    let mut yields = vec![0.0; solids.len()];
    for stop in stops {
        let mass = fluids[stop.fluid].particle_mass(stop.particle);
        let solid = &solids[stop.solid];
        yields[stop.solid] += mass * solid.mobility(rigid_world, stop.position, stop.normal);
    }
    for stop in stops {
        let fluid = &mut fluids[stop.fluid];
        let change = stop.speed / (1.0 + yields[stop.solid]) * stop.normal;
        fluid.positions[stop.particle] = liquid(stop.position);
        fluid.velocities[stop.particle] += liquid(change);
        let mass = fluid.particle_mass(stop.particle);
        solids[stop.solid].receive(stop.position, -mass * change);
    }
}
