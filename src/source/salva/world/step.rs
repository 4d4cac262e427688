//! A job: steps, and the substeps in them.

use bevy::prelude::*;

use super::{
    Frame, Job, Report, Solid, World,
    convert::{from_liquid, liquid, rigid},
    coupling::Coupling,
    guard::GuardedSurface,
    stops::{self, Ways},
};
use crate::clock::now;

/// How far a particle may move in a substep, in diameters.
const CFL: f32 = 0.4;
/// How far before a surface a particle is stopped, in radii.
const MARGIN: f32 = 0.05;
/// Particles nearer than this to a solid at the start are within it, in radii.
const WITHIN: f32 = 0.5;

impl World {
    /// Does a job and writes the state it ends with into `frame`.
    pub(crate) fn advance(&mut self, job: &Job, frame: &mut Frame) -> Report {
        let start = now();
        let total = job.steps as f32 * job.step;
        for solid in self.solids.values_mut() {
            solid.head_for_target(total);
            // So fast it has been put elsewhere, and would only throw particles out of the world.
            if !solid.is_dynamic() && solid.speed() > job.jump_speed {
                solid.jump(&mut self.rigid_world, solid.target);
            }
            (solid.pushed, solid.turned) = (Vec3::ZERO, Vec3::ZERO);
        }
        let mut left = total;
        for _ in 0..job.steps {
            self.step(job, &mut left);
            self.report.steps += 1;
            if job.budget.is_some_and(|budget| start.elapsed() >= budget) {
                break;
            }
        }
        let simulated = total - left;
        self.time += f64::from(simulated);
        self.write(frame, simulated);
        Report {
            simulated,
            took: start.elapsed(),
            ..core::mem::take(&mut self.report)
        }
    }

    /// One step, in as many substeps as its fastest particle needs.
    fn step(&mut self, job: &Job, left: &mut f32) {
        let solids = self.solids.values().map(|solid| solid.velocity.length());
        let fastest = solids.fold(self.fastest, f32::max) + job.gravity.length() * job.step;
        let farthest = CFL * 2.0 * self.liquid_world.particle_radius();
        let substeps = (fastest * job.step / farthest).ceil();
        let substeps = substeps.clamp(1.0, job.max_substeps.max(1) as f32);
        for _ in 0..substeps as u32 {
            let step = job.step / substeps;
            self.substep(job, step, *left);
            *left -= step;
        }
    }

    fn substep(&mut self, job: &Job, step: f32, left: f32) {
        self.take_out(job);
        self.remember();
        self.liquid_world.step_with_coupling(
            step,
            &liquid(job.gravity),
            &mut Coupling {
                solids: &mut self.solids,
                nearby: &mut self.nearby,
            },
        );
        for solid in self.solids.values_mut() {
            solid.take_push(&mut self.rigid_world);
            solid.follow(&mut self.rigid_world, step, left);
        }
        if self.solids.values().any(Solid::is_dynamic) {
            self.rigid_world.gravity = rigid(job.gravity);
            self.rigid_world.integration_parameters.dt = step;
            self.rigid_world.step();
            for solid in self.solids.values_mut() {
                solid.read_body(&self.rigid_world);
            }
        }
        self.guard(step);
    }

    /// Marks particles that cannot be simulated, or are not to be. salva removes them with the
    /// next step.
    fn take_out(&mut self, job: &Job) {
        let [low, high] = job.bounds;
        let within = WITHIN * self.liquid_world.particle_radius();
        let is_within_solid = |place: Vec3| {
            let distance = |solid: &Solid| solid.geometry.distance(solid.at.inverse() * place);
            self.solids.values().any(|solid| distance(solid) < within)
        };
        for liquid in self.liquids.values_mut().chain(&mut self.free) {
            let Some(fluid) = self.liquid_world.fluids_mut().get_mut(liquid.handle) else {
                continue;
            };
            let is_fresh = core::mem::take(&mut liquid.is_fresh);
            let limits = liquid.limits;
            let oldest = self.time - f64::from(limits.lifetime);
            let alive = fluid.num_particles() - fluid.num_deleted_particles();
            let mut surplus = alive.saturating_sub(limits.capacity);
            for i in 0..fluid.num_particles() {
                if fluid.deleted_particles[i] {
                    continue;
                }
                let position = from_liquid(&fluid.positions[i]);
                let speed = from_liquid(&fluid.velocities[i]).length();
                // NaN is not sound.
                let is_sound = position.is_finite() && speed <= job.max_speed;
                let is_inside = is_between(position, low, high)
                    && limits.bounds.is_none_or(|(space, [low, high])| {
                        is_between(space.transform_point3(position), low, high)
                    });
                let stays = is_sound
                    && is_inside
                    && surplus == 0
                    && liquid.born[i] >= oldest
                    && !(is_fresh && is_within_solid(position));
                if !stays {
                    fluid.delete_particle_at_next_timestep(i);
                    surplus = surplus.saturating_sub(1);
                    self.report.broken += usize::from(!is_sound);
                }
            }
            liquid.forget_removed(&self.liquid_world);
        }
    }

    /// Keeps the positions of the particles that stay.
    fn remember(&mut self) {
        let fluids = self.liquid_world.fluids().as_slice();
        self.before.resize_with(fluids.len(), Vec::new);
        for (before, fluid) in self.before.iter_mut().zip(fluids) {
            let removed = fluid.deleted_particles_mask();
            let kept = fluid.positions.iter().zip(removed);
            before.clear();
            before.extend(kept.filter(|(_, removed)| !**removed).map(|(p, _)| *p));
        }
    }

    /// Stops particles at surfaces, and finds the fastest.
    fn guard(&mut self, step: f32) {
        let surfaces: Vec<_> = self
            .solids
            .values()
            .map(|solid| GuardedSurface::new(&*solid.geometry.shell.0, solid.before, solid.at))
            .collect();
        let margin = MARGIN * self.liquid_world.particle_radius();
        self.stops.clear();
        self.fastest = 0.0;
        let fluids = self.liquid_world.fluids().as_slice();
        for (index, (fluid, before)) in fluids.iter().zip(&self.before).enumerate() {
            let way = Ways {
                index,
                fluid,
                before,
                step,
            };
            let fastest = way.follow(&surfaces, margin, &mut self.stops);
            self.fastest = self.fastest.max(fastest);
        }
        let fluids = self.liquid_world.fluids_mut().as_mut_slice();
        let mut solids: Vec<_> = self.solids.values_mut().collect();
        stops::apply(&self.stops, fluids, &mut solids, &self.rigid_world);
    }
}

fn is_between(place: Vec3, low: Vec3, high: Vec3) -> bool {
    place.cmpge(low).all() && place.cmple(high).all()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn job(steps: u32, budget: Option<Duration>) -> Job {
        Job {
            steps,
            step: 0.01,
            budget,
            max_substeps: 4,
            gravity: Vec3::NEG_Y * 9.81,
            max_speed: 100.0,
            jump_speed: 50.0,
            bounds: [Vec3::splat(-1e3), Vec3::splat(1e3)],
        }
    }

    #[test]
    fn no_step_is_begun_beyond_the_budget() {
        let mut frame = Frame::default();
        let mut world = World::default();
        let report = world.advance(&job(8, Some(Duration::ZERO)), &mut frame);
        assert_eq!(report.steps, 1);
        assert!((report.simulated - 0.01).abs() < 1e-6);
        let report = world.advance(&job(8, None), &mut frame);
        assert_eq!(report.steps, 8);
        assert!((report.simulated - 0.08).abs() < 1e-6);
        assert!((frame.time - 0.09).abs() < 1e-6);
    }
}
