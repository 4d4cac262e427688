//! The drop densities held by the textures of streaks, and how they are mixed for any rain rate.

use bevy::prelude::*;

/// Number of drop densities in a texture, one in each channel.
pub const DENSITIES: usize = 4;
/// The rain rates whose drops in one metre of depth give those densities. Unit: mm/h. Voxels are at
/// least two metres deep: the first rate is drizzle in those, the last heavy rain in 4 m.
pub const BAKED_RATES: [f64; DENSITIES] = [2.0, 10.0, 50.0, 200.0];

/// Weights of the baked densities that add up to an optical depth of `wanted`; `baked` holds the
/// optical depth of each. Densities are nested: the drops of one are also in the next.
///
/// Between two densities, the additional drops fade in and the others are slightly stronger to
/// compensate, so that the squares of all opacities add up like those of `wanted` drops of full
/// opacity: the variance of pixels over time is then correct. Below the first and above the last
/// density, the opacity of all drops is scaled.
pub fn density_weights(wanted: f64, baked: [f64; DENSITIES]) -> Vec4 {
    let mut weights = Vec4::ZERO;
    let mut below: Option<usize> = None;
    for (i, &has) in baked.iter().enumerate() {
        let less = below.map_or(0.0, |j| baked[j]);
        // A density with no more drops than the one before adds nothing.
        if has <= less {
            continue;
        }
        if wanted <= has {
            let Some(j) = below else {
                weights[i] = (wanted / has).max(0.0) as f32;
                return weights;
            };
            let (there, more) = between(wanted, less, has);
            weights[i] = more as f32;
            weights[j] = (there - more) as f32;
            return weights;
        }
        below = Some(i);
    }
    if let Some(last) = below {
        weights[last] = (wanted / baked[last]) as f32;
    }
    weights
}

/// The opacities x of the drops of `less` and y of those that `more` adds, for which both
/// less·x + (more − less)·y and less·x² + (more − less)·y² are `wanted`.
fn between(wanted: f64, less: f64, more: f64) -> (f64, f64) {
    let besides = more - less;
    // Mean and spread of the opacities, drops weighted by their extinction.
    let mean = wanted / more;
    let spread = (mean - mean * mean).max(0.0).sqrt();
    let x = mean + spread * (besides / less).sqrt();
    let y = mean - spread * (less / besides).sqrt();
    (x, y.max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAKED: [f64; DENSITIES] = [1.0, 3.0, 4.0, 10.0];

    /// Opacity and amount of each nested set of drops.
    fn opacities(weights: Vec4) -> [(f64, f64); DENSITIES] {
        let mut less = 0.0;
        core::array::from_fn(|i| {
            let opacity = (i..DENSITIES).map(|j| f64::from(weights[j])).sum();
            let amount = BAKED[i] - less;
            less = BAKED[i];
            (opacity, amount)
        })
    }

    #[test]
    fn weights_make_up_what_is_wanted() {
        for wanted in [0.0, 0.3, 1.0, 2.0, 3.0, 3.5, 9.0, 10.0, 40.0] {
            let weights = density_weights(wanted, BAKED);
            let sum: f64 = opacities(weights)
                .iter()
                .map(|(o, amount)| o * amount)
                .sum();
            assert!((sum - wanted).abs() < 1e-5, "{wanted}: {weights}");
            assert!(
                opacities(weights).iter().all(|(o, _)| *o >= -1e-6),
                "{weights}"
            );
        }
        // At a baked density, only that density is visible.
        assert!((density_weights(3.0, BAKED) - vec4(0.0, 1.0, 0.0, 0.0)).length() < 1e-6);
    }

    #[test]
    fn pixels_vary_as_with_that_many_drops() {
        for wanted in [1.0, 1.2, 2.0, 2.9, 3.0, 3.5, 7.0, 10.0] {
            let weights = density_weights(wanted, BAKED);
            let squares: f64 = opacities(weights)
                .iter()
                .map(|(o, amount)| o * o * amount)
                .sum();
            assert!((squares / wanted - 1.0).abs() < 1e-5, "{wanted}: {squares}");
            // No drop is conspicuous.
            assert!(
                opacities(weights).iter().all(|(o, _)| *o < 1.45),
                "{weights}"
            );
        }
    }

    #[test]
    fn weights_follow_the_rate_without_a_jump() {
        let mut before = density_weights(0.0, BAKED);
        for step in 1..=12_000 {
            let weights = density_weights(f64::from(step) * 1e-3, BAKED);
            // The spread starts like a square root.
            assert!(
                (weights - before).length() < 0.1,
                "{step}: {before}, {weights}"
            );
            before = weights;
        }
    }

    #[test]
    fn densities_without_drops_are_passed_over() {
        let weights = density_weights(1.0, [0.0, 0.0, 2.0, 2.0]);
        assert_eq!(weights, vec4(0.0, 0.0, 0.5, 0.0));
        assert_eq!(density_weights(1.0, [0.0; DENSITIES]), Vec4::ZERO);
        assert_eq!(
            density_weights(6.0, [0.0, 2.0, 2.0, 3.0]),
            vec4(0.0, 0.0, 0.0, 2.0)
        );
    }
}
