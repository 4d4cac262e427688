//! The neighbour grid: particles sorted by cell, cells as wide as the neighbour radius.

use std::{array, iter, ops::Range};

use bevy::math::Vec3;
use rayon::prelude::*;

/// Particles handled at once where the work per particle is small.
const BLOCK: usize = 4096;

/// Cell of a particle that has none.
const NO_CELL: u32 = u32::MAX;

/// Coordinates beyond this are dropped like infinite ones: the difference of any two
/// within it is finite, which keeps NaN out of the sums that weigh far particles by 0.
const FARTHEST: f32 = 1e30;

/// Particles sorted by cell (stable counting sort), as a structure of arrays.
#[derive(Default)]
pub(super) struct Grid {
    layout: Layout,
    /// Cell of every input particle.
    cells: Vec<u32>,
    /// First sorted particle of every cell, and one end.
    starts: Vec<u32>,
    /// Input index of every sorted particle.
    pub(super) order: Vec<u32>,
    /// Coordinates of every sorted particle, in m.
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl Grid {
    /// Sorts `positions` so that all particles within `reach` (m) of a particle lie in the
    /// 27 cells around its own. Work and memory are linear in the number of particles,
    /// however far apart they are. Non-finite particles are left out.
    pub(super) fn build(&mut self, positions: &[Vec3], reach: f32) {
        self.layout = Layout::new(positions, reach);
        let layout = self.layout;
        self.cells.resize(positions.len(), NO_CELL);
        self.cells
            .par_chunks_mut(BLOCK)
            .zip(positions.par_chunks(BLOCK))
            .for_each(|(cells, positions)| {
                for (cell, &position) in cells.iter_mut().zip(positions) {
                    *cell = layout.cell(position);
                }
            });

        self.starts.clear();
        self.starts.resize(layout.cells as usize + 1, 0);
        for &cell in self.cells.iter().filter(|&&cell| cell != NO_CELL) {
            self.starts[cell as usize] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        // Every entry is its cell's end now; filling from the back makes it the start.
        self.order.resize(end as usize, 0);
        for (particle, &cell) in self.cells.iter().enumerate().rev() {
            if cell != NO_CELL {
                let slot = &mut self.starts[cell as usize];
                *slot -= 1;
                self.order[*slot as usize] = particle as u32;
            }
        }

        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(end as usize, 0.0);
        }
        self.order
            .par_chunks(BLOCK)
            .zip(self.x.par_chunks_mut(BLOCK))
            .zip(self.y.par_chunks_mut(BLOCK))
            .zip(self.z.par_chunks_mut(BLOCK))
            .for_each(|(((order, x), y), z)| {
                for (((&particle, x), y), z) in order.iter().zip(x).zip(y).zip(z) {
                    [*x, *y, *z] = positions[particle as usize].to_array();
                }
            });
    }

    /// Number of sorted particles.
    pub(super) fn len(&self) -> usize {
        self.order.len()
    }

    /// Number of cells.
    #[cfg(test)]
    pub(super) fn cells(&self) -> usize {
        self.starts.len() - 1
    }

    /// Address and capacity of every buffer.
    #[cfg(test)]
    pub(super) fn buffers(&self) -> Vec<(usize, usize)> {
        let mut buffers: Vec<_> = [&self.cells, &self.starts, &self.order]
            .map(|buffer| (buffer.as_ptr().addr(), buffer.capacity()))
            .into();
        buffers.extend(
            [&self.x, &self.y, &self.z].map(|axis| (axis.as_ptr().addr(), axis.capacity())),
        );
        buffers
    }

    /// Position of a sorted particle.
    pub(super) fn position(&self, sorted: usize) -> Vec3 {
        Vec3::new(self.x[sorted], self.y[sorted], self.z[sorted])
    }

    /// Cuts a range of sorted particles into the parts that share a cell.
    pub(super) fn groups(&self, range: Range<usize>) -> impl Iterator<Item = Group> {
        let mut first = range.start;
        let mut cell = self
            .starts
            .partition_point(|&start| start as usize <= first)
            - 1;
        iter::from_fn(move || {
            if first >= range.end {
                return None;
            }
            while self.starts[cell + 1] as usize <= first {
                cell += 1;
            }
            let end = range.end.min(self.starts[cell + 1] as usize);
            let particles = first..end;
            first = end;
            Some(Group { cell, particles })
        })
    }

    /// Ranges of sorted particles that together hold the 27 cells around `cell`, each
    /// particle once.
    pub(super) fn around(&self, cell: usize) -> [Range<usize>; 10] {
        let last = self.layout.cells as usize - 1;
        let span =
            |first: usize, last: usize| self.starts[first] as usize..self.starts[last + 1] as usize;
        // Three cells in a row along x are one range, but for the one row that may wrap.
        let mut ranges = array::from_fn(|_| 0..0);
        for (row, middle) in self.layout.rows(cell).into_iter().enumerate() {
            ranges[row] = span(middle.saturating_sub(1), last.min(middle + 1));
            if middle == 0 {
                ranges[9] = span(last, last);
            } else if middle == last {
                ranges[9] = span(0, 0);
            }
        }
        ranges
    }
}

/// Sorted particles of one cell, all of them or those of one chunk.
pub(super) struct Group {
    pub(super) cell: usize,
    pub(super) particles: Range<usize>,
}

/// Positions and numbers of cells: (x + y · `stride_y` + z · `stride_z`) mod `cells`.
///
/// Where the bounding box has few enough cells this is the usual dense grid. Where it has more, the
/// number is taken modulo a prime, which folds space onto itself. Then far away particles share
/// cells; the distance test separates them. `stride_y` ≥ 3, `stride_z` ≥ 3 `stride_y` and
/// `cells` ≥ 3 `stride_z` keep the 27 neighbours of a cell distinct in both cases.
#[derive(Clone, Copy, Default)]
struct Layout {
    cells_per_metre: f64,
    origin: [i64; 3],
    stride_y: i64,
    stride_z: i64,
    cells: i64,
    folded: bool,
}

impl Layout {
    fn new(positions: &[Vec3], reach: f32) -> Self {
        // A little wider than the reach: rounding never hides a neighbour two cells away.
        let cells_per_metre = 1.0 / (f64::from(reach) * (1.0 + 1e-5));
        let (min, max) = positions
            .par_chunks(BLOCK)
            .map(|block| {
                let usable = block.iter().copied().filter(|&p| usable(p));
                usable.fold(EMPTY, |(min, max), p| (min.min(p), max.max(p)))
            })
            .reduce(|| EMPTY, |a, b| (a.0.min(b.0), a.1.max(b.1)));
        let (min, max) = if min.x <= max.x {
            (min, max)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        let origin = coordinates(min, cells_per_metre);
        let end = coordinates(max, cells_per_metre);
        let extent = [0, 1, 2].map(|axis| (end[axis] - origin[axis] + 1).max(3));

        let budget = 2 * positions.len() as i64;
        let volume = extent.iter().map(|&cells| cells as f64).product::<f64>();
        if volume <= budget.clamp(64, i64::from(PRIMES[PRIMES.len() - 1])) as f64 {
            Self {
                cells_per_metre,
                origin,
                stride_y: extent[0],
                stride_z: extent[0] * extent[1],
                cells: extent[0] * extent[1] * extent[2],
                folded: false,
            }
        } else {
            let prime = PRIMES.iter().find(|&&prime| i64::from(prime) >= budget);
            let cells = i64::from(*prime.unwrap_or(&PRIMES[PRIMES.len() - 1]));
            let edge = (cells as f64).cbrt() as i64;
            Self {
                cells_per_metre,
                origin,
                stride_y: edge,
                stride_z: edge * edge,
                cells,
                folded: true,
            }
        }
    }

    fn cell(&self, position: Vec3) -> u32 {
        if !usable(position) {
            return NO_CELL;
        }
        let at = coordinates(position, self.cells_per_metre);
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let cell = at[axis] - self.origin[axis];
            if self.folded { cell % self.cells } else { cell }
        });
        let cell = x + y * self.stride_y + z * self.stride_z;
        (if self.folded { cell % self.cells } else { cell }) as u32
    }

