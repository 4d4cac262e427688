//! Output of the shape stage, for the renderer.

use std::time::Duration;

use bevy::math::{Mat3, Vec3};
use bytemuck::{Pod, Zeroable};
use half::f16;

/// One ellipsoid: the points c + s·A·u with |u| = 1. 32 bytes, uploaded unchanged.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Splat {
    /// Centre c, in m, in the space of the particles.
    pub center: [f32; 3],
    /// Scale s: the largest semi-axis, in m, and so the radius of the bounding sphere.
    pub scale: f32,
    /// Symmetric matrix A, as xx, xy, xz, yy, yz, zz. Its eigenvalues are the semi-axes in
    /// units of s, at most 1, so f16 holds them in a scene of any scale.
    pub axes: [f16; 6],
    /// Index of the particle in the input.
    pub particle: u32,
}

impl Splat {
    /// The sphere of `radius` (m) around `center` (m).
    pub fn sphere(center: Vec3, radius: f32, particle: u32) -> Self {
        let [zero, one] = [f16::ZERO, f16::ONE];
        Self {
            center: center.to_array(),
            scale: radius,
            axes: [one, zero, zero, one, zero, one],
            particle,
        }
    }

    /// The matrix s·A, which takes the unit sphere to the ellipsoid about its centre; in m.
    pub fn matrix(&self) -> Mat3 {
        let [xx, xy, xz, yy, yz, zz] = self.axes.map(f16::to_f32);
        Mat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]) * self.scale
    }
}

/// The splats of one fluid.
#[derive(Clone, Debug)]
pub struct FluidSplats {
    /// All splats: bulk, then interior, then spray.
    pub splats: Vec<Splat>,
    /// Number of bulk splats.
    pub bulk: u32,
    /// Number of interior splats.
    pub interior: u32,
    /// Number of spray splats.
    pub spray: u32,
    /// Number of particles left out because their position is not finite.
    pub dropped: u32,
    /// Least corner of the box around all ellipsoids, in m. Without splats every coordinate
    /// is `f32::MAX`, so `min` > `max`.
    pub min: Vec3,
    /// Greatest corner, likewise; `f32::MIN` without splats.
    pub max: Vec3,
    /// How long the stages took.
    pub times: ShapeTimes,
}

/// Wall-clock time of the shape stage and its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeTimes {
    /// Sorting the particles into cells.
    pub grid: Duration,
    /// Measuring the neighbourhoods and classifying the particles.
    pub classify: Duration,
    /// Making the ellipsoids.
    pub anisotropy: Duration,
    /// Total time.
    pub total: Duration,
}

impl Default for FluidSplats {
    fn default() -> Self {
        Self {
            splats: Vec::new(),
            bulk: 0,
            interior: 0,
            spray: 0,
            dropped: 0,
            min: Vec3::MAX,
            max: Vec3::MIN,
            times: ShapeTimes::default(),
        }
    }
}

impl FluidSplats {
    /// The splats by class: bulk, interior, spray.
    pub fn by_class(&self) -> [&[Splat]; 3] {
        let (bulk, rest) = self.splats.split_at(self.bulk as usize);
        let (interior, spray) = rest.split_at(self.interior as usize);
        [bulk, interior, spray]
    }

    /// Resets everything but the buffer, which the next frame overwrites.
    pub(super) fn clear(&mut self) {
        let mut splats = std::mem::take(&mut self.splats);
        splats.clear();
        *self = Self {
            splats,
            ..Self::default()
        };
    }

    /// Makes room for `counts` splats by class. Old splats stay until overwritten: clearing them
    /// first would double the writes.
    pub(super) fn resize(&mut self, counts: [usize; 3]) -> [&mut [Splat]; 3] {
        [self.bulk, self.interior, self.spray] = counts.map(|count| count as u32);
        self.splats.resize(counts.iter().sum(), Splat::zeroed());
        let (bulk, rest) = self.splats.split_at_mut(counts[0]);
        let (interior, spray) = rest.split_at_mut(counts[1]);
        [bulk, interior, spray]
    }
}
