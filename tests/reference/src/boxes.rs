//! Which of many boxes a ray meets.

use bvh::{
    aabb::{Aabb, Bounded},
    bounding_hierarchy::BHShape,
    bvh::Bvh,
};
use glam::DVec3;
use nalgebra::{Point3, Vector3};

use crate::Ray;

/// Boxes grow by this part of the greatest coordinate of them all: `bvh` misses a box whose face
/// the ray lies in, and rays through the middles of pixels do lie in such faces.
const MARGIN: f64 = 1e-9;

/// A hierarchy of axis-parallel boxes.
pub(crate) struct Boxes {
    boxes: Vec<Numbered>,
    tree: Bvh<f64, 3>,
}

struct Numbered {
    bounds: Aabb<f64, 3>,
    index: usize,
    node: usize,
}

impl Boxes {
    /// From least and greatest corners.
    pub(crate) fn new(corners: impl Iterator<Item = [DVec3; 2]>) -> Self {
        let corners: Vec<_> = corners.collect();
        let greatest = corners
            .iter()
            .flatten()
            .fold(0.0_f64, |most, corner| most.max(corner.abs().max_element()));
        let margin = DVec3::splat(MARGIN * greatest);
        let mut boxes: Vec<_> = corners
            .into_iter()
            .enumerate()
            .map(|(index, [min, max])| Numbered {
                bounds: Aabb::with_bounds(point(min - margin), point(max + margin)),
                index,
                node: 0,
            })
            .collect();
        let tree = Bvh::build(&mut boxes);
        Self { boxes, tree }
    }

    /// Calls `visit` with the index of every box that the half line meets.
    pub(crate) fn met(&self, ray: &Ray, mut visit: impl FnMut(usize)) {
        let direction = Vector3::from(ray.direction.to_array());
        let query = bvh::ray::Ray::new(point(ray.origin), direction);
        for met in self.tree.traverse_iterator(&query, &self.boxes) {
            visit(met.index);
        }
    }
}

fn point(p: DVec3) -> Point3<f64> {
    Point3::from(p.to_array())
}

impl Bounded<f64, 3> for Numbered {
    fn aabb(&self) -> Aabb<f64, 3> {
        self.bounds
    }
}

impl BHShape<f64, 3> for Numbered {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}
