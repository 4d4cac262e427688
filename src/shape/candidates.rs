//! The neighbourhood search: every particle is compared with the candidates around its cell.

use std::ops::Range;

use bevy::math::Vec3;
use rayon::prelude::*;
use wide::f32x8;

use super::{
    CHUNK,
    grid::{Grid, Group},
    neighborhood::Neighborhood,
};

const LANES: usize = 8;

/// A neighbour at the distance d counts as min(1, 10 (1 − d/R)): whole up to 0.9 R, and less and
/// less over the outer tenth, so that none jumps in or out.
const COUNT_SLOPE: f32 = 10.0;

/// Maximum number of candidates that one particle is compared with. A cell may hold any number of
/// particles; above this, an even sample represents them all, which bounds the work.
pub(super) const MAX_CANDIDATES: usize = 2048;

/// Padding: too far from any particle to be its neighbour, near enough for a finite difference.
const NOWHERE: f32 = f32::MAX;

type Axis = [f32; MAX_CANDIDATES + LANES];

/// Measures the neighbourhood of every sorted particle within `reach` (m).
pub(super) fn measure(grid: &Grid, reach: f32, out: &mut Vec<Neighborhood>) {
    out.resize(grid.len(), Neighborhood::default());
    out.par_chunks_mut(CHUNK)
        .enumerate()
        .for_each(|(chunk, out)| {
            let first = chunk * CHUNK;
            let mut candidates = Candidates::new(reach);
            for group in grid.groups(first..first + out.len()) {
                candidates.gather(grid, &group, None);
                for sorted in group.particles {
                    out[sorted - first] = candidates.neighborhood(grid.position(sorted));
                }
            }
        });
}

/// Particles that may be within reach of a group of particles, copied together so that
/// the loops over them run in lanes.
pub(super) struct Candidates {
    x: Axis,
    y: Axis,
    z: Axis,
    len: usize,
    /// Number of particles that each candidate represents.
    multiplicity: usize,
    reach: f32,
}

impl Candidates {
    pub(super) fn new(reach: f32) -> Self {
        let zeros = [0.0; MAX_CANDIDATES + LANES];
        Self {
            x: zeros,
            y: zeros,
            z: zeros,
            len: 0,
            multiplicity: 1,
            reach,
        }
    }

    /// Collects the sorted particles within reach of the box around `group`, half as many
    /// as the 27 cells hold; with `skip`, only those it is false for.
    pub(super) fn gather(&mut self, grid: &Grid, group: &Group, skip: Option<&[bool]>) {
        let bounds = Bounds::new(grid, group);
        let around = grid.around(group.cell);
        self.len = 0;
        self.multiplicity = 1;
        if around.iter().map(ExactSizeIterator::len).sum::<usize>() <= MAX_CANDIDATES {
            for range in around {
                match skip {
                    None => self.extend(grid, range, &bounds, |_| true),
                    Some(skip) if skip[range.clone()].contains(&false) => {
                        self.extend(grid, range, &bounds, |sorted| !skip[sorted]);
                    }
                    Some(_) => {}
                }
            }
        } else {
            self.sample(grid, &around, &bounds, |sorted| {
                skip.is_none_or(|skip| !skip[sorted])
            });
        }
        // Fills the lanes that the last candidates leave over.
        for index in self.len..self.len + LANES {
            self.set(index, [NOWHERE; 3]);
        }
    }

    /// Adds the wanted particles of a range that are within reach of the box.
    #[inline(always)]
    fn extend(
        &mut self,
        grid: &Grid,
        range: Range<usize>,
        bounds: &Bounds,
        wanted: impl Fn(usize) -> bool,
    ) {
        let limit = f32x8::splat(self.reach * self.reach);
        let [xs, ys, zs] = [&grid.x, &grid.y, &grid.z].map(|axis| &axis[range.clone()]);
        let whole = xs.len() / LANES * LANES;
        let [x8, y8, z8] = [xs, ys, zs].map(|axis| axis.as_chunks::<LANES>().0);
        for (block, ((x, y), z)) in x8.iter().zip(y8).zip(z8).enumerate() {
            let [vx, vy, vz] = [x, y, z].map(|&axis| f32x8::new(axis));
            let near = bounds
                .distance_squared(vx, vy, vz)
                .simd_le(limit)
                .to_bitmask();
            for lane in 0..LANES {
                let wanted = wanted(range.start + block * LANES + lane);
                // Written always and kept by moving on: no branch to mispredict.
                self.set(self.len, [x[lane], y[lane], z[lane]]);
                self.len += usize::from(wanted) & (near >> lane) as usize;
            }
        }
        // The rest of the range, too short for the lanes.
        for sorted in range.start + whole..range.end {
            let position = grid.position(sorted);
            self.set(self.len, position.to_array());
            self.len += usize::from(wanted(sorted) & bounds.near(position, self.reach));
        }
    }

