//! One fluid in salva's world, with names for its particles.

use bevy::prelude::*;
use salva3d::{
    LiquidWorld,
    kernel::{CubicSplineKernel, Kernel},
    object::{Fluid, FluidHandle, interaction_groups::InteractionGroups},
    solver::{Akinci2013SurfaceTension, NonPressureForce},
};

use super::{
    convert::{LiquidVector, liquid},
    forces::Friction,
};

/// What a fluid is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Substance {
    /// kg/m³.
    pub(crate) density: f32,
    /// m²/s.
    pub(crate) viscosity: f32,
    /// m²/s.
    pub(crate) wall_viscosity: f32,
    /// 1/s.
    pub(crate) drag: f32,
    /// Akinci's γ.
    pub(crate) surface_tension: f32,
    /// Akinci's β.
    pub(crate) adhesion: f32,
}

/// Particles to add.
#[derive(Clone, Debug, Default)]
pub(crate) struct Newborn {
    pub(crate) positions: Vec<Vec3>,
    /// As many as positions, or one for all.
    pub(crate) velocities: Vec<Vec3>,
}

/// A fluid. Its particles are salva's, in the same order.
pub(crate) struct Liquid {
    pub(crate) handle: FluidHandle,
    /// Ascending: particles are added at the end and removed in order.
    pub(crate) ids: Vec<u32>,
    next_id: u32,
    /// Whether particles have not been looked at yet: those within solids are taken out.
    pub(crate) is_fresh: bool,
}

/// Volume of a particle of `radius`: such that particles two radii apart, on a lattice, have
/// just the rest density.
///
/// salva's own is 0.8 of a cube, at which a lattice sinks together by a fifth of its height.
pub(crate) fn particle_volume(radius: f32) -> f32 {
    let spacing = 2.0 * radius;
    let support = SMOOTHING * spacing;
    let reach = SMOOTHING.ceil() as i32;
    let range = || -reach..=reach;
    let sum: f32 = range()
        .flat_map(|x| range().flat_map(move |y| range().map(move |z| ivec3(x, y, z))))
        .map(|cell| CubicSplineKernel::scalar_apply(cell.as_vec3().length() * spacing, support))
        .sum();
    sum.recip()
}

/// Support of the kernel over the spacing of particles.
pub(crate) const SMOOTHING: f32 = 2.0;

impl Liquid {
    pub(crate) fn new(world: &mut LiquidWorld, substance: &Substance) -> Self {
        let mut fluid = Fluid::new(
            Vec::new(),
            world.particle_radius(),
            substance.density,
            InteractionGroups::all(),
        );
        fill(&mut fluid, substance);
        Self {
            handle: world.add_fluid(fluid),
            ids: Vec::new(),
            next_id: 0,
            is_fresh: false,
        }
    }

    pub(crate) fn set_substance(&self, world: &mut LiquidWorld, substance: &Substance) {
        if let Some(fluid) = world.fluids_mut().get_mut(self.handle) {
            fill(fluid, substance);
        }
    }

    /// Adds what is finite, and tells how many were not.
    pub(crate) fn add(&mut self, world: &mut LiquidWorld, newborn: &Newborn) -> usize {
        let volume = particle_volume(world.particle_radius());
        let Some(fluid) = world.fluids_mut().get_mut(self.handle) else {
            return 0;
        };
        let velocity = |i: usize| {
            let all = &newborn.velocities;
            let own = all.get(i).or(all.last());
            own.copied().unwrap_or_default()
        };
        let (positions, velocities): (Vec<LiquidVector>, Vec<LiquidVector>) = newborn
            .positions
            .iter()
            .enumerate()
            .map(|(i, &position)| (position, velocity(i)))
            .filter(|(position, velocity)| position.is_finite() && velocity.is_finite())
            .map(|(position, velocity)| (liquid(position), liquid(velocity)))
            .unzip();
        fluid.add_particles(&positions, Some(&velocities));
        let count = fluid.positions.len();
        fluid.volumes[self.ids.len()..].fill(volume);
        while self.ids.len() < count {
            self.ids.push(self.next_id);
            self.next_id += 1;
        }
        self.is_fresh = true;
        newborn.positions.len() - positions.len()
    }

    pub(crate) fn remove_all(&mut self, world: &mut LiquidWorld) {
        if let Some(fluid) = world.fluids_mut().get_mut(self.handle) {
            for i in 0..fluid.num_particles() {
                fluid.delete_particle_at_next_timestep(i);
            }
        }
    }

    /// Drops the names of particles that salva is about to remove. To be called just before a
    /// step, which then removes them.
    pub(crate) fn forget_removed(&mut self, world: &LiquidWorld) {
        if let Some(fluid) = world.fluids().get(self.handle)
            && fluid.num_deleted_particles() > 0
        {
            let mut removed = fluid.deleted_particles_mask().iter();
            self.ids.retain(|_| removed.next() == Some(&false));
        }
    }
}

fn fill(fluid: &mut Fluid, substance: &Substance) {
    fluid.density0 = substance.density;
    let mut forces: Vec<Box<dyn NonPressureForce>> = vec![Box::new(Friction {
        viscosity: substance.viscosity,
        wall: substance.wall_viscosity,
        drag: substance.drag,
    })];
    if substance.surface_tension > 0.0 || substance.adhesion > 0.0 {
        forces.push(Box::new(Akinci2013SurfaceTension::new(
            substance.surface_tension,
            substance.adhesion,
        )));
    }
    fluid.nonpressure_forces = forces;
}
