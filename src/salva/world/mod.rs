//! The simulation itself: salva's liquid and rapier's bodies. It knows nothing of Bevy's world and
//! lives where it is sent to.

mod convert;
mod coupling;
mod forces;
mod frame;
mod geometry;
mod guard;
mod liquid;
mod sampling;
mod solid;

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use bevy::prelude::*;
use rayon::prelude::*;
use salva3d::{LiquidWorld, object::Fluid, rapier::pipeline::PhysicsWorld, solver::IISPHSolver};

use self::{
    convert::{LiquidVector, from_liquid, liquid, rigid},
    coupling::{Coupling, Nearby},
    guard::GuardedSurface,
    liquid::{Liquid, SMOOTHING},
    solid::Solid,
};
pub(crate) use self::{
    frame::{Frame, blend},
    geometry::Geometry,
    liquid::{Limits, Newborn, Substance},
    sampling::Triangle,
    solid::{Contact, Motion},
};

/// The name of an entity in the simulation.
pub(crate) type Id = u64;

/// How far a particle may move in a substep, in diameters.
const CFL: f32 = 0.4;
/// Mean error of density that the solver leaves, and its most iterations. Measured on columns at
/// rest: less error costs several times more and is no calmer.
const DENSITY_ERROR: f32 = 0.03;
const MAX_ITERATIONS: usize = 30;
/// How far before a surface a particle is stopped, in radii.
const MARGIN: f32 = 0.05;
/// Particles nearer than this to a solid at the start are within it, in radii.
const WITHIN: f32 = 0.5;

/// A change from outside.
pub(crate) enum Command {
    /// From now on every particle has this radius (m).
    Radius(f32),
    /// A fluid is new, or of another substance.
    Fluid(Id, Substance),
    /// These are all particles of the fluid.
    Replace(Id, Newborn),
    /// These particles are added to the fluid where there is room for them.
    Add(Id, Newborn),
    /// Which particles of the fluid stay.
    Limit(Id, Limits),
    RemoveFluid(Id),
    /// A solid is new, or another than it was.
    Solid {
        id: Id,
        geometry: Geometry,
        motion: Motion,
        contact: Contact,
        at: Isometry3d,
        feels: bool,
    },
    /// Where a kinematic solid is to be at the end of the job.
    Move(Id, Isometry3d),
    /// Where a solid is at once.
    Jump(Id, Isometry3d),
    RemoveSolid(Id),
}

/// What is to be done in one go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Job {
    pub(crate) steps: u32,
    /// s.
    pub(crate) step: f32,
    /// No step is begun after this time.
    pub(crate) budget: Option<Duration>,
    pub(crate) max_substeps: u32,
    /// m/s².
    pub(crate) gravity: Vec3,
    /// m/s; what is faster is taken out.
    pub(crate) max_speed: f32,
    /// What is outside is taken out, m.
    pub(crate) bounds: [Vec3; 2],
}

/// What became of a job.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Report {
    /// s.
    pub(crate) simulated: f32,
    pub(crate) took: Duration,
    pub(crate) steps: u32,
    /// Particles taken out because they were not finite or too fast.
    pub(crate) broken: usize,
    /// Solids whose surface takes too many particles.
    pub(crate) unsampled: Vec<Id>,
}

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
    /// m/s, the fastest particle of the last step.
    fastest: f32,
    time: f64,
    /// Commands applied so far.
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
            fastest: 0.0,
            time: 0.0,
            applied: 0,
            report: default(),
        }
    }
}

