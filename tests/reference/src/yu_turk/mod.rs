//! The implicit surface of anisotropic kernels (Yu & Turk, *Reconstructing Surfaces of
//! Particle-Based Fluids Using Anisotropic Kernels*, ACM TOG 32(1), 2013).
//!
//! A splat is an ellipsoid; this is the smooth surface that many of them stand for. Compare the
//! two to see what splatting costs, and the renderer with either.

mod eigen;
mod kernels;
mod march;

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    Crossing, Ray, Surface,
    boxes::Boxes,
    ellipsoids::{Ellipsoid, Prepared},
};

pub use kernels::{AnisotropicKernel, anisotropic};
pub use march::Marched;

/// The field φ(x) = Σ V W(x − c, M) over ellipsoids, liquid where it exceeds ½.
///
/// W is the cubic B-spline over an ellipsoid scaled by [`ImplicitSurface::SUPPORT`], with an
/// integral of 1, and V = (2r)³ the volume of a particle at rest: deep inside φ is about 1.
pub struct ImplicitSurface {
    items: Vec<(Prepared, f64)>,
    boxes: Boxes,
    /// Shortest semi-axis of all, m.
    minor: f64,
    radius: f64,
}

impl ImplicitSurface {
    /// How far a kernel reaches, in its ellipsoid's semi-axes: in a body at rest, whose splats
    /// have 1.24 r, 3.7 r or nearly two spacings. There φ is 1 to about 1 %.
    pub const SUPPORT: f64 = 3.0;

    /// Value of the field at the surface.
    pub const ISO: f64 = 0.5;

    /// Of ellipsoids that stand for particles of `radius` (m), from [`anisotropic`] or from the
    /// renderer. Flat ones, whose matrix has no inverse, are left out.
    pub fn new(ellipsoids: impl IntoIterator<Item = Ellipsoid>, radius: f64) -> Self {
        let solid = |of: &Ellipsoid| of.matrix.inverse().is_finite();
        let ellipsoids: Vec<_> = ellipsoids.into_iter().filter(solid).collect();
        let boxes = Boxes::new(ellipsoids.iter().map(|of| of.corners(Self::SUPPORT)));
        let minor = ellipsoids
            .iter()
            .map(minor_axis)
            .fold(f64::INFINITY, f64::min);
        let items = ellipsoids.into_iter().map(|of| {
            let volume = (2.0 * radius).powi(3);
            let kernel = of.matrix.determinant().abs() * Self::SUPPORT.powi(3);
            (Prepared::from(of), volume * 8.0 / (PI * kernel))
        });
        Self {
            items: items.collect(),
            boxes,
            minor,
            radius,
        }
    }

    /// The field at a point (m).
    pub fn field(&self, point: DVec3) -> f64 {
        let mut sum = 0.0;
        // A ray from a point meets all boxes that hold it.
        self.boxes.met(&Ray::new(point, DVec3::X), |index| {
            sum += self.kernel(index, point);
        });
        sum
    }

    fn kernel(&self, index: usize, point: DVec3) -> f64 {
        let (item, weight) = &self.items[index];
        weight * spline(item.local(point).length() / Self::SUPPORT)
    }

    /// Downwards along the field: outwards.
    fn normal(&self, among: impl Iterator<Item = usize>, point: DVec3) -> DVec3 {
        let gradient: DVec3 = among
            .map(|index| {
                let (item, weight) = &self.items[index];
                let local = item.local(point);
                let q = local.length() / Self::SUPPORT;
                let along = item.inverse.transpose() * local.normalize_or_zero();
                weight * spline_slope(q) / Self::SUPPORT * along
            })
            .sum();
        -gradient.normalize_or(DVec3::NEG_Y)
    }
}

impl Surface for ImplicitSurface {
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>) {
        out.append(&mut self.march(ray).crossings);
    }

    fn inside(&self, point: DVec3) -> Option<usize> {
        (self.field(point) > Self::ISO).then_some(0)
    }
}

/// Shortest semi-axis (m): the reciprocal of the inverse's greatest stretch.
fn minor_axis(of: &Ellipsoid) -> f64 {
    let gram = of.matrix.transpose() * of.matrix;
    eigen::eigen(gram).0.min_element().max(0.0).sqrt()
}

/// Cubic B-spline with the support 1, but for its factor 8/π.
fn spline(q: f64) -> f64 {
    if q < 0.5 {
        1.0 - 6.0 * q * q * (1.0 - q)
    } else {
        2.0 * (1.0 - q).max(0.0).powi(3)
    }
}

fn spline_slope(q: f64) -> f64 {
    if q < 0.5 {
        q * (18.0 * q - 12.0)
    } else {
        -6.0 * (1.0 - q).max(0.0).powi(2)
    }
}
