//! Grouping of fluids into surfaces.
//!
//! Fluids of one material share one set of layers, which is cheap and lets them merge. But surfaces
//! are painted one after the other: where a fluid of another material lies between two of them,
//! they are painted separately.

use core::ops::Range;

use bevy::prelude::*;

use super::{
    DrawnFluid,
    bounds::{Bounds, sort_few},
};
use crate::material::FluidMaterial;

/// A fluid in view.
#[derive(Clone, Copy)]
pub(super) struct Member {
    pub(super) fluid: DrawnFluid,
    pub(super) material: FluidMaterial,
    /// Particle radius in world units.
    pub(super) radius: f32,
    /// Whether what is thin in its bulk is a sheet.
    pub(super) sheets: bool,
    /// Around it, in the world.
    pub(super) bounds: Bounds,
    /// The first member of its group, by place.
    group: usize,
}

impl Member {
    pub(super) fn new(
        fluid: DrawnFluid,
        material: FluidMaterial,
        radius: f32,
        sheets: bool,
        bounds: Bounds,
    ) -> Self {
        Self {
            fluid,
            material,
            radius,
            sheets,
            bounds,
            group: 0,
        }
    }
}

/// Fluids that are drawn as one: a range of the members.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub(super) members: Range<usize>,
    /// The box around all of it.
    pub(super) bounds: Bounds,
}

/// Sorts members by groups: fluids of equal material, as few as can be painted in order for this
/// eye. Nothing is allocated once the vectors are large enough.
pub(super) fn group(members: &mut [Member], groups: &mut Vec<Group>, eye: Vec3) {
    for i in 0..members.len() {
        let material = members[i].material;
        let first = members[..i].iter().position(|it| it.material == material);
        members[i].group = first.unwrap_or(i);
    }
    for first in 0..members.len() {
        if members[first].group == first && is_split(members, first, eye) {
            split(members, first);
        }
    }
    sort_few(members, |a, b| a.group < b.group);
    groups.clear();
    for (i, member) in members.iter().enumerate() {
        match groups.last_mut() {
            Some(last) if members[last.members.start].group == member.group => {
                last.members.end = i + 1;
                last.bounds = last.bounds.union(member.bounds);
            }
            _ => groups.push(Group {
                members: i..i + 1,
                bounds: member.bounds,
            }),
        }
    }
}

/// Whether a fluid of another material may hide some of a group, and some of it that fluid.
fn is_split(members: &[Member], group: usize, eye: Vec3) -> bool {
    // Boxes on both sides of the eye hide nothing of each other.
    let hides = |a: &Bounds, b: &Bounds| a.before(b, eye) && !b.before(a, eye);
    let material = members[group].material;
    let others = members.iter().filter(|it| it.material != material);
    let mut others = others.map(|it| &it.bounds);
    others.any(|other| {
        let mut own = members.iter().filter(|it| it.group == group);
        let mut again = own.clone();
        own.any(|it| hides(&it.bounds, other)) && again.any(|it| hides(other, &it.bounds))
    })
}

/// Splits a group into parts whose boxes do not touch each other.
fn split(members: &mut [Member], group: usize) {
    let material = members[group].material;
    for (i, member) in members.iter_mut().enumerate() {
        if member.group == group && member.material == material {
            member.group = i;
        }
    }
    for i in group..members.len() {
        for j in group..i {
            let (a, b) = (members[i], members[j]);
            let one = a.material == material && b.material == material;
            if one && a.group != b.group && a.bounds.touches(&b.bounds) {
                let (kept, gone) = (a.group.min(b.group), a.group.max(b.group));
                for member in members.iter_mut().filter(|it| it.group == gone) {
                    member.group = kept;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(center: Vec3) -> Bounds {
        Bounds {
            min: center - 0.5,
            max: center + 0.5,
        }
    }

    /// How many members each group has, of fluids (is honey, place on the z axis).
    fn sizes(fluids: &[(bool, f32)]) -> Vec<(bool, usize)> {
        let fluid = DrawnFluid {
            entity: Entity::PLACEHOLDER,
            bulk: 0,
            interior: 0,
            spray: 0,
            partial: [0; 2],
        };
        let mut members: Vec<_> = fluids
            .iter()
            .map(|&(honey, z)| {
                let material = if honey {
                    FluidMaterial::HONEY
                } else {
                    FluidMaterial::WATER
                };
                Member::new(fluid, material, 0.1, true, cube(Vec3::Z * z))
            })
            .collect();
        let mut groups = Vec::new();
        group(&mut members, &mut groups, Vec3::Z * 100.0);
        groups
            .into_iter()
            .map(|group| {
                let honey = members[group.members.start].material == FluidMaterial::HONEY;
                (honey, group.members.len())
            })
            .collect()
    }

    #[test]
    fn fluids_of_one_material_are_one_surface_wherever_they_are() {
        assert_eq!(
            sizes(&[(false, 0.0), (false, 5.0), (false, 50.0)]),
            [(false, 3)]
        );
    }

    #[test]
    fn another_material_before_or_behind_splits_nothing() {
        let all = [(false, 0.0), (false, 5.0), (true, 9.0), (true, 12.0)];
        assert_eq!(sizes(&all), [(false, 2), (true, 2)]);
    }

    #[test]
    fn another_material_in_between_splits_what_does_not_touch() {
        let all = [(false, 0.0), (false, 0.8), (true, 5.0), (false, 9.0)];
        assert_eq!(sizes(&all), [(false, 2), (true, 1), (false, 1)]);
        // A chain whose boxes all touch cannot be split.
        let chain = [(false, 0.0), (true, 1.5), (false, 0.9), (false, 1.8)];
        assert_eq!(sizes(&chain), [(false, 3), (true, 1)]);
    }
}
