//! The physics of falling drops: size distribution, terminal velocity and extinction.
//!
//! Diameters are in millimetres and rain rates in mm/h, as in the literature; everything else is in
//! metres and seconds.

use bevy::prelude::*;

/// N₀ of Marshall and Palmer (1948). Unit: drops per m³ and mm of diameter.
pub const INTERCEPT: f64 = 8000.0;
/// Drops smaller than this are not drawn. They cause less than 1 % of the extinction of all drops,
/// at 1 mm/h and above. Unit: mm.
pub const SMALLEST: f64 = 0.1;
/// Drops larger than this break up. Unit: mm.
pub const LARGEST: f64 = 6.0;

const GRAVITY: f64 = 9.806_65;
/// At 20 °C and 1013 hPa, as in Gunn and Kinzer's measurements. Units: kg/m³, kg/m³, Pa·s.
const WATER_DENSITY: f64 = 998.2;
const AIR_DENSITY: f64 = 1.204;
const AIR_VISCOSITY: f64 = 1.82e-5;

/// How a drop's terminal velocity follows from its size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum DragLaw {
    /// The measurements of Gunn and Kinzer (1949).
    #[default]
    GunnKinzer,
    /// The drag of a rigid sphere, as in the rain paper (Yoshida et al., equations 2 to 4). Drops
    /// above 2 mm fall too fast, by up to 40 % at 6 mm, because real drops flatten.
    RigidSphere,
}

impl DragLaw {
    /// Terminal velocity of a drop. Units: mm, m/s. Invalid sizes return 0.
    pub fn speed(self, diameter: f64) -> f64 {
        if !(diameter > 0.0 && diameter.is_finite()) {
            return 0.0;
        }
        match self {
            Self::GunnKinzer => measured_speed(diameter),
            Self::RigidSphere => rigid_speed(diameter).speed,
        }
    }
}

/// Gunn and Kinzer's table: diameter (mm), speed (m/s).
pub const GUNN_KINZER: [(f64, f64); 34] = [
    (0.1, 0.27),
    (0.2, 0.72),
    (0.3, 1.17),
    (0.4, 1.62),
    (0.5, 2.06),
    (0.6, 2.47),
    (0.7, 2.87),
    (0.8, 3.27),
    (0.9, 3.67),
    (1.0, 4.03),
    (1.2, 4.64),
    (1.4, 5.17),
    (1.6, 5.65),
    (1.8, 6.09),
    (2.0, 6.49),
    (2.2, 6.90),
    (2.4, 7.27),
    (2.6, 7.57),
    (2.8, 7.82),
    (3.0, 8.06),
    (3.2, 8.26),
    (3.4, 8.44),
    (3.6, 8.60),
    (3.8, 8.72),
    (4.0, 8.83),
    (4.2, 8.92),
    (4.4, 8.98),
    (4.6, 9.03),
    (4.8, 9.07),
    (5.0, 9.09),
    (5.2, 9.12),
    (5.4, 9.14),
    (5.6, 9.16),
    (5.8, 9.17),
];

/// Linear between the table's entries; below them as the square of the diameter (Stokes), above
/// them constant.
fn measured_speed(diameter: f64) -> f64 {
    let (first, last) = (GUNN_KINZER[0], GUNN_KINZER[GUNN_KINZER.len() - 1]);
    if diameter <= first.0 {
        return first.1 * (diameter / first.0).powi(2);
    }
    let above = GUNN_KINZER.partition_point(|&(d, _)| d < diameter);
    if above == GUNN_KINZER.len() {
        return last.1;
    }
    let ((d0, v0), (d1, v1)) = (GUNN_KINZER[above - 1], GUNN_KINZER[above]);
    v0 + (v1 - v0) * (diameter - d0) / (d1 - d0)
}

/// Reynolds number of a drop. Units: mm, m/s.
pub fn reynolds(diameter: f64, speed: f64) -> f64 {
    AIR_DENSITY * speed * diameter * 1e-3 / AIR_VISCOSITY
}

