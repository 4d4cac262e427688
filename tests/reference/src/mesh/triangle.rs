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
        // None is a number where the ray lies in the plane.
        if ![u, v, w].iter().all(|&part| part >= -SLACK) {
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

/// A vertex.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec3,
    depth: f64,
}

/// The triangles of one sheet; a front's normals point to the viewer, a back's away.
pub(super) fn triangulate(
    camera: &Camera,
    sheet: &Sheet,
    body: usize,
    step: f64,
    front: bool,
) -> Vec<Triangle> {
    let corners = Image::from_fn(camera.size, |pixel| {
        let depth = view_depth(camera, sheet, pixel).filter(|depth| depth.is_finite())?;
        let at = camera.unproject(pixel.as_dvec2() + 0.5, depth);
        Some(Corner { at, depth })
    });
    let outward = |to_viewer: DVec3| if front { to_viewer } else { -to_viewer };
    let normals = Image::from_fn(camera.size, |pixel| {
        let given = sheet.normals.as_ref().map(|normals| normals.get(pixel));
        match given {
            Some(given) => given.and_then(DVec3::try_normalize),
            None => normal(&corners, pixel, step).map(outward),
        }
    });
    let triangle = |face: [usize; 3]| {
        let at = |i: usize| corners.pixels()[i].map(|corner| corner.at);
        let [a, b, c] = [at(face[0])?, at(face[1])?, at(face[2])?];
        // Faces are wound clockwise on screen, so this points to the viewer.
        let plane = outward((c - a).cross(b - a));
        let normal = |i: usize| normals.pixels()[i].unwrap_or(plane.normalize());
        Some(Triangle {
            corners: [a, b, c],
            normals: face.map(normal),
            plane,
            body,
        })
    };
    let faces = faces(camera.size, &corners, step);
    faces.into_iter().filter_map(triangle).collect()
}

/// Square to the differences between the neighbours to both sides, or to the one there is.
fn normal(corners: &Image<Option<Corner>>, pixel: UVec2, step: f64) -> Option<DVec3> {
    let here = (*corners.get(pixel))?;
    let [x, y] = pixel.as_i64vec2().to_array();
    let along = |dx: i64, dy: i64| {
        let [before, after] = [-1, 1].map(|side| {
            let next = *corners.clamped(x + side * dx, y + side * dy);
            next.filter(|next| (next.depth - here.depth).abs() <= step)
                .map_or(here.at, |next| next.at)
        });
        after - before
    };
    along(0, 1).cross(along(1, 0)).try_normalize()
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
