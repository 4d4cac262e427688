//! Commands to the simulation, and its reports.

use std::time::Duration;

use bevy::prelude::*;

use super::{
    Id, Limits, Liquid, Newborn, Recipe, Solid, Substance, Traits, World, new_liquid_world,
};

/// A change from outside.
pub(crate) enum Command {
    /// From now on every particle has this radius (m).
    Radius(f32),
    /// These are all particles of a fluid, which may be new.
    Fluid(Id, Substance, Newborn),
    /// A fluid is of another substance.
    Substance(Id, Substance),
    /// These particles are added to the fluid where there is room for them.
    Add(Id, Newborn),
    /// Which particles of the fluid stay.
    Limit(Id, Limits),
    RemoveFluid(Id),
    /// A solid is new, or of another shape.
    Solid {
        id: Id,
        recipe: Recipe,
        traits: Traits,
        at: Isometry3d,
        /// Whether a body keeps its place and its motion.
        goes_on: bool,
    },
    /// A solid of the same shape has other traits.
    Alter(Id, Traits),
    /// Where a kinematic solid is to be at the end of the job.
    Move(Id, Isometry3d),
    /// Where a solid is at once.
    Jump(Id, Isometry3d),
    RemoveSolid(Id),
    /// Everything is moved by this way (m): the origin is elsewhere.
    Shift(Vec3),
    /// All particles of a fluid are moved.
    Carry(Id, Isometry3d),
}

/// The work to do in one go.
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
    /// m/s; a solid whose way is faster jumps.
    pub(crate) jump_speed: f32,
    /// What is outside is taken out, m.
    pub(crate) bounds: [Vec3; 2],
}

/// The result of a job.
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
    /// Solids whose shape could not be made.
    pub(crate) unmade: Vec<Id>,
}

impl Command {
    /// Joins the waiting commands, and removes those that it makes needless: while time is paused,
    /// they would pile up.
    pub(crate) fn join(self, waiting: &mut Vec<Self>) {
        waiting.retain(|old| !self.replaces(old));
        waiting.push(self);
        waiting.dedup_by(|next, first| match (first, next) {
            (Self::Shift(first), Self::Shift(next)) => {
                *first += *next;
                true
            }
            _ => false,
        });
    }

    fn replaces(&self, old: &Self) -> bool {
        match (self, old) {
            (Self::Radius(_), Self::Radius(_)) => true,
            (Self::Substance(id, _), Self::Substance(other, _))
            | (Self::Limit(id, _), Self::Limit(other, _))
            | (Self::Alter(id, _), Self::Alter(other, _))
            | (Self::Jump(id, _), Self::Jump(other, _)) => id == other,
            (Self::RemoveFluid(id), old) => old.fluid() == Some(*id),
            (Self::Solid { id, .. } | Self::RemoveSolid(id), old) => old.solid() == Some(*id),
            _ => false,
        }
    }

    fn fluid(&self) -> Option<Id> {
        match self {
            Self::Fluid(id, ..)
            | Self::Substance(id, _)
            | Self::Add(id, _)
            | Self::Limit(id, _)
            | Self::Carry(id, _)
            | Self::RemoveFluid(id) => Some(*id),
            _ => None,
        }
    }

    fn solid(&self) -> Option<Id> {
        match self {
            Self::Solid { id, .. }
            | Self::Alter(id, _)
            | Self::Move(id, _)
            | Self::Jump(id, _)
            | Self::RemoveSolid(id) => Some(*id),
            _ => None,
        }
    }
}

impl World {
    /// Applies `commands` in order; `told` is the number of commands given with them.
    pub(crate) fn apply(&mut self, commands: impl IntoIterator<Item = Command>, told: u64) {
        for command in commands {
            self.apply_one(command);
        }
        self.applied = told;
    }

    fn apply_one(&mut self, command: Command) {
        match command {
            Command::Radius(radius) => self.set_radius(radius),
            Command::Fluid(id, substance, particles) => {
                let liquid = self.liquids.entry(id).or_insert_with(|| {
                    let free = self.free.pop();
                    free.unwrap_or_else(|| Liquid::new(&mut self.liquid_world, &substance))
                });
                let world = &mut self.liquid_world;
                liquid.set_substance(world, &substance);
                liquid.remove_all(world);
                self.report.broken += liquid.add(world, &particles, self.time);
                liquid.is_fresh = true;
            }
            Command::Substance(id, substance) => {
                if let Some(liquid) = self.liquids.get(&id) {
                    liquid.set_substance(&mut self.liquid_world, &substance);
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
                recipe,
                traits,
                at,
                goes_on,
            } => {
                let before = self.solids.remove(&id);
                let before = before.inspect(|solid| self.take_out_solid(solid));
                let Some(geometry) = recipe.make() else {
                    self.report.unmade.push(id);
                    return;
                };
                let (rigid_world, liquid_world) = (&mut self.rigid_world, &mut self.liquid_world);
                let mut solid = Solid::new(rigid_world, liquid_world, geometry, traits, at);
                if let Some(before) = before.filter(|_| goes_on) {
                    solid.go_on(rigid_world, &before);
                }
                if !solid.sample(self.liquid_world.particle_radius()) {
                    self.report.unsampled.push(id);
                }
                self.solids.insert(id, solid);
            }
            Command::Alter(id, traits) => {
                if let Some(solid) = self.solids.get_mut(&id) {
                    solid.alter(&mut self.rigid_world, traits);
                }
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
            Command::RemoveSolid(id) => {
                if let Some(solid) = self.solids.remove(&id) {
                    self.take_out_solid(&solid);
                }
            }
            Command::Shift(by) => self.shift(by),
            Command::Carry(id, way) => {
                if let Some(liquid) = self.liquids.get(&id) {
                    liquid.carry(&mut self.liquid_world, &way);
                }
            }
        }
    }

    fn shift(&mut self, by: Vec3) {
        let way = Isometry3d::from_translation(by);
        for liquid in self.liquids.values_mut() {
            liquid.carry(&mut self.liquid_world, &way);
            liquid.limits.shift(by);
        }
        for solid in self.solids.values_mut() {
            solid.shift(&mut self.rigid_world, by);
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

    fn take_out_solid(&mut self, solid: &Solid) {
        self.liquid_world.remove_boundary(solid.boundary);
        self.rigid_world.remove_body(solid.body);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// While time is paused, no number of shifts piles up, whatever is told between them.
    #[test]
    fn shifts_join() {
        let limits = |x: f32| {
            let bounds = Some((Mat4::from_translation(Vec3::X * x), [Vec3::ZERO, Vec3::ONE]));
            Command::Limit(
                7,
                Limits {
                    bounds,
                    ..default()
                },
            )
        };
        let mut waiting = Vec::new();
        for i in 0..10 {
            Command::Shift(Vec3::X).join(&mut waiting);
            limits(i as f32).join(&mut waiting);
        }
        let [Command::Shift(way), Command::Limit(..)] = waiting[..] else {
            panic!("{} commands", waiting.len());
        };
        assert_eq!(way, Vec3::X * 10.0);
        // What is added between two shifts comes along with the second alone.
        Command::Add(7, Newborn::default()).join(&mut waiting);
        Command::Shift(Vec3::Y).join(&mut waiting);
        assert_eq!(waiting.len(), 4);
    }
}