/// Drag coefficient of a rigid sphere, in two pieces (Yoshida et al., equation 3): Stokes' law
/// below a Reynolds number of 1, above it the empirical law for up to 10⁴.
pub fn drag_coefficient(reynolds: f64) -> f64 {
    if reynolds < 1.0 {
        24.0 / reynolds
    } else {
        (0.55 + 4.8 / reynolds.sqrt()).powi(2)
    }
}

/// Result of the iteration for a rigid sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidSpeed {
    /// Terminal velocity. Unit: m/s.
    pub speed: f64,
    /// Number of evaluations of the drag.
    pub steps: u32,
    /// Relative change in the last step.
    pub change: f64,
}

/// Maximum number of steps of the iteration.
pub const MAX_STEPS: u32 = 30;

/// Terminal velocity of a rigid sphere: speed → Reynolds number → drag → speed, until it converges.
///
/// The two pieces of the drag do not meet at a Reynolds number of 1: where the iteration jumps to
/// and fro between them, the jump is narrowed down by halving.
pub fn rigid_speed(diameter: f64) -> RigidSpeed {
    let fall =
        4.0 * GRAVITY * diameter * 1e-3 * (WATER_DENSITY - AIR_DENSITY) / (3.0 * AIR_DENSITY);
    // A drag coefficient of 1 to begin with.
    let mut out = RigidSpeed {
        speed: fall.sqrt(),
        steps: 0,
        change: f64::INFINITY,
    };
    // Speeds known to grow and to shrink: both are known only where the iteration jumps.
    let (mut low, mut high) = (0.0, f64::INFINITY);
    while out.steps < MAX_STEPS && out.change.abs() > 1e-6 {
        let mut next = (fall / drag_coefficient(reynolds(diameter, out.speed))).sqrt();
        if next > out.speed {
            low = out.speed;
        } else {
            high = out.speed;
        }
        if low > 0.0 && high.is_finite() {
            next = (low * high).sqrt();
        }
        out.change = next / out.speed - 1.0;
        out.speed = next;
        out.steps += 1;
    }
    out
}

/// Λ of Marshall and Palmer. Units: mm/h, 1/mm.
pub fn slope(rate: f64) -> f64 {
    4.1 * rate.powf(-0.21)
}

/// Drops per m³ and mm of diameter (Marshall and Palmer 1948). Units: mm/h, mm.
pub fn density(rate: f64, diameter: f64) -> f64 {
    if rate > 0.0 {
        INTERCEPT * (-slope(rate) * diameter).exp()
    } else {
        0.0
    }
}

/// Drops per m³ with diameters from `low` to `high`, which may be infinite: the integral of
/// [`density`]. Units: mm/h, mm.
pub fn count(rate: f64, low: f64, high: f64) -> f64 {
    if rate > 0.0 {
        let slope = slope(rate);
        INTERCEPT / slope * ((-slope * low).exp() - (-slope * high).exp())
    } else {
        0.0
    }
}

/// β, the extinction by drops with diameters from `low` to `high`, which may be infinite: the
/// fraction of light lost per metre, ∫ n π D²/4 dD. Units: mm/h, mm, 1/m.
///
/// A drop removes the light that meets its cross section, whatever the exposure time.
pub fn extinction_between(rate: f64, low: f64, high: f64) -> f64 {
    // Also for NaN.
    if rate.is_nan() || rate <= 0.0 {
        return 0.0;
    }
    let slope = slope(rate);
    // ∫ x² e^(−x) from x to infinity.
    let above = |diameter: f64| {
        let x = slope * diameter;
        if x.is_finite() {
            (-x).exp() * (x * x + 2.0 * x + 2.0)
        } else {
            0.0
        }
    };
    // mm² to m².
    1e-6 * core::f64::consts::FRAC_PI_4 * INTERCEPT / slope.powi(3) * (above(low) - above(high))
}

