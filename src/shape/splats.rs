//! Output of the shape stage, for the renderer.

use std::{array, time::Duration};

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

/// A particle has no splat in a class to which it belongs by less: f16 rounds axes by as much.
const LEAST: f32 = 1.0 / 2048.0;

/// Parts of a fluid's splats, in their order.
#[derive(Clone, Copy)]
pub(super) enum Part {
    PartialBulk,
    Bulk,
    Interior,
    Spray,
    PartialSpray,
}

impl Part {
    /// The part of the bulk splat of a particle of this bulk weight, if it has one.
    pub(super) fn bulk(weight: f32) -> Option<Self> {
        let is_whole = weight >= 0.5;
        let part = if is_whole {
            Self::Bulk
        } else {
            Self::PartialBulk
        };
        (weight > LEAST).then_some(part)
    }

    /// The part of its spray splat, likewise.
    pub(super) fn spray(weight: f32) -> Option<Self> {
        let is_whole = weight < 0.5;
        let part = if is_whole {
            Self::Spray
        } else {
            Self::PartialSpray
        };
        (weight < 1.0 - LEAST).then_some(part)
    }
}

/// Number of [`Part`]s.
pub(super) const PARTS: usize = 5;

/// The splats of one fluid.
///
/// Every particle has one splat of full size, in its class. One between bulk and spray has a smaller
/// one in the other class as well, which vanishes where the particle belongs to one class alone.
#[derive(Clone, Debug)]
pub struct FluidSplats {
    /// All splats: partial bulk, bulk, interior, spray, partial spray.
    pub splats: Vec<Splat>,
    /// Number of bulk particles.
    pub bulk: u32,
    /// Number of interior particles.
    pub interior: u32,
    /// Number of spray particles.
    pub spray: u32,
    /// Number of spray particles with a smaller splat in the bulk.
    pub partial_bulk: u32,
    /// Number of bulk particles with a smaller splat in the spray.
    pub partial_spray: u32,
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
            partial_bulk: 0,
            partial_spray: 0,
            dropped: 0,
            min: Vec3::MAX,
            max: Vec3::MIN,
            times: ShapeTimes::default(),
        }
    }
}

impl FluidSplats {
    /// The splats by class, partial ones included: bulk, interior, spray.
    pub fn by_class(&self) -> [&[Splat]; 3] {
        let bulk = self.partial_bulk + self.bulk;
        let (bulk, rest) = self.splats.split_at(bulk as usize);
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

    /// Makes room for `counts` splats by part. Old splats stay until overwritten: clearing them
    /// first would double the writes. There is room for both splats of every particle at once, so
    /// that a frame with no more particles than before allocates nothing.
    pub(super) fn resize(&mut self, counts: [usize; PARTS]) -> [&mut [Splat]; PARTS] {
        let [partial_bulk, bulk, interior, spray, partial_spray] = counts.map(|count| count as u32);
        (self.bulk, self.interior, self.spray) = (bulk, interior, spray);
        (self.partial_bulk, self.partial_spray) = (partial_bulk, partial_spray);
        let particles = (bulk + interior + spray) as usize;
        self.splats
            .reserve((2 * particles).saturating_sub(self.splats.len()));
        self.splats.resize(counts.iter().sum(), Splat::zeroed());
        let mut rest = self.splats.as_mut_slice();
        array::from_fn(|part| {
            let (these, others) = std::mem::take(&mut rest).split_at_mut(counts[part]);
            rest = others;
            these
        })
    }
}
