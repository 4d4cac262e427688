//! The drops present at each rain rate.
//!
//! As rain grows denser, drops are added and none is removed: Marshall and Palmer's density of
//! every diameter rises with the rate. A drop is therefore identified by the number of drops before
//! it. It has the same size and speed at every rate at which it is present, and the drops of a rate
//! are those added first.

use super::drops::{INTERCEPT, SMALLEST};

/// Λ at which there are `drops` drops per m³ of [`SMALLEST`] and larger: the inverse of
/// [`count`](super::drops::count). Unit: 1/mm. Its twin is `slope_of_count` in `births.wgsl`.
///
/// With y = Λ · [`SMALLEST`], y eʸ = N₀ · [`SMALLEST`] / `drops`: Lambert's function, here by
/// Winitzki's estimate (2003, within 2 %) and one Newton step.
pub(crate) fn slope_of_count(drops: f64) -> f64 {
    let wanted = INTERCEPT * SMALLEST / drops.max(1e-3);
    let log = wanted.ln_1p();
    let guess = log * (1.0 - log.ln_1p() / (2.0 + log));
    let growth = guess.exp();
    (guess - (guess * growth - wanted) / (growth * (guess + 1.0))) / SMALLEST
}

/// The diameter of the drop that is added when there are `drops` per m³ already; `random` holds
/// numbers in 0..1. Unit: mm, from [`SMALLEST`] on. Its twin is `diameter_of_birth` in
/// `births.wgsl`.
///
/// Drops added as Λ falls have the density −∂n/∂Λ = N₀ D e^(−ΛD). Above [`SMALLEST`] that is a
/// mixture of an exponential and the sum of two.
pub(crate) fn diameter_of_birth(drops: f64, random: [f64; 3]) -> f64 {
    let slope = slope_of_count(drops);
    let longer = |random: f64| -random.max(1e-9).ln() / slope;
    let single = slope * SMALLEST / (1.0 + slope * SMALLEST);
    let second = if random[2] < single {
        0.0
    } else {
        longer(random[1])
    };
    SMALLEST + longer(random[0]) + second
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        rain::drops::{count, slope},
        random::Random,
    };

    #[test]
    fn slopes_are_those_of_the_counts() {
        for rate in [0.001, 0.1, 1.0, 10.0, 50.0, 200.0] {
            let found = slope_of_count(count(rate, SMALLEST, f64::INFINITY));
            assert!(
                (found / slope(rate) - 1.0).abs() < 1e-3,
                "{rate} mm/h: {found}"
            );
        }
        assert!(slope_of_count(0.0).is_finite());
    }

    /// The drops added so far have the size distribution of the integral.
    #[test]
    fn drops_that_have_come_are_marshall_and_palmers() {
        let mut random = Random::new(7);
        let samples = 400_000;
        for rate in [1.0, 10.0, 100.0] {
            let all = count(rate, SMALLEST, f64::INFINITY);
            let diameters: Vec<f64> = (0..samples)
                .map(|_| {
                    let before = all * random.next_f64();
                    diameter_of_birth(before, core::array::from_fn(|_| random.next_f64()))
                })
                .collect();
            for edge in [0.2, 0.5, 1.0, 1.5, 2.0, 3.0] {
                let more = diameters.iter().filter(|&&d| d > edge).count();
                let share = more as f64 / f64::from(samples);
                let expected = count(rate, edge, f64::INFINITY) / all;
                // Four standard deviations of the share, and the error of Newton's step.
                let slack = 4.0 * (expected / f64::from(samples)).sqrt() + 1e-3 * expected;
                assert!(
                    (share - expected).abs() < slack,
                    "{rate} mm/h, {edge} mm: {share}, {expected}"
                );
            }
        }
    }
}
