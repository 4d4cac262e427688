//! Drops in classes by diameter: those of a class share their textures and the speed they fall at.
//! Near the eye there are [`FINE`] of them; farther off one class holds all drops.

use bevy::prelude::*;

use super::drops::{DragLaw, LARGEST, SMALLEST, count, density, extinction_between};

/// How many classes drops are told apart by near the eye. Each costs a texture lookup a voxel.
pub const FINE: usize = 4;
/// These, and one with all drops, which is the last.
pub const CLASSES: usize = FINE + 1;
/// Borders between the classes. Unit: mm.
const BORDERS: [f64; FINE - 1] = [0.8, 1.4, 2.2];
/// How many densities of drops a texture holds, one in each channel.
pub const DENSITIES: usize = 4;
/// The rain rates whose drops in one metre of depth are those densities. Unit: mm/h.
pub const BAKED_RATES: [f64; DENSITIES] = [1.0, 5.0, 20.0, 80.0];
/// The rate at which a class's mean speed is taken; between rates it differs by a few per cent.
const TYPICAL_RATE: f64 = 10.0;

/// A range of diameters. Unit: mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Class {
    /// The diameters for which it stands: the fine classes together hold all drops.
    pub low: f64,
    /// May be infinite.
    pub high: f64,
}

impl Class {
    /// All classes: the fine ones, small drops first, and that of all drops.
    pub fn all() -> [Self; CLASSES] {
        core::array::from_fn(|i| Self {
            low: if i == 0 || i == FINE {
                0.0
            } else {
                BORDERS[i - 1]
            },
            high: BORDERS.get(i).copied().unwrap_or(f64::INFINITY),
        })
    }

    /// The diameters that are drawn. Unit: mm.
    pub fn drawn(&self) -> (f64, f64) {
        (self.low.max(SMALLEST), self.high.min(LARGEST))
    }

    /// Drawn drops per m³ of rain of some rate (mm/h).
    pub fn count(&self, rate: f64) -> f64 {
        let (low, high) = self.drawn();
        count(rate, low, high)
    }

    /// The class's part of β. Units: mm/h, 1/m.
    pub fn extinction(&self, rate: f64) -> f64 {
        extinction_between(rate, self.low, self.high)
    }

    /// The mean speed of its drops, weighted by the light they take. Unit: m/s.
    pub fn speed(&self, law: DragLaw) -> f64 {
        let (low, high) = self.drawn();
        let steps = 64;
        let (mut sum, mut weights) = (0.0, 0.0);
        for step in 0..steps {
            let diameter = low + (high - low) * (f64::from(step) + 0.5) / f64::from(steps);
            let weight = density(TYPICAL_RATE, diameter) * diameter * diameter;
            sum += weight * law.speed(diameter);
            weights += weight;
        }
        sum / weights
    }
}

/// How much of each of the baked densities makes up an optical depth of `wanted`, given what each
/// of them has. Densities are nested: the drops of one are also in the next. So between two of them
/// the additional drops fade in; below the first and above the last all drops fade.
pub fn density_weights(wanted: f64, baked: [f64; DENSITIES]) -> Vec4 {
    let mut weights = Vec4::ZERO;
    let mut below: Option<usize> = None;
    for (i, &has) in baked.iter().enumerate() {
        let less = below.map_or(0.0, |j| baked[j]);
        // A density in which the class has no drop, or none more, cannot be told from the one before.
        if has <= less {
            continue;
        }
        if wanted <= has {
            let t = ((wanted - less) / (has - less)).max(0.0);
            weights[i] = t as f32;
            if let Some(j) = below {
                weights[j] = 1.0 - weights[i];
            }
            return weights;
        }
        below = Some(i);
    }
    if let Some(last) = below {
        weights[last] = (wanted / baked[last]) as f32;
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rain::drops::extinction;

    #[test]
    fn classes_together_hold_all_drops() {
        for rate in [1.0, 10.0, 100.0] {
            let sum: f64 = Class::all()[..FINE]
                .iter()
                .map(|c| c.extinction(rate))
                .sum();
            assert!((sum / extinction(rate) - 1.0).abs() < 1e-9);
            // What is drawn of it, so far as the drawn diameters go.
            let drawn: f64 = Class::all()[..FINE].iter().map(|c| c.count(rate)).sum();
            assert!((drawn / count(rate, SMALLEST, LARGEST) - 1.0).abs() < 1e-9);
            let taken = extinction_between(rate, SMALLEST, LARGEST);
            assert!(taken / extinction(rate) > 0.99, "{rate} mm/h");
        }
    }

    #[test]
    fn larger_drops_fall_faster() {
        for law in [DragLaw::GunnKinzer, DragLaw::RigidSphere] {
            let speeds = Class::all().map(|c| c.speed(law));
            assert!(speeds[..FINE].is_sorted() && speeds[0] > 0.5, "{speeds:?}");
            assert!(speeds[0] < speeds[FINE] && speeds[FINE] < speeds[FINE - 1]);
        }
    }

    #[test]
    fn weights_make_up_what_is_wanted() {
        let baked = [1.0, 3.0, 4.0, 10.0];
        for wanted in [0.0, 0.3, 1.0, 2.0, 3.0, 3.5, 9.0, 10.0, 40.0] {
            let weights = density_weights(wanted, baked);
            let sum: f64 = (0..4).map(|i| f64::from(weights[i]) * baked[i]).sum();
            assert!((sum - wanted).abs() < 1e-5, "{wanted}: {weights}");
            assert!(weights.cmpge(Vec4::ZERO).all());
        }
        // At a baked density it alone is seen.
        assert_eq!(density_weights(3.0, baked), vec4(0.0, 1.0, 0.0, 0.0));
    }

    #[test]
    fn densities_without_drops_are_passed_over() {
        let weights = density_weights(1.0, [0.0, 0.0, 2.0, 2.0]);
        assert_eq!(weights, vec4(0.0, 0.0, 0.5, 0.0));
        assert_eq!(density_weights(1.0, [0.0; 4]), Vec4::ZERO);
        let weights = density_weights(3.0, [0.0, 2.0, 2.0, 4.0]);
        assert_eq!(weights, vec4(0.0, 0.5, 0.0, 0.5));
    }
}
