//! Particles → ellipsoids (Yu & Turk 2013, sections 4 and 5), as the renderer's shape stage makes
//! them, but in f64 and in the simplest way.

use std::collections::HashMap;

use glam::{DMat3, DVec3, I64Vec3};
use rayon::prelude::*;

use super::eigen::eigen;
use crate::ellipsoids::Ellipsoid;

/// Settings with the names, units and defaults of the renderer's `SurfaceKernel`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AnisotropicKernel {
    /// Distance within which particles are neighbours, in radii.
    pub neighbor_radius: f64,
    /// How far a centre moves towards the mean of its neighbours, 0 to 1 (λ).
    pub center_shift: f64,
    /// How far particles at a surface move outwards again, in radii.
    pub surface_offset: f64,
    /// Longest axis over the shortest (`k_r`).
    pub max_ratio: f64,
    /// Radius of the sphere with the volume of an ellipsoid, in radii.
    pub radius_scale: f64,
    /// Number of neighbours up to which a particle stays a sphere of its radius.
    pub sphere_neighbors: f64,
    /// Number of neighbours from which it is a full ellipsoid.
    pub full_neighbors: f64,
}

impl Default for AnisotropicKernel {
    fn default() -> Self {
        Self {
            neighbor_radius: 4.0,
            center_shift: 0.9,
            surface_offset: 1.15,
            max_ratio: 4.0,
            radius_scale: 1.24,
            sphere_neighbors: 7.0,
            full_neighbors: 13.0,
        }
    }
}

/// Trace of the covariance, in R², up to which the neighbours count as one point and from which
/// they count as spread out.
const SPREAD: [f64; 2] = [1e-4, 1e-3];

/// Distance from the mean of the neighbours, in R, up to which a particle is inside and from
/// which it is at a surface.
const SURFACE: [f64; 2] = [0.05, 0.15];

/// One ellipsoid for each particle of `radius` (m), in their order.
pub fn anisotropic(particles: &[DVec3], radius: f64, kernel: &AnisotropicKernel) -> Vec<Ellipsoid> {
    let reach = kernel.neighbor_radius * radius;
    let cell = |p: DVec3| (p / reach).floor().as_i64vec3();
    let mut cells: HashMap<I64Vec3, Vec<DVec3>> = HashMap::new();
    for &p in particles {
        cells.entry(cell(p)).or_default().push(p);
    }
    particles
        .par_iter()
        .map(|&p| {
            let near = (0..27).filter_map(|i| {
                cells.get(&(cell(p) + I64Vec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)))
            });
            // In R, from the particle, which is one of them.
            let offsets = near.flatten().map(|&other| (other - p) / reach);
            let around: Vec<_> = offsets.filter(|o| o.length_squared() <= 1.0).collect();
            ellipsoid(p, &around, radius, kernel)
        })
        .collect()
}

fn ellipsoid(p: DVec3, around: &[DVec3], radius: f64, kernel: &AnisotropicKernel) -> Ellipsoid {
    let weight = |o: DVec3| 1.0 - o.length().powi(3);
    let total: f64 = around.iter().map(|&o| weight(o)).sum();
    let mean = around.iter().map(|&o| weight(o) * o).sum::<DVec3>() / total;
    let covariance = around.iter().fold(DMat3::ZERO, |sum, &o| {
        let d = o - mean;
        sum + DMat3::from_cols(d * d.x, d * d.y, d * d.z) * (weight(o) / total)
    });

    let (values, vectors) = eigen(covariance);
    // Whole up to 0.9 R, in part beyond. The particle itself is one of them.
    let counted = around.iter().map(|o| (10.0 * (1.0 - o.length())).min(1.0));
    let count = counted.sum::<f64>() - 1.0;
    let width = (kernel.full_neighbors - kernel.sphere_neighbors).max(1.0);
    let blend = smoothstep((count - kernel.sphere_neighbors) / width)
        * smoothstep((values.element_sum() - SPREAD[0]) / (SPREAD[1] - SPREAD[0]));

    // The eigenvalues themselves, not their roots, and from the sphere by the blend.
    let largest = values.max_element().max(f64::MIN_POSITIVE);
    let clamped = (values / largest).max(DVec3::splat(1.0 / kernel.max_ratio));
    let semi_axes = DVec3::ONE.lerp(clamped, blend);
    let volume_radius = radius * (1.0 + blend * (kernel.radius_scale - 1.0));
    let scale = volume_radius / semi_axes.element_product().cbrt();
    let inwards = kernel.center_shift * kernel.neighbor_radius * mean;
    let at_surface = smoothstep((mean.length() - SURFACE[0]) / (SURFACE[1] - SURFACE[0]));
    let outwards = kernel.surface_offset * at_surface * mean.normalize_or_zero();
    Ellipsoid {
        center: p + blend * radius * (inwards - outwards),
        matrix: vectors * DMat3::from_diagonal(semi_axes * scale) * vectors.transpose(),
    }
}

fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