    /// Middle cells of the nine rows along x around `cell`.
    fn rows(&self, cell: usize) -> [usize; 9] {
        array::from_fn(|row| {
            let [y, z] = [row as i64 % 3 - 1, row as i64 / 3 - 1];
            let middle = cell as i64 + y * self.stride_y + z * self.stride_z;
            // The remainder, of a number that is at most once around.
            (if middle < 0 {
                middle + self.cells
            } else if middle >= self.cells {
                middle - self.cells
            } else {
                middle
            }) as usize
        })
    }
}

/// Bounding box of nothing.
const EMPTY: (Vec3, Vec3) = (Vec3::MAX, Vec3::MIN);

/// The largest primes below the powers of two: a regular pattern of droplets shares no
/// factor with them, so it does not fold onto few cells.
const PRIMES: [u32; 26] = [
    61,
    127,
    251,
    509,
    1_021,
    2_039,
    4_093,
    8_191,
    16_381,
    32_749,
    65_521,
    131_071,
    262_139,
    524_287,
    1_048_573,
    2_097_143,
    4_194_301,
    8_388_593,
    16_777_213,
    33_554_393,
    67_108_859,
    134_217_689,
    268_435_399,
    536_870_909,
    1_073_741_789,
    2_147_483_647,
];

fn usable(position: Vec3) -> bool {
    position.abs().cmple(Vec3::splat(FARTHEST)).all()
}

/// Cell coordinates from zero, not from the cloud's corner: their rounding error then
/// shrinks with the particle's own.
fn coordinates(position: Vec3, cells_per_metre: f64) -> [i64; 3] {
    // Differences of clamped coordinates cannot overflow.
    const LIMIT: f64 = (1_i64 << 60) as f64;
    position.to_array().map(|metres| {
        let cells = (f64::from(metres) * cells_per_metre).clamp(-LIMIT, LIMIT);
        // `f64::floor` is a library call on plain x86-64.
        let truncated = cells as i64;
        truncated - i64::from(truncated as f64 > cells)
    })
}