fn new_liquid_world(radius: f32) -> LiquidWorld {
    // salva's DFSPH takes every solid for one at rest in its divergence solve: what moves would stir
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
    /// Applies `commands` in their order.
    pub(crate) fn apply(&mut self, commands: impl IntoIterator<Item = Command>) {
        for command in commands {
            self.apply_one(command);
            self.applied += 1;
        }
    }

    fn apply_one(&mut self, command: Command) {
        match command {
            Command::Radius(radius) => self.set_radius(radius),
            Command::Fluid(id, substance) => {
                let liquid = self.liquids.entry(id).or_insert_with(|| {
                    let free = self.free.pop();
                    free.unwrap_or_else(|| Liquid::new(&mut self.liquid_world, &substance))
                });
                liquid.set_substance(&mut self.liquid_world, &substance);
            }
            Command::Replace(id, particles) => {
                if let Some(liquid) = self.liquids.get_mut(&id) {
                    liquid.remove_all(&mut self.liquid_world);
                    let world = &mut self.liquid_world;
                    self.report.broken += liquid.add(world, &particles, self.time);
                    liquid.is_fresh = true;
                }
            }
            Command::Add(id, particles) => {
                if let Some(liquid) = self.liquids.get_mut(&id) {
                    let world = &mut self.liquid_world;
                    self.report.broken += liquid.squeeze_in(world, particles, self.time);
                }
            }
            Command::Limit(id, limits) => {
                if let Some(liquid) = self.liquids.get_mut(&id) {
                    liquid.limits = limits;
                }
            }
            Command::RemoveFluid(id) => {
                if let Some(mut liquid) = self.liquids.remove(&id) {
                    liquid.remove_all(&mut self.liquid_world);
                    liquid.limits = Limits::default();
                    self.free.push(liquid);
                }
            }
            Command::Solid {
                id,
                geometry,
                motion,
                contact,
                at,
                feels,
            } => {
                self.remove_solid(id);
                let (rigid_world, liquid_world) = (&mut self.rigid_world, &mut self.liquid_world);
                let mut solid =
                    Solid::new(rigid_world, liquid_world, geometry, motion, contact, at);
                solid.feels |= feels;
                if !solid.sample(self.liquid_world.particle_radius()) {
                    self.report.unsampled.push(id);
                }
                self.solids.insert(id, solid);
            }
            Command::Move(id, at) => {
                if let Some(solid) = self.solids.get_mut(&id) {
                    solid.target = at;
                }
            }
            Command::Jump(id, at) => {
                if let Some(solid) = self.solids.get_mut(&id) {
                    solid.jump(&mut self.rigid_world, at);
                }
            }
            Command::RemoveSolid(id) => self.remove_solid(id),
        }
    }

    /// Liquids are gone, solids stay.
    fn set_radius(&mut self, radius: f32) {
        if radius == self.liquid_world.particle_radius() {
            return;
        }
        self.liquid_world = new_liquid_world(radius);
        self.liquids.clear();
        self.free.clear();
        for (id, solid) in &mut self.solids {
            if !solid.enter(&mut self.liquid_world) {
                self.report.unsampled.push(*id);
            }
        }
    }

    fn remove_solid(&mut self, id: Id) {
        if let Some(solid) = self.solids.remove(&id) {
            self.liquid_world.remove_boundary(solid.boundary);
            self.rigid_world.remove_body(solid.body);
        }
    }

    /// Does a job and writes the state it ends with into `frame`.
    pub(crate) fn advance(&mut self, job: &Job, frame: &mut Frame) -> Report {
        let start = Instant::now();
        let total = job.steps as f32 * job.step;
        for solid in self.solids.values_mut() {
            solid.head_for_target(total);
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

    /// One step, in as many substeps as its fastest particle asks for.
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
                // Neither is what is not a number.
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
        let fluids = self.liquid_world.fluids_mut().as_mut_slice().iter_mut();
        self.fastest = fluids
            .zip(&self.before)
            .map(|(fluid, before)| guard_fluid(fluid, before, &surfaces, margin, step))
            .fold(0.0, f32::max);
    }

    fn write(&self, frame: &mut Frame, simulated: f32) {
        frame.time = self.time;
        frame.applied = self.applied;
        frame.liquids.resize_with(self.liquids.len(), default);
        for ((id, liquid), to) in self.liquids.iter().zip(&mut frame.liquids) {
            to.id = *id;
            to.ids.clone_from(&liquid.ids);
            to.positions.clear();
            if let Some(fluid) = self.liquid_world.fluids().get(liquid.handle) {
                to.positions.extend(fluid.positions.iter().map(from_liquid));
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

fn is_between(place: Vec3, low: Vec3, high: Vec3) -> bool {
    place.cmpge(low).all() && place.cmple(high).all()
}

/// The speed of the fastest particle, m/s.
fn guard_fluid(
    fluid: &mut Fluid,
    before: &[LiquidVector],
    surfaces: &[GuardedSurface],
    margin: f32,
    step: f32,
) -> f32 {
    let particles = fluid.positions.par_iter_mut().zip(&mut fluid.velocities);
    particles
        .zip(before)
        .map(|((position, velocity), before)| {
            let (from, to) = (from_liquid(before), from_liquid(position));
            if let Some(stopped) = guard::stop(surfaces, from, to, margin) {
                *position = liquid(stopped.position);
                let into = (to - from - stopped.surface_motion).dot(stopped.normal) / step;
                if into < 0.0 {
                    *velocity -= liquid(into * stopped.normal);
                }
            }
            (to - from).length() / step
        })
        .reduce(|| 0.0, f32::max)
}