/// β, the extinction by all drops. Units: mm/h, 1/m.
pub fn extinction(rate: f64) -> f64 {
    extinction_between(rate, 0.0, f64::INFINITY)
}

/// The rate at which [`mean_speed`] is taken; between rates it differs by a few per cent.
const TYPICAL_RATE: f64 = 10.0;

/// The mean terminal velocity of drops, weighted by their extinction. Unit: m/s.
pub fn mean_speed(law: DragLaw) -> f64 {
    let steps = 256;
    let (mut sum, mut weights) = (0.0, 0.0);
    for step in 0..steps {
        let diameter = SMALLEST + (LARGEST - SMALLEST) * (f64::from(step) + 0.5) / f64::from(steps);
        let weight = density(TYPICAL_RATE, diameter) * diameter * diameter;
        sum += weight * law.speed(diameter);
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gunn and Kinzer's measurements, as cited elsewhere.
    const CITED: [(f64, f64); 10] = [
        (0.1, 0.27),
        (0.2, 0.72),
        (0.5, 2.06),
        (1.0, 4.03),
        (1.4, 5.17),
        (2.0, 6.49),
        (3.0, 8.06),
        (4.0, 8.83),
        (5.0, 9.09),
        (5.8, 9.17),
    ];

    #[test]
    fn the_default_law_is_what_was_measured() {
        for (diameter, measured) in CITED {
            let speed = DragLaw::default().speed(diameter);
            assert!(
                (speed / measured - 1.0).abs() < 0.02,
                "{diameter} mm: {speed}"
            );
        }
    }

    /// A slip in one entry would break the interpolation between its neighbours. Up to 0.2 mm the
    /// law bends too much for that.
    #[test]
    fn every_entry_lies_between_its_neighbours() {
        for window in GUNN_KINZER.windows(3).skip(1) {
            let [(d0, v0), (d1, v1), (d2, v2)] = [window[0], window[1], window[2]];
            let between = v0 + (v2 - v0) * (d1 - d0) / (d2 - d0);
            assert!(
                (v1 / between - 1.0).abs() < 0.02,
                "{d1} mm: {v1}, {between}"
            );
            assert!(v0 < v1 && v1 < v2);
        }
    }

    /// The fit of Atlas, Srivastava and Sekhon (1973) to the same measurements, good to 2 % within
    /// its stated range.
    #[test]
    fn the_table_agrees_with_the_published_fit() {
        for step in 0..=44 {
            let diameter = 0.7 + 0.1 * f64::from(step);
            let fit = 9.65 - 10.3 * (-0.6 * diameter).exp();
            let speed = DragLaw::GunnKinzer.speed(diameter);
            assert!(
                (speed / fit - 1.0).abs() < 0.03,
                "{diameter} mm: {speed}, {fit}"
            );
        }
    }

    #[test]
    fn the_iteration_ends_within_its_steps() {
        for step in 1..=1200 {
            let diameter = 0.005 * f64::from(step);
            let rigid = rigid_speed(diameter);
            assert!(rigid.steps <= MAX_STEPS);
            assert!(rigid.change.abs() < 1e-4, "{diameter} mm: {rigid:?}");
            // It is a fixed point, or it is at the jump of the drag.
            let re = reynolds(diameter, rigid.speed);
            let weight = GRAVITY * (WATER_DENSITY - AIR_DENSITY) * diameter * 1e-3 * 4.0 / 3.0;
            let drag = AIR_DENSITY * rigid.speed.powi(2) * drag_coefficient(re);
            let balanced = (drag / weight - 1.0).abs() < 1e-3;
            assert!(
                balanced || (re - 1.0).abs() < 1e-3,
                "{diameter} mm: {rigid:?}, Re {re}"
            );
        }
    }

    #[test]
    fn a_rigid_sphere_falls_as_stokes_says_when_small_and_too_fast_when_large() {
        let stokes =
            GRAVITY * (WATER_DENSITY - AIR_DENSITY) * 4e-5_f64.powi(2) / (18.0 * AIR_VISCOSITY);
        assert!((DragLaw::RigidSphere.speed(0.04) / stokes - 1.0).abs() < 1e-3);
        let ratio = |d| DragLaw::RigidSphere.speed(d) / DragLaw::GunnKinzer.speed(d);
        assert!((ratio(1.0) - 1.0).abs() < 0.1, "{}", ratio(1.0));
        assert!(ratio(5.8) > 1.2 && ratio(5.8) < 1.5, "{}", ratio(5.8));
    }

    #[test]
    fn sizes_without_sense_do_not_fall() {
        for law in [DragLaw::GunnKinzer, DragLaw::RigidSphere] {
            for diameter in [0.0, -1.0, f64::NAN, f64::INFINITY] {
                assert_eq!(law.speed(diameter), 0.0);
            }
        }
    }

    fn integrate(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
        let steps = 200_000;
        let width = (to - from) / f64::from(steps);
        (0..steps)
            .map(|i| width * f(from + (f64::from(i) + 0.5) * width))
            .sum()
    }

    #[test]
    fn counts_and_extinctions_are_the_integrals() {
        for rate in [1.0, 5.0, 10.0, 20.0, 100.0] {
            for (low, high) in [(0.0, 40.0), (0.5, 40.0), (1.0, 1.4), (2.0, 6.0)] {
                let counted = integrate(low, high, |d| density(rate, d));
                assert!((count(rate, low, high) / counted - 1.0).abs() < 1e-6);
                let area = |d: f64| core::f64::consts::FRAC_PI_4 * d * d * 1e-6;
                let lost = integrate(low, high, |d| density(rate, d) * area(d));
                assert!((extinction_between(rate, low, high) / lost - 1.0).abs() < 1e-6);
            }
        }
    }

    /// Totals from D = 0, > 0.5, > 1 and > 2 mm, and β.
    #[test]
    fn totals_are_those_of_the_literature() {
        for (rate, totals, beta) in [
            (1.0, [1951.0, 251.0, 32.0, 0.5], 1.8e-4),
            (10.0, [3165.0, 894.0, 253.0, 20.0], 7.8e-4),
            (50.0, [4437.0, 1801.0, 731.0, 120.0], 2.1e-3),
        ] {
            for (low, total) in [0.0, 0.5, 1.0, 2.0].into_iter().zip(totals) {
                // They are rounded or cut to whole drops; the last of the first to tenths.
                let slack = if total < 1.0 { 0.1 } else { 1.0 };
                let counted = count(rate, low, f64::INFINITY);
                assert!((counted - total).abs() <= slack, "{rate} {low}: {counted}");
            }
            assert!((extinction(rate) / beta - 1.0).abs() < 0.03);
        }
        assert!((extinction(100.0) / 3.3e-3 - 1.0).abs() < 0.01);
    }

    /// Drops that are not drawn cause almost no extinction.
    #[test]
    fn drawn_drops_take_all_the_light() {
        for rate in [1.0, 10.0, 100.0] {
            let taken = extinction_between(rate, SMALLEST, LARGEST);
            assert!(taken / extinction(rate) > 0.99, "{rate} mm/h");
        }
    }

    /// Half of the extinction is by drops above 1.06 mm at 10 mm/h (Λ D = 2.67).
    #[test]
    fn the_mean_speed_is_that_of_a_middling_drop() {
        for law in [DragLaw::GunnKinzer, DragLaw::RigidSphere] {
            let speed = mean_speed(law);
            assert!(law.speed(0.8) < speed && speed < law.speed(1.4), "{speed}");
        }
    }

    #[test]
    fn no_rain_has_no_drops() {
        for rate in [0.0, -1.0, f64::NAN] {
            assert_eq!(density(rate, 1.0), 0.0);
            assert_eq!(count(rate, 0.0, f64::INFINITY), 0.0);
        }
        assert_eq!(extinction(0.0), 0.0);
    }
}
