//! Simple, slow reference implementations for the tests.
//!
//! Shared by the unit tests and `tests/cpu`; they use nothing of the stage itself.

use bevy::math::Vec3;

/// Neighbours of a particle within `reach`, itself left out, by comparing with every other.
pub(crate) fn neighbors(positions: &[Vec3], of: usize, reach: f32) -> Vec<usize> {
    let near = |&other: &usize| {
        let [x, y, z] = (positions[other] - positions[of]).to_array();
        x * x + y * y + z * z <= reach * reach
    };
    let others = (0..positions.len()).filter(|&other| other != of);
    others.filter(near).collect()
}

/// Number of neighbours, those in the outer tenth of `reach` in part, in f64.
pub(crate) fn count(positions: &[Vec3], of: usize, reach: f32) -> f64 {
    let around = neighbors(positions, of, reach);
    let counted = around.into_iter().map(|other| {
        let distance = positions[other]
            .as_dvec3()
            .distance(positions[of].as_dvec3());
        (10.0 * (1.0 - distance / f64::from(reach))).clamp(0.0, 1.0)
    });
    counted.sum()
}

/// How nearly neighbours of this covariance (in `reach`²) lie in a plane: 0 to 1.
pub(crate) fn flatness(covariance: [f64; 6]) -> f64 {
    let [a, b, c] = eigenvalues(covariance);
    let within = |none: f64, all: f64, value: f64| ((value - none) / (all - none)).clamp(0.0, 1.0);
    let (trace, minors) = (a + b + c, a * b + b * c + c * a);
    let filled = 3.0 * a * b * c * trace / (minors * minors).max(1e-40);
    let spread = 3.0 * minors / (trace * trace).max(1e-40);
    within(0.6, 0.2, filled) * within(0.2, 0.5, spread) * within(0.02, 0.08, trace)
}

/// Neighbours that class and shape go by.
pub(crate) fn crowd(positions: &[Vec3], of: usize, reach: f32) -> f64 {
    let count = count(positions, of, reach);
    let flatness = flatness(moments(positions, of, reach).1);
    count + 2.7 * flatness * (count.clamp(2.0, 5.0) - 2.0)
}

/// The part of a particle that is bulk.
pub(crate) fn bulk_weight(count: f64, threshold: u32) -> f64 {
    if threshold == 0 {
        return 1.0;
    }
    let threshold = f64::from(threshold);
    let none = (threshold - 3.0).max(0.0);
    ((count - none) / (threshold - none)).clamp(0.0, 1.0)
}

/// Weighted mean (in `reach`, from the particle) and covariance xx, xy, xz, yy, yz, zz (in
/// `reach`²) in f64, in two passes.
pub(crate) fn moments(positions: &[Vec3], of: usize, reach: f32) -> ([f64; 3], [f64; 6]) {
    let mut around = neighbors(positions, of, reach);
    around.push(of);
    let offsets = around.iter().map(|&other| {
        let [a, b] = [other, of].map(|particle| positions[particle].as_dvec3());
        (a - b) / f64::from(reach)
    });
    let weighted: Vec<_> = offsets
        .map(|offset| (1.0 - offset.length().powi(3), offset))
        .collect();
    let total: f64 = weighted.iter().map(|(weight, _)| weight).sum();
    let mut mean = [0.0; 3];
    for &(weight, offset) in &weighted {
        for axis in 0..3 {
            mean[axis] += weight * offset[axis] / total;
        }
    }
    let mut covariance = [0.0; 6];
    for &(weight, offset) in &weighted {
        let d = [0, 1, 2].map(|axis| offset[axis] - mean[axis]);
        for (entry, (a, b)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
            .into_iter()
            .enumerate()
        {
            covariance[entry] += weight * d[a] * d[b] / total;
        }
    }
    (mean, covariance)
}

/// Eigenvalues of a symmetric matrix (xx, xy, xz, yy, yz, zz), largest first: Jacobi in f64,
/// always turning the largest entry to zero, until nothing is left.
pub(crate) fn eigenvalues([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> [f64; 3] {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    for _ in 0..100 {
        let size = |&(p, q): &(usize, usize)| a[p][q].abs();
        let pairs = [(0, 1), (0, 2), (1, 2)];
        let (p, q) = pairs
            .into_iter()
            .max_by(|left, right| size(left).total_cmp(&size(right)))
            .unwrap_or((0, 1));
        if a[p][q] == 0.0 {
            break;
        }
        let (sin, cos) = (0.5 * (2.0 * a[p][q]).atan2(a[q][q] - a[p][p])).sin_cos();
        let columns = a.map(|row| (row[p], row[q]));
        for (row, (u, v)) in a.iter_mut().zip(columns) {
            (row[p], row[q]) = (cos * u - sin * v, sin * u + cos * v);
        }
        let (up, uq) = (a[p], a[q]);
        for k in 0..3 {
            (a[p][k], a[q][k]) = (cos * up[k] - sin * uq[k], sin * up[k] + cos * uq[k]);
        }
        (a[p][q], a[q][p]) = (0.0, 0.0);
    }
    let mut values = [a[0][0], a[1][1], a[2][2]];
    values.sort_by(|left, right| right.total_cmp(left));
    values
}

/// Deterministic, evenly distributed numbers from 0 to 1.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f32 {
        // xorshift64* (Vigna 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f32 / (1_u32 << 24) as f32
    }

    pub(crate) fn point(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next())
    }
}

/// Cubic lattice of `size`³ particles `spacing` apart, each moved by up to `jitter` spacings
/// along each axis.
pub(crate) fn lattice(size: usize, spacing: f32, jitter: f32) -> Vec<Vec3> {
    let mut random = Random(1);
    let cells = (0..size * size * size).map(|i| [i % size, i / size % size, i / size / size]);
    cells
        .map(|cell| {
            let at = Vec3::from(cell.map(|index| index as f32));
            (at + (random.point() * 2.0 - Vec3::ONE) * jitter) * spacing
        })
        .collect()
}
