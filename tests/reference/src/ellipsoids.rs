//! The exact union of splatted ellipsoids.

use glam::{DMat3, DVec3};

use crate::{Crossing, Ray, Surface, boxes::Boxes, surface::keep_outermost};

/// The points c + M u with |u| ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Centre c, m.
    pub center: DVec3,
    /// The matrix M, which takes the unit sphere to the ellipsoid about its centre; m.
    pub matrix: DMat3,
}

impl Ellipsoid {
    /// A ball.
    pub fn sphere(center: DVec3, radius: f64) -> Self {
        let matrix = DMat3::from_diagonal(DVec3::splat(radius));
        Self { center, matrix }
    }

    /// A splat of the renderer: centre (m), scale (m), and the symmetric matrix of the axes as
    /// xx, xy, xz, yy, yz, zz.
    pub fn from_splat(center: [f32; 3], scale: f32, axes: [f32; 6]) -> Self {
        let [xx, xy, xz, yy, yz, zz] = axes.map(f64::from);
        Self {
            center: DVec3::from(center.map(f64::from)),
            matrix: DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
                * f64::from(scale),
        }
    }

    /// Least and greatest corner of the box around it.
    pub(crate) fn corners(&self, scale: f64) -> [DVec3; 2] {
        let rows = self.matrix.transpose();
        let half = DVec3::new(
            rows.x_axis.length(),
            rows.y_axis.length(),
            rows.z_axis.length(),
        ) * scale;
        [self.center - half, self.center + half]
    }
}

/// An ellipsoid, and the way back to its unit sphere.
#[derive(Clone, Copy)]
pub(crate) struct Prepared {
    pub(crate) center: DVec3,
    /// M⁻¹, 1/m.
    pub(crate) inverse: DMat3,
}

impl From<Ellipsoid> for Prepared {
    fn from(of: Ellipsoid) -> Self {
        Self {
            center: of.center,
            inverse: of.matrix.inverse(),
        }
    }
}

impl Prepared {
    /// In units of the ellipsoid: its surface is where the length is 1.
    pub(crate) fn local(&self, point: DVec3) -> DVec3 {
        self.inverse * (point - self.center)
    }

    /// Where the line goes into and out of the ellipsoid scaled by `scale`.
    pub(crate) fn span(&self, ray: &Ray, scale: f64) -> Option<[f64; 2]> {
        // From the closest approach on, so that no large numbers cancel.
        let start = ray.direction.dot(self.center - ray.origin);
        let o = self.local(ray.at(start));
        let d = self.inverse * ray.direction;
        let a = d.length_squared();
        let middle = -o.dot(d) / a;
        let disc = scale * scale - (o + middle * d).length_squared();
        (disc > 0.0).then(|| {
            let half = (disc / a).sqrt();
            [start + middle - half, start + middle + half]
        })
    }

    fn normal(&self, point: DVec3) -> DVec3 {
        (self.inverse.transpose() * self.local(point)).normalize()
    }
}

/// Many ellipsoids as one body.
pub struct Ellipsoids {
    items: Vec<Prepared>,
    boxes: Boxes,
}

impl Ellipsoids {
    /// Their union. Flat ones, whose matrix has no inverse, are left out.
    pub fn new(ellipsoids: impl IntoIterator<Item = Ellipsoid>) -> Self {
        let solid = |of: &Ellipsoid| of.matrix.inverse().is_finite();
        let ellipsoids: Vec<_> = ellipsoids.into_iter().filter(solid).collect();
        Self {
            boxes: Boxes::new(ellipsoids.iter().map(|of| of.corners(1.0))),
            items: ellipsoids.into_iter().map(Prepared::from).collect(),
        }
    }

    /// Balls of one radius (m).
    pub fn spheres(centers: &[DVec3], radius: f64) -> Self {
        Self::new(
            centers
                .iter()
                .map(|&center| Ellipsoid::sphere(center, radius)),
        )
    }
}

impl Surface for Ellipsoids {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        let start = out.len();
        self.boxes.met(ray, |index| {
            let item = &self.items[index];
            let Some(span) = item.span(ray, 1.0) else {
                return;
            };
            out.extend(
                [(span[0], true), (span[1], false)].map(|(t, entering)| Crossing {
                    t,
                    normal: item.normal(ray.at(t)),
                    entering,
                    body: 0,
                }),
            );
        });
        keep_outermost(out, start, 0);
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        // A ray from a point meets all boxes that hold it.
        let mut inside = false;
        let ray = Ray::new(point, DVec3::X);
        self.boxes.met(&ray, |index| {
            inside |= self.items[index].local(point).length_squared() < 1.0;
        });
        inside.then_some(0)
    }
}
