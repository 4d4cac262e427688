//! Particles → splats, on the CPU.
//!
//! One call of [`ShapeWorkspace::shape`] sorts the particles of a fluid into a grid for the
//! neighbourhood search, computes the weighted covariance of each neighbourhood, separates bulk,
//! interior and spray (by a weight: nothing pops from one to the other), and turns every particle into
//! an ellipsoid that follows the surface around it (an anisotropic kernel: Yu & Turk, *Reconstructing
//! Surfaces of Particle-Based Fluids Using Anisotropic Kernels*, ACM TOG 32(1), 2013).
//!
//! ```
//! use bevy::math::Vec3;
//! use bevy_fluid::shape::{FluidSplats, ShapeWorkspace, SurfaceKernel};
//!
//! let (mut workspace, mut splats) = (ShapeWorkspace::default(), FluidSplats::default());
//! workspace.shape(&[Vec3::ZERO], 0.025, &SurfaceKernel::default(), &mut splats)?;
//! assert_eq!(splats.spray, 1);
//! assert_eq!(splats.splats[0].scale, 0.025);
//! # Ok::<(), bevy_fluid::shape::ShapeError>(())
//! ```
//!
//! Work and memory are linear in the number of particles, however far apart they are and even where
//! very many share one place: a particle is compared with an even sample of at most 2048 of those
//! around it. The result is deterministic for any number of threads and, except for rounding and
//! such samples, independent of the order of the particles. All computation is relative to the
//! particle, so the only loss far from the origin is that of the f32 positions themselves: 1e6 m
//! away they are multiples of 0.06 m.

mod anisotropy;
mod candidates;
mod classify;
mod eigen;
mod grid;
mod kernel;
mod neighborhood;
#[cfg(test)]
mod oracle;
mod splats;
#[cfg(test)]
mod tests;

use bevy::math::Vec3;
use thiserror::Error;

pub use kernel::SurfaceKernel;
pub use splats::{FluidSplats, ShapeTimes, Splat};

use anisotropy::{Bounds, Splatting};
use classify::Classes;
use grid::Grid;
use neighborhood::Neighborhood;

use crate::{
    clock::now,
    settings::{SettingError, SettingRange, Settings},
};

/// Number of sorted particles per task. Fixed, so that tasks, and thus all rounding, are
/// deterministic for any number of threads.
const CHUNK: usize = 512;

/// The radius of particles. The squares and cubes of valid ones are far from f32's limits.
pub(crate) const RADIUS: SettingRange = SettingRange::new(1e-3, 1.0)
    .unit("m")
    .logarithmic()
    .valid(1e-9, 1e9);

/// Why particles cannot be shaped.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// The radius is out of range.
    #[error("particle radius is {0} m; it must be positive and finite, from 1e-9 to 1e9 m")]
    Radius(f32),
    /// A setting of the kernel is out of range.
    #[error(transparent)]
    Kernel(#[from] SettingError),
    /// There are more particles than a splat's index can count.
    #[error("{0} particles; there can be at most {max}", max = u32::MAX)]
    TooManyParticles(usize),
}

/// Buffers of the shape stage, reused from frame to frame.
///
/// A frame with no more particles than before allocates nothing.
#[derive(Default)]
pub struct ShapeWorkspace {
    grid: Grid,
    neighborhoods: Vec<Neighborhood>,
    classes: Classes,
}

impl ShapeWorkspace {
    /// Turns particles at `positions` (m) of one `radius` (m) into splats, in the same space.
    ///
    /// Runs on rayon's current thread pool. Particles with a coordinate that is not finite,
    /// or beyond ±1e30 m, are dropped and counted in [`FluidSplats::dropped`].
    ///
    /// Without particles, any radius is valid.
    ///
    /// # Errors
    /// Returns an error that names the invalid radius or setting and its value; `out` is then
    /// empty.
    pub fn shape(
        &mut self,
        positions: &[Vec3],
        radius: f32,
        kernel: &SurfaceKernel,
        out: &mut FluidSplats,
    ) -> Result<(), ShapeError> {
        if let Err(error) = check(positions, radius, kernel) {
            out.clear();
            return Err(error);
        }
        if positions.is_empty() {
            out.clear();
            return Ok(());
        }

        let start = now();
        let reach = kernel.neighbor_radius * radius;
        self.grid.build(positions, reach);
        out.times.grid = start.elapsed();

        candidates::measure(&self.grid, reach, &mut self.neighborhoods);
        self.classes
            .classify(&self.grid, &self.neighborhoods, kernel, radius);
        out.times.classify = start.elapsed() - out.times.grid;

        let slices = out.resize(self.classes.totals());
        let splatting = Splatting {
            grid: &self.grid,
            neighborhoods: &self.neighborhoods,
            classes: &self.classes,
            kernel,
            radius,
        };
        let Bounds { min, max } = splatting.splat(0..self.classes.counts.len(), slices);
        (out.min, out.max) = (min, max);
        out.dropped = (positions.len() - self.grid.len()) as u32;
        out.times.total = start.elapsed();
        out.times.anisotropy = out.times.total - out.times.grid - out.times.classify;
        Ok(())
    }
}

fn check(positions: &[Vec3], radius: f32, kernel: &SurfaceKernel) -> Result<(), ShapeError> {
    kernel.validate()?;
    // The radius of a fluid that is still to be loaded or emitted may be set later.
    if !positions.is_empty() && !RADIUS.contains(radius) {
        return Err(ShapeError::Radius(radius));
    }
    if positions.len() >= u32::MAX as usize {
        return Err(ShapeError::TooManyParticles(positions.len()));
    }
    Ok(())
}
