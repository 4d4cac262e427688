//! Solids in salva during a step: surface particles where liquid is near, and the liquid's forces
//! on them.
//!
//! salva's own coupling with rapier is not used: it evaluates a body's velocity at points in the
//! body's frame as if they were in the world's, and it includes every surface particle, near liquid
//! or not.

use std::{collections::BTreeMap, sync::RwLock};

use bevy::prelude::*;
use salva3d::{
    TimestepManager,
    coupling::CouplingManager,
    geometry::{HGrid, HGridEntry},
    object::{Boundary, BoundarySet, Fluid},
};

use super::{
    Id,
    convert::{from_liquid, liquid},
    geometry::Surface,
    sampling::{DEPTH, neighbors},
    solid::Solid,
};

/// Width of a cell over the kernel's support: surface particles count as far as that from liquid,
/// their own neighbours included.
const CELL: f32 = 2.0;

/// Coarse cells with liquid in or beside them.
#[derive(Default)]
pub(crate) struct Nearby {
    width: f32,
    /// Sorted.
    cells: Vec<[i32; 3]>,
}

impl Nearby {
    fn update(&mut self, support: f32, fluids: &[Fluid]) {
        self.width = CELL * support;
        self.cells.clear();
        let mut last = None;
        for position in fluids.iter().flat_map(|fluid| &fluid.positions) {
            let cell = self.cell(from_liquid(position));
            if last != Some(cell) {
                self.cells.push(cell.to_array());
                last = Some(cell);
            }
        }
        self.sort();
        let filled = self.cells.len();
        for i in 0..filled {
            let cell = IVec3::from_array(self.cells[i]);
            self.cells
                .extend(neighbors(cell).map(|cell| cell.to_array()));
        }
        self.sort();
    }

    fn sort(&mut self) {
        self.cells.sort_unstable();
        self.cells.dedup();
    }

    fn cell(&self, place: Vec3) -> IVec3 {
        (place / self.width).floor().as_ivec3()
    }

    fn contains(&self, place: Vec3) -> bool {
        let cell = self.cell(place).to_array();
        self.cells.binary_search(&cell).is_ok()
    }

    /// Points of a lattice on the plane y = 0 of `frame`, moved down by `depth`, in cells near
    /// liquid.
    fn on_plane(&self, frame: Isometry3d, depth: f32, spacing: f32, mut each: impl FnMut(Vec3)) {
        let to_frame = frame.inverse();
        // To a cell's farthest corner.
        let reach = 0.87 * self.width;
        for cell in &self.cells {
            let center = (IVec3::from_array(*cell).as_vec3() + 0.5) * self.width;
            let local = to_frame * center;
            if (local.y + depth).abs() > reach {
                continue;
            }
            let from = ((local - reach) / spacing).ceil().as_ivec3();
            let to = ((local + reach) / spacing).floor().as_ivec3();
            for x in from.x..=to.x {
                for z in from.z..=to.z {
                    let [x, z] = [x, z].map(|i| i as f32 * spacing);
                    let place = frame * vec3(x, -depth, z);
                    if self.cell(place).to_array() == *cell {
                        each(place);
                    }
                }
            }
        }
    }
}

pub(crate) struct Coupling<'a> {
    pub(crate) solids: &'a mut BTreeMap<Id, Solid>,
    pub(crate) nearby: &'a mut Nearby,
}

impl CouplingManager for Coupling<'_> {
    fn update_boundaries(
        &mut self,
        _: &TimestepManager,
        support: f32,
        radius: f32,
        _: &HGrid<HGridEntry>,
        fluids: &mut [Fluid],
        boundaries: &mut BoundarySet,
    ) {
        self.nearby.update(support, fluids);
        for solid in self.solids.values() {
            if let Some(boundary) = boundaries.get_mut(solid.boundary) {
                place(solid, boundary, self.nearby, radius);
            }
        }
    }

    fn transmit_forces(&mut self, timestep: &TimestepManager, boundaries: &BoundarySet, _: f32) {
        for solid in self.solids.values_mut() {
            let Some(boundary) = boundaries.get(solid.boundary) else {
                continue;
            };
            let Some(Ok(forces)) = boundary.forces.as_ref().map(RwLock::read) else {
                continue;
            };
            for (position, force) in boundary.positions.iter().zip(forces.iter()) {
                solid.receive(from_liquid(position), from_liquid(force) * timestep.dt());
            }
        }
    }
}

fn place(solid: &Solid, boundary: &mut Boundary, nearby: &Nearby, radius: f32) {
    boundary.positions.clear();
    boundary.velocities.clear();
    let mut add = |place: Vec3| {
        boundary.positions.push(liquid(place));
        boundary.velocities.push(liquid(solid.velocity_at(place)));
    };
    match solid.geometry.surface {
        Surface::Plane => nearby.on_plane(solid.at, DEPTH * radius, 2.0 * radius, add),
        Surface::Triangles(_) => {
            for sample in &solid.samples {
                let place = solid.at * *sample;
                if nearby.contains(place) {
                    add(place);
                }
            }
        }
    }
    boundary.volumes.clear();
    boundary.volumes.resize(boundary.positions.len(), 0.0);
    if solid.feels {
        boundary.forces.get_or_insert_default();
        boundary.clear_forces(true);
    } else {
        boundary.forces = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use salva3d::object::interaction_groups::InteractionGroups;

    #[test]
    fn a_plane_has_a_full_lattice_near_liquid_and_nothing_elsewhere() {
        let drop = Fluid::new(
            vec![liquid(vec3(0.3, 0.05, -2.0))],
            0.05,
            1000.0,
            InteractionGroups::all(),
        );
        let mut nearby = Nearby::default();
        nearby.update(0.2, &[drop]);
        let mut points = Vec::new();
        nearby.on_plane(Isometry3d::IDENTITY, 0.05, 0.1, |place| points.push(place));
        let within = |reach: f32| {
            let near = |p: &&Vec3| (p.x - 0.3).abs() < reach && (p.z + 2.0).abs() < reach;
            points.iter().filter(near).count()
        };
        // Seven by seven points within twice the support (0.4 excluded), each once.
        assert_eq!(within(0.35), 49);
        assert_eq!(within(5.0), points.len());
        assert!(points.iter().all(|p| (p.y + 0.05).abs() < 1e-6));
    }
}
