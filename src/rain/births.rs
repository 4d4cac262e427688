//! Which drops there are at one rate of rain and at another.
//!
//! As rain grows denser, drops come and none goes: Marshall and Palmer's density of every diameter
//! rises with the rate. So a drop may be told by how many there were when it came. It is the same
//! drop, as large and as fast, at every rate at which it is there, and the drops of a rate are those
//! that came first.

use super::drops::{INTERCEPT, SMALLEST};

/// Λ at which there are so many drops a m³ of [`SMALLEST`] and more: the inverse of
/// [`count`](super::drops::count). Unit: 1/mm. Its twin is `slope_of_count` in `births.wgsl`.
///
/// With y = Λ · [`SMALLEST`], y eʸ = N₀ · [`SMALLEST`] / `drops`: Lambert's function, here Winitzki's
/// estimate (2003, within 2 %) and a step of Newton's.
pub(crate) fn slope_of_count(drops: f64) -> f64 {
    let wanted = INTERCEPT * SMALLEST / drops.max(1e-3);
    let log = wanted.ln_1p();
    let guess = log * (1.0 - log.ln_1p() / (2.0 + log));
    let growth = guess.exp();
    (guess - (guess * growth - wanted) / (growth * (guess + 1.0))) / SMALLEST
}

/// The diameter of the drop that comes when there are `drops` a m³ already; `random` are numbers in
/// 0..1. Unit: mm, from [`SMALLEST`] on. Its twin is `diameter_of_birth` in `births.wgsl`.
///
/// What comes as Λ falls has the density −∂n/∂Λ = N₀ D e^(−ΛD). Above [`SMALLEST`] that is a mixture
/// of an exponential and the sum of two.
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

    /// Of the drops that have come by then, as many are of each size as the integral says.
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
                // Four standard deviations of the share, and what Newton's step leaves.
                let slack = 4.0 * (expected / f64::from(samples)).sqrt() + 1e-3 * expected;
                assert!(
                    (share - expected).abs() < slack,
                    "{rate} mm/h, {edge} mm: {share}, {expected}"
                );
            }
        }
    }
}