    /// Adds an even sample of the wanted particles within reach of the box.
    fn sample(
        &mut self,
        grid: &Grid,
        ranges: &[Range<usize>],
        bounds: &Bounds,
        wanted: impl Fn(usize) -> bool,
    ) {
        let reach = self.reach;
        let near = || {
            let all = ranges.iter().cloned().flatten();
            all.filter(|&sorted| wanted(sorted) && bounds.near(grid.position(sorted), reach))
        };
        self.multiplicity = near().count().div_ceil(MAX_CANDIDATES).max(1);
        for sorted in near().step_by(self.multiplicity) {
            self.set(self.len, grid.position(sorted).to_array());
            self.len += 1;
        }
    }

    fn set(&mut self, index: usize, [x, y, z]: [f32; 3]) {
        self.x[index] = x;
        self.y[index] = y;
        self.z[index] = z;
    }

    /// Whether the candidates are a sample of too many particles.
    pub(super) fn sampled(&self) -> bool {
        self.multiplicity > 1
    }

    /// Whether a candidate is within reach of `position`.
    pub(super) fn any_near(&self, position: Vec3) -> bool {
        let limit = f32x8::splat(self.reach * self.reach);
        self.offsets(position)
            .any(|[x, y, z]| (x * x + y * y + z * z).simd_le(limit).any())
    }

    /// Measures the weighted neighbourhood of a particle at `position`, which is one of the
    /// candidates.
    pub(super) fn neighborhood(&self, position: Vec3) -> Neighborhood {
        let per_reach = 1.0 / self.reach;
        let limit = f32x8::splat(self.reach * self.reach);
        let per_limit = f32x8::splat(per_reach * per_reach);
        let mut count = f32x8::ZERO;
        let mut weight = f32x8::ZERO;
        let mut first = [f32x8::ZERO; 3];
        let mut second = [f32x8::ZERO; 6];
        for [x, y, z] in self.offsets(position) {
            let distance_squared = x * x + y * y + z * z;
            let near = distance_squared.simd_le(limit);
            let ratio_squared = distance_squared * per_limit;
            let ratio = ratio_squared.sqrt();
            let w = near & (f32x8::ONE - ratio_squared * ratio);
            let counted = (f32x8::ONE - ratio) * f32x8::splat(COUNT_SLOPE);
            count += counted.fast_max(f32x8::ZERO).fast_min(f32x8::ONE);
            weight += w;
            let [wx, wy, wz] = [w * x, w * y, w * z];
            first[0] += wx;
            first[1] += wy;
            first[2] += wz;
            second[0] += wx * x;
            second[1] += wx * y;
            second[2] += wx * z;
            second[3] += wy * y;
            second[4] += wy * z;
            second[5] += wz * z;
        }
        // A sample may have missed the particle itself and all of its neighbours.
        let scale = per_reach / weight.reduce_add().max(f32::MIN_POSITIVE);
        let mean = first.map(|sum| sum.reduce_add() * scale);
        let second = second.map(|sum| sum.reduce_add() * scale * per_reach);
        let [x, y, z] = mean;
        let product = [x * x, x * y, x * z, y * y, y * z, z * z];
        Neighborhood::new(
            (count.reduce_add() * self.multiplicity as f32 - 1.0).max(0.0),
            mean,
            [0, 1, 2, 3, 4, 5].map(|entry| second[entry] - product[entry]),
        )
    }

    /// Candidates minus `position`, eight at a time.
    #[inline(always)]
    fn offsets(&self, position: Vec3) -> impl Iterator<Item = [f32x8; 3]> {
        let end = self.len.next_multiple_of(LANES);
        let [xs, ys, zs] = [&self.x, &self.y, &self.z].map(|axis| axis[..end].as_chunks().0);
        let [px, py, pz] = position.to_array().map(f32x8::splat);
        let lanes = xs.iter().zip(ys).zip(zs);
        lanes
            .map(move |((&x, &y), &z)| [f32x8::new(x) - px, f32x8::new(y) - py, f32x8::new(z) - pz])
    }
}

/// Box around a group of particles.
struct Bounds {
    min: Vec3,
    max: Vec3,
}

impl Bounds {
    fn new(grid: &Grid, group: &Group) -> Self {
        let [mut min, mut max] = [Vec3::MAX, Vec3::MIN];
        for position in group.particles.clone().map(|sorted| grid.position(sorted)) {
            min = min.min(position);
            max = max.max(position);
        }
        Self { min, max }
    }

    /// Squared distances, never more than from any of the particles, in rounded arithmetic
    /// too: the same operations on smaller differences.
    fn distance_squared(&self, x: f32x8, y: f32x8, z: f32x8) -> f32x8 {
        let outside = |at: f32x8, min: f32, max: f32| {
            at - at.fast_max(f32x8::splat(min)).fast_min(f32x8::splat(max))
        };
        let dx = outside(x, self.min.x, self.max.x);
        let dy = outside(y, self.min.y, self.max.y);
        let dz = outside(z, self.min.z, self.max.z);
        dx * dx + dy * dy + dz * dz
    }

    /// Whether one position is within reach.
    fn near(&self, position: Vec3, reach: f32) -> bool {
        let [x, y, z] = (position - position.max(self.min).min(self.max)).to_array();
        x * x + y * y + z * z <= reach * reach
    }
}
