//! One fluid in salva's world, with names for its particles.

use std::collections::HashMap;

use bevy::prelude::*;
use salva3d::{
    LiquidWorld,
    kernel::{CubicSplineKernel, Kernel},
    object::{Fluid, FluidHandle, interaction_groups::InteractionGroups},
    solver::{Akinci2013SurfaceTension, NonPressureForce},
};

use super::{
    convert::{LiquidVector, from_liquid, liquid},
    forces::Friction,
    sampling::neighbors,
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

/// Which particles of a fluid may stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    /// s.
    pub(crate) lifetime: f32,
    /// The oldest make room.
    pub(crate) capacity: usize,
    /// The transform into a space, and the corners of the box in it that they stay in.
    pub(crate) bounds: Option<(Mat4, [Vec3; 2])>,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            lifetime: f32::INFINITY,
            capacity: usize::MAX,
            bounds: None,
        }
    }
}

impl Limits {
    /// The world is shifted.
    pub(crate) fn shift(&mut self, by: Vec3) {
        if let Some((to_space, _)) = &mut self.bounds {
            *to_space *= Mat4::from_translation(-by);
        }
    }
}

/// How far a particle that is added keeps from others, in diameters.
const ELBOW_ROOM: f32 = 0.8;

/// A fluid. Its particles are salva's, in the same order.
pub(crate) struct Liquid {
    pub(crate) handle: FluidHandle,
    /// Ascending: particles are added at the end and removed in order.
    pub(crate) ids: Vec<u32>,
    next_id: u32,
    /// When they came in, s of simulated time.
    pub(crate) born: Vec<f64>,
    pub(crate) limits: Limits,
    /// Whether particles are not checked yet: those within solids are removed.
    pub(crate) is_fresh: bool,
}

/// Volume of a particle of `radius`: such that particles two radii apart, on a lattice, have
/// just the rest density.
///
/// salva's own is 0.8 of a cube, at which a lattice collapses by a fifth of its height.
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
            born: Vec::new(),
            limits: Limits::default(),
            is_fresh: false,
        }
    }

    pub(crate) fn set_substance(&self, world: &mut LiquidWorld, substance: &Substance) {
        if let Some(fluid) = world.fluids_mut().get_mut(self.handle) {
            fill(fluid, substance);
        }
    }

    /// Adds those that have room beside the others: a nozzle emits no more than fits through.
    pub(crate) fn squeeze_in(
        &mut self,
        world: &mut LiquidWorld,
        newborn: Newborn,
        now: f64,
    ) -> usize {
        let room = ELBOW_ROOM * 2.0 * world.particle_radius();
        let Some(fluid) = world.fluids().get(self.handle) else {
            return 0;
        };
        let new = newborn.positions.iter();
        let low = new.clone().copied().fold(Vec3::INFINITY, Vec3::min) - room;
        let high = new.copied().fold(Vec3::NEG_INFINITY, Vec3::max) + room;
        let cell = |place: Vec3| (place / room).floor().as_ivec3();
        let mut taken: HashMap<IVec3, Vec<Vec3>> = HashMap::new();
        for place in fluid.positions.iter().map(from_liquid) {
            if place.cmpge(low).all() && place.cmple(high).all() {
                taken.entry(cell(place)).or_default().push(place);
            }
        }
        let mut has_room = |place: Vec3| {
            let has_room = neighbors(cell(place))
                .filter_map(|cell| taken.get(&cell))
                .flatten()
                .all(|other| other.distance_squared(place) >= room * room);
            if has_room {
                taken.entry(cell(place)).or_default().push(place);
            }
            has_room
        };
        let particles = newborn.positions.into_iter().zip(newborn.velocities);
        let (positions, velocities) = particles.filter(|(place, _)| has_room(*place)).unzip();
        let newborn = Newborn {
            positions,
            velocities,
        };
        self.add(world, &newborn, now)
    }

    /// Adds the finite particles, and returns how many were not finite.
    pub(crate) fn add(&mut self, world: &mut LiquidWorld, newborn: &Newborn, now: f64) -> usize {
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
            self.born.push(now);
            self.next_id = self.next_id.wrapping_add(1);
        }
        newborn.positions.len() - positions.len()
    }

    /// Moves and turns all particles.
    pub(crate) fn carry(&self, world: &mut LiquidWorld, way: &Isometry3d) {
        let Some(fluid) = world.fluids_mut().get_mut(self.handle) else {
            return;
        };
        for position in &mut fluid.positions {
            *position = liquid(*way * from_liquid(position));
        }
        for velocity in &mut fluid.velocities {
            *velocity = liquid(way.rotation * from_liquid(velocity));
        }
    }

    pub(crate) fn remove_all(&self, world: &mut LiquidWorld) {
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
            let mut removed = fluid.deleted_particles_mask().iter();
            self.born.retain(|_| removed.next() == Some(&false));
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
