//! Bulk, interior or spray (thesis 4.2; the interior and the weight are additions).
//!
//! Between bulk and spray a particle has a weight and two splats, one in each class, so that it does
//! not pop from one class's layers to the other's. The weight depends on this frame alone.

use std::{array, f32::consts::PI};

use rayon::prelude::*;

use super::{
    CHUNK, SurfaceKernel,
    candidates::Candidates,
    grid::Grid,
    neighborhood::Neighborhood,
    splats::{PARTS, Part},
};

/// Class of a particle: the one in which it has a splat of full size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Class {
    /// The body of the liquid, up to its surface.
    #[default]
    Bulk,
    /// Bulk too deep for any surface to pass through.
    Interior,
    /// Droplets.
    Spray,
}

/// Number of neighbours below the threshold within which bulk becomes spray.
const SPRAY_RAMP: f32 = 3.0;

/// Neighbours counted at rest over those within R: the mean of min(1, 10 (1 − d/R)) over a ball.
const COUNTED: f32 = 0.86;

/// Smallest fraction of the neighbours at rest in a full neighbourhood.
const FULL_COUNT: f32 = 0.75;
/// Largest weighted mean of a full neighbourhood, in R. At a flat surface it is 0.2 to 0.3.
const FULL_MEAN: f32 = 0.1;
/// Smallest trace of the covariance of a full neighbourhood, in R²; a full ball has 0.45.
const FULL_TRACE: f32 = 0.36;
/// Largest anisotropy of a full neighbourhood.
const FULL_ANISOTROPY: f32 = 0.15;
/// How far, in radii, a particle with a neighbourhood that is not full keeps others from
/// being interior. A neighbourhood can be full one spacing (2 radii) below the surface
/// already. Measured on lattices with particles moved by up to 0.35 spacings, 3.0 leaves
/// 0.8 % of the interior less than two spacings deep, 3.5 nothing, and 4.0 costs another
/// fifth of the interior.
pub(super) const SHELL: f32 = 3.5;

/// The part of a particle that is bulk, 0 to 1: 1 from `threshold` neighbours, 0 with three fewer or
/// none, and linear in between.
pub(super) fn bulk_weight(count: f32, threshold: u32) -> f32 {
    let threshold = threshold as f32;
    let width = threshold.clamp(1.0, SPRAY_RAMP);
    (1.0 + (count - threshold) / width).clamp(0.0, 1.0)
}

/// Scales of a particle's bulk splat and of its spray splat. One of them is always of full size, so
/// the liquid never shrinks in between: the other one grows or shrinks inside it.
pub(super) fn scales(bulk_weight: f32) -> [f32; 2] {
    [bulk_weight, 1.0 - bulk_weight].map(|weight| (2.0 * weight).min(1.0))
}

/// Classes of the sorted particles.
#[derive(Default)]
pub(super) struct Classes {
    pub(super) of: Vec<Class>,
    /// Splats of every [`Part`], by chunk.
    pub(super) counts: Vec<[usize; PARTS]>,
    /// Whether the neighbourhood is full and balanced on all sides.
    full: Vec<bool>,
}

impl Classes {
    pub(super) fn classify(
        &mut self,
        grid: &Grid,
        neighborhoods: &[Neighborhood],
        kernel: &SurfaceKernel,
        radius: f32,
    ) {
        self.find_full(neighborhoods, kernel);
        self.of.resize(grid.len(), Class::Bulk);
        self.counts.resize(grid.len().div_ceil(CHUNK), [0; PARTS]);
        let full = &self.full;
        let shell = SHELL.min(kernel.neighbor_radius) * radius;
        self.of
            .par_chunks_mut(CHUNK)
            .zip(&mut self.counts)
            .zip(neighborhoods.par_chunks(CHUNK))
            .enumerate()
            .for_each(|(chunk, ((classes, counts), neighborhoods))| {
                let weight = |n: &Neighborhood| bulk_weight(n.crowd(), kernel.spray_threshold);
                for (class, neighborhood) in classes.iter_mut().zip(neighborhoods) {
                    let is_spray = weight(neighborhood) < 0.5;
                    *class = if is_spray { Class::Spray } else { Class::Bulk };
                }
                if kernel.skip_interior {
                    mark_interior(grid, full, shell, chunk * CHUNK, classes);
                }
                *counts = [0; PARTS];
                for (&class, neighborhood) in classes.iter().zip(neighborhoods) {
                    let weight = weight(neighborhood);
                    let parts = match class {
                        Class::Interior => [Some(Part::Interior), None],
                        _ => [Part::bulk(weight), Part::spray(weight)],
                    };
                    for part in parts.into_iter().flatten() {
                        counts[part as usize] += 1;
                    }
                }
            });
    }

    /// Splats of every part.
    pub(super) fn totals(&self) -> [usize; PARTS] {
        array::from_fn(|part| self.counts.iter().map(|counts| counts[part]).sum())
    }

    /// Address and capacity of every buffer.
    #[cfg(test)]
    pub(super) fn buffers(&self) -> Vec<(usize, usize)> {
        vec![
            (self.of.as_ptr().addr(), self.of.capacity()),
            (self.counts.as_ptr().addr(), self.counts.capacity()),
            (self.full.as_ptr().addr(), self.full.capacity()),
        ]
    }

    fn find_full(&mut self, neighborhoods: &[Neighborhood], kernel: &SurfaceKernel) {
        self.full.resize(neighborhoods.len(), false);
        let at_rest = COUNTED * PI / 6.0 * kernel.neighbor_radius.powi(3) - 1.0;
        self.full
            .par_chunks_mut(CHUNK)
            .zip(neighborhoods.par_chunks(CHUNK))
            .for_each(|(full, neighborhoods)| {
                for (full, neighborhood) in full.iter_mut().zip(neighborhoods) {
                    let mean = neighborhood.mean.map(|a| a * a).iter().sum::<f32>();
                    *full = neighborhood.count >= FULL_COUNT * at_rest
                        && mean <= FULL_MEAN * FULL_MEAN
                        && neighborhood.trace() >= FULL_TRACE
                        && neighborhood.anisotropy_squared() <= FULL_ANISOTROPY * FULL_ANISOTROPY;
                }
            });
    }
}

/// Makes the particles interior whose neighbours within `shell` (m) are all full, as they
/// are themselves.
fn mark_interior(grid: &Grid, full: &[bool], shell: f32, first: usize, classes: &mut [Class]) {
    let mut surface = Candidates::new(shell);
    for group in grid.groups(first..first + classes.len()) {
        if !full[group.particles.clone()].contains(&true) {
            continue;
        }
        surface.gather(grid, &group, Some(full));
        // A sample could miss the surface.
        if surface.sampled() {
            continue;
        }
        for sorted in group.particles {
            let class = &mut classes[sorted - first];
            if full[sorted] && *class == Class::Bulk && !surface.any_near(grid.position(sorted)) {
                *class = Class::Interior;
            }
        }
    }
}
