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
}

impl Neighborhood {
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
