//! A particle's neighbourhood: count, mean and covariance.

/// Weighted neighbourhood of one particle, itself included, with w = 1 − (d/R)³
/// (Yu & Turk 2013, equations 9 to 11). Lengths in R.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Neighborhood {
    /// Number of neighbours, without the particle itself. Those in the outer tenth of R count in
    /// part, so it is continuous.
    pub(super) count: f32,
    /// Weighted mean, from the particle.
    pub(super) mean: [f32; 3],
    /// Weighted covariance about the mean: xx, xy, xz, yy, yz, zz.
    pub(super) covariance: [f32; 6],
    /// How nearly the neighbours lie in a plane, and not on a line: 0 to 1.
    pub(super) flatness: f32,
}

/// How much of a ball the neighbours fill, up to which they lie in a plane and from which they do not.
/// Particles moved by up to 0.2 spacings from a square lattice reach 0.2; two such layers have 0.8,
/// particles at the surface of a large body 0.9.
const FILLED: [f32; 2] = [0.2, 0.6];

/// How much of a disc they fill, up to which they lie on a line and from which they do not.
const SPREAD_OUT: [f32; 2] = [0.2, 0.5];

/// Trace of the covariance, in R², up to which neighbours are too close together to be a sheet, and from
/// which they are not. A sheet at rest has 0.3, its corner 0.12.
const APART: [f32; 2] = [0.02, 0.08];

/// Neighbours of a sheet from which on each counts more than once, up to those of its rim. A sheet
/// at rest has 8 to 12, its rim 5, a corner 3; a full ball has 28, the surface of a large body 17.
const IN_SHEET: [f32; 2] = [2.0, 5.0];

/// By how much each of them counts more: a rim is then as dense as a body.
const SHEET_COUNTS: f32 = 2.7;

impl Neighborhood {
    pub(super) fn new(count: f32, mean: [f32; 3], covariance: [f32; 6]) -> Self {
        Self {
            count,
            mean,
            covariance,
            flatness: flatness(covariance),
        }
    }

    /// Number of neighbours that class and shape go by: those of a sheet count more, as there are none
    /// before and behind it.
    pub(super) fn crowd(&self) -> f32 {
        let [least, rim] = IN_SHEET;
        let in_sheet = (self.count - least).clamp(0.0, rim - least);
        self.count + SHEET_COUNTS * self.flatness * in_sheet
    }

    /// Sum of the covariance's eigenvalues.
    pub(super) fn trace(&self) -> f32 {
        self.covariance[0] + self.covariance[3] + self.covariance[5]
    }

    /// Squared distance of the covariance from the nearest multiple of the identity
    /// (Frobenius norm), as a part of its squared trace.
    pub(super) fn anisotropy_squared(&self) -> f32 {
        let [xx, xy, xz, yy, yz, zz] = self.covariance;
        let mean = self.trace() / 3.0;
        let squared = |a: f32| a * a;
        let diagonal = [xx, yy, zz].map(|a| squared(a - mean)).iter().sum::<f32>();
        let rest = 2.0 * [xy, xz, yz].map(squared).iter().sum::<f32>();
        (diagonal + rest) / squared(self.trace()).max(f32::MIN_POSITIVE)
    }
}

fn flatness([xx, xy, xz, yy, yz, zz]: [f32; 6]) -> f32 {
    let trace = xx + yy + zz;
    let minors = [yy * zz - yz * yz, xx * zz - xz * xz, xx * yy - xy * xy];
    let determinant = xx * minors[0] - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
    let minors = minors.iter().sum::<f32>();
    // 1 and 1 in a ball, 0 and 3/4 in a disc, and 0 on a line.
    let filled = 3.0 * determinant * trace / (minors * minors).max(f32::MIN_POSITIVE);
    let spread = 3.0 * minors / (trace * trace).max(f32::MIN_POSITIVE);
    let within =
        |[none, all]: [f32; 2], value: f32| ((value - none) / (all - none)).clamp(0.0, 1.0);
    (1.0 - within(FILLED, filled)) * within(SPREAD_OUT, spread) * within(APART, trace)
}
