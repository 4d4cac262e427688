//! Grouping of fluids into bodies.
//!
//! Fluids of one material share one set of layers, which is cheap and lets them merge. But bodies
//! are painted one after the other: where a fluid of another material lies between two of them,
//! they are painted separately.

use bevy::prelude::*;

use super::{bounds::Bounds, extract::ExtractedFluid};
use crate::material::FluidMaterial;

/// A fluid in view.
pub(crate) struct Member<'a> {
    pub(crate) entity: Entity,
    pub(crate) fluid: &'a ExtractedFluid,
    /// Around it, in the world.
    pub(crate) bounds: Bounds,
}

/// Fluids that are drawn as one.
pub(crate) struct Group<'a> {
    pub(crate) material: FluidMaterial,
    pub(crate) members: Vec<Member<'a>>,
}

impl Group<'_> {
    /// The box around all of it.
    pub(crate) fn bounds(&self) -> Bounds {
        let boxes = self.members.iter().map(|member| member.bounds);
        boxes.fold(Bounds::EMPTY, Bounds::union)
    }
}

/// Groups of fluids of equal material, as few as can be painted in order for this eye.
pub(crate) fn groups<'a>(members: impl Iterator<Item = Member<'a>>, eye: Vec3) -> Vec<Group<'a>> {
    let mut whole = Vec::<Group>::new();
    for member in members {
        let material = member.fluid.material;
        match whole.iter_mut().find(|group| group.material == material) {
            Some(group) => group.members.push(member),
            None => whole.push(Group {
                material,
                members: vec![member],
            }),
        }
    }
    if whole.len() < 2 {
        return whole;
    }
    let boxes: Vec<Vec<Bounds>> = whole
        .iter()
        .map(|group| group.members.iter().map(|member| member.bounds).collect())
        .collect();
    let split = |i: usize| {
        let mut others = boxes.iter().enumerate().filter(|(j, _)| *j != i);
        others.any(|(_, others)| {
            others
                .iter()
                .any(|other| lies_between(other, &boxes[i], eye))
        })
    };
    let split: Vec<bool> = (0..whole.len()).map(split).collect();
    whole
        .into_iter()
        .zip(split)
        .flat_map(|(group, split)| if split { touching(group) } else { vec![group] })
        .collect()
}

/// Whether some of the boxes may hide `other`, and `other` some of them.
fn lies_between(other: &Bounds, boxes: &[Bounds], eye: Vec3) -> bool {
    // Boxes on both sides of the eye hide nothing of each other.
    let hides = |a: &Bounds, b: &Bounds| a.before(b, eye) && !b.before(a, eye);
    boxes.iter().any(|it| hides(it, other)) && boxes.iter().any(|it| hides(other, it))
}

/// The group in parts whose boxes do not touch each other.
fn touching(group: Group) -> Vec<Group> {
    let material = group.material;
    let mut parts = Vec::<Group>::new();
    for member in group.members {
        let bounds = member.bounds;
        let mut joined = Group {
            material,
            members: vec![member],
        };
        // All parts that the new one touches become one.
        let (touched, apart) = parts.into_iter().partition::<Vec<_>, _>(|part| {
            let mut members = part.members.iter();
            members.any(|other| other.bounds.touches(&bounds))
        });
        for part in touched {
            joined.members.extend(part.members);
        }
        parts = apart;
        parts.push(joined);
    }
    parts
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
        let extracted: Vec<_> = fluids
            .iter()
            .map(|(honey, _)| {
                let mut fluid = ExtractedFluid::default();
                if *honey {
                    fluid.material = FluidMaterial::HONEY;
                }
                fluid
            })
            .collect();
        let members = extracted.iter().zip(fluids).map(|(fluid, (_, z))| Member {
            entity: Entity::PLACEHOLDER,
            fluid,
            bounds: cube(Vec3::Z * z),
        });
        let groups = groups(members, Vec3::Z * 100.0);
        let honey = |group: &Group| group.material == FluidMaterial::HONEY;
        groups
            .iter()
            .map(|group| (honey(group), group.members.len()))
            .collect()
    }

    #[test]
    fn fluids_of_one_material_are_one_body_wherever_they_are() {
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
        assert_eq!(sizes(&all), [(false, 2), (false, 1), (true, 1)]);
        // A chain whose boxes all touch cannot be split.
        let chain = [(false, 0.0), (true, 1.5), (false, 0.9), (false, 1.8)];
        assert_eq!(sizes(&chain), [(false, 3), (true, 1)]);
    }
}
