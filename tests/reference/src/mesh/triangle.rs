//! Triangles between the pixels of a depth image.

use glam::{DVec3, UVec2};

use super::{Sheet, view_depth};
use crate::{Camera, Crossing, Image, Ray};

/// Parts of a triangle's size by which a ray may miss it: none slips between two triangles.
const SLACK: f64 = 1e-9;

/// A triangle of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    corners: [DVec3; 3],
    /// Outward unit normals at the corners.
    normals: [DVec3; 3],
    /// Outward normal of the plane.
    plane: DVec3,
    pub(super) body: usize,
}

impl Triangle {
    pub(super) fn corners(&self) -> [DVec3; 2] {
        let [a, b, c] = self.corners;
        [a.min(b).min(c), a.max(b).max(c)]
    }

    /// Möller & Trumbore 1997. In or out as the plane says, with the normal in between.
    pub(super) fn crossing(&self, ray: &Ray) -> Option<Crossing> {
        let [a, b, c] = self.corners;
        let [ab, ac] = [b - a, c - a];
        let across = ray.direction.cross(ac);
        let det = ab.dot(across);
        let from = ray.origin - a;
        let side = from.cross(ab);
        let u = from.dot(across) / det;
        let v = ray.direction.dot(side) / det;
        let w = 1.0 - u - v;
        // Not a number where the ray lies in the plane.
        if !(u.min(v).min(w) >= -SLACK) {
            return None;
        }
        let [na, nb, nc] = self.normals;
        Some(Crossing {
            t: ac.dot(side) / det,
            normal: (w * na + u * nb + v * nc).normalize(),
            entering: self.plane.dot(ray.direction) < 0.0,
            body: self.body,
        })
    }
}

/// A vertex and the sum of the normals around it.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec3,
    depth: f64,
    normal: DVec3,
}

/// The triangles of one sheet; a front's normals point to the viewer, a back's away.
pub(super) fn triangulate(camera: &Camera, sheet: &Sheet, step: f64, front: bool) -> Vec<Triangle> {
    let corners = Image::from_fn(camera.size, |pixel| {
        let depth = view_depth(camera, sheet, pixel).filter(|depth| depth.is_finite())?;
        let given = |normals: &Image<Option<DVec3>>| *normals.get(pixel);
        Some(Corner {
            at: camera.unproject(pixel.as_dvec2() + 0.5, depth),
            depth,
            normal: sheet
                .normals
                .as_ref()
                .and_then(given)
                .unwrap_or(DVec3::ZERO),
        })
    });
    let faces = faces(camera.size, &corners, step);
    let outward = |[a, b, c]: [usize; 3]| {
        let [a, b, c] = [a, b, c].map(|i| corners.pixels()[i].map_or(DVec3::ZERO, |c| c.at));
        // Faces are wound clockwise on screen, so this points to the viewer.
        let plane = (c - a).cross(b - a);
        if front { plane } else { -plane }
    };
    let mut around = corners
        .map(|corner| corner.map_or(DVec3::ZERO, |corner| corner.normal))
        .pixels()
        .to_vec();
    if sheet.normals.is_none() {
        for &face in &faces {
            for corner in face {
                // As long as the face is large.
                around[corner] += outward(face);
            }
        }
    }
    let triangle = |face: [usize; 3]| {
        let plane = outward(face);
        let normal = |i: usize| around[i].try_normalize().unwrap_or(plane.normalize());
        let at = |i: usize| corners.pixels()[i].map(|corner| corner.at);
        Some(Triangle {
            corners: [at(face[0])?, at(face[1])?, at(face[2])?],
            normals: face.map(normal),
            plane,
            body: 0,
        })
    };
    faces.iter().filter_map(|&face| triangle(face)).collect()
}

/// Triples of pixel numbers, clockwise on screen.
fn faces(size: UVec2, corners: &Image<Option<Corner>>, step: f64) -> Vec<[usize; 3]> {
    let depth = |i: usize| corners.pixels()[i].map(|corner| corner.depth);
    let whole = |face: &[usize; 3]| {
        let [Some(a), Some(b), Some(c)] = face.map(depth) else {
            return false;
        };
        a.max(b).max(c) - a.min(b).min(c) <= step
    };
    let mut out = Vec::new();
    for y in 1..size.y {
        for x in 1..size.x {
            let c = (y * size.x + x) as usize;
            let [d, b] = [c - 1, c - size.x as usize];
            let a = b - 1;
            let [falling, rising] = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
            let [kept_falling, kept_rising] =
                [falling, rising].map(|halves| halves.into_iter().filter(whole));
            let [falls, rises] = [kept_falling.clone().count(), kept_rising.clone().count()];
            let gap = |a, b| {
                depth(a)
                    .zip(depth(b))
                    .map_or(0.0, |(a, b): (f64, f64)| (a - b).abs())
            };
            // The shorter diagonal keeps ridges.
            if falls > rises || (falls == rises && gap(a, c) <= gap(b, d)) {
                out.extend(kept_falling);
            } else {
                out.extend(kept_rising);
            }
        }
    }
    out
}
