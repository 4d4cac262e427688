//! The phase function of raindrops: a sphere of water in geometric optics.
//!
//! A fit to rays traced through the sphere with Fresnel reflectance (the tests trace them): a
//! forward lobe of refracted light, a rainbow of light reflected once inside, and an even rest.
//! Diffraction is left out: it stays within a thousandth of a degree and cannot be distinguished
//! from light that missed the drop.

use core::f32::consts::PI;

/// Share of the light in the forward lobe, exp(`AHEAD_SHARPNESS` · (cos θ − 1)).
pub const AHEAD: f32 = 0.93;
/// Sharpness of the forward lobe. Higher: a narrower lobe.
pub const AHEAD_SHARPNESS: f32 = 7.4;
/// Share of the light in the rainbow.
pub const BOW: f32 = 0.045;
/// Cosine of the rainbow's scattering angle.
pub const BOW_COSINE: f32 = -0.79;
/// Half width of the rainbow, in the cosine of the scattering angle.
pub const BOW_WIDTH: f32 = 0.12;

/// The phase function: share of the light scattered per steradian at an angle with this cosine; 1
/// is straight ahead. Unit: 1/sr. Its twin is `phase` in `common.wgsl`.
pub fn phase(cosine: f32) -> f32 {
    let even = (1.0 - AHEAD - BOW) / (4.0 * PI);
    let ahead = AHEAD * AHEAD_SHARPNESS / (2.0 * PI) * (AHEAD_SHARPNESS * (cosine - 1.0)).exp();
    let off = (cosine - BOW_COSINE) / BOW_WIDTH;
    let bow = BOW / (2.0 * PI * BOW_WIDTH * PI.sqrt()) * (-off * off).exp();
    even + ahead + bow
}

#[cfg(test)]
mod tests {
    use super::*;

    const BINS: usize = 40;

    /// Rays evenly spread over the sphere's cross section, binned by the cosine of their
    /// deflection. Unit: 1/sr.
    fn traced() -> [f64; BINS] {
        let (rays, index) = (20_000, 1.333_f64);
        let mut bins = [0.0; BINS];
        for ray in 0..rays {
            let incident = ((f64::from(ray) + 0.5) / f64::from(rays)).sqrt().asin();
            let refracted = (incident.sin() / index).asin();
            let (sum, difference) = (incident + refracted, incident - refracted);
            let reflected = [
                (difference.sin() / sum.sin()).powi(2),
                (difference.tan() / sum.tan()).powi(2),
            ];
            // Reflected outside, or refracted in and out after some reflections inside.
            for inside in -1..7 {
                let power = |r: f64| match inside {
                    -1 => r,
                    _ => (1.0 - r).powi(2) * r.powi(inside),
                };
                let turned = match inside {
                    -1 => core::f64::consts::PI - 2.0 * incident,
                    _ => {
                        2.0 * difference
                            + f64::from(inside) * (core::f64::consts::PI - 2.0 * refracted)
                    }
                };
                let bin = ((turned.cos() + 1.0) * 0.5 * BINS as f64) as usize;
                bins[bin.min(BINS - 1)] += reflected.map(power).iter().sum::<f64>() / 2.0;
            }
        }
        let solid_angle = 2.0 / BINS as f64 * 2.0 * core::f64::consts::PI;
        bins.map(|power| power / f64::from(rays) / solid_angle)
    }

    /// The fit's mean over a bin.
    fn fitted(bin: usize) -> f64 {
        let steps = 50;
        let cosine = |i: usize| (bin as f32 + (i as f32 + 0.5) / steps as f32) / 20.0 - 1.0;
        (0..steps).map(|i| f64::from(phase(cosine(i)))).sum::<f64>() / steps as f64
    }

    #[test]
    fn all_light_goes_somewhere() {
        let total: f64 = (0..BINS)
            .map(|bin| fitted(bin) * 0.1 * core::f64::consts::PI)
            .sum();
        assert!((total - 1.0).abs() < 0.01, "{total}");
    }

    #[test]
    fn light_goes_where_a_traced_sphere_sends_it() {
        let traced = traced();
        let mean = |f: &dyn Fn(usize) -> f64| {
            (0..BINS)
                .map(|bin| f(bin) * 0.1 * core::f64::consts::PI * ((bin as f64 + 0.5) / 20.0 - 1.0))
                .sum::<f64>()
        };
        let (asymmetry, expected) = (mean(&fitted), mean(&|bin| traced[bin]));
        assert!(
            (asymmetry - expected).abs() < 0.02,
            "{asymmetry}, {expected}"
        );
        // Ahead, where nearly all light goes, and to the side.
        for (bin, traced) in traced.iter().enumerate().skip(16) {
            let ratio = fitted(bin) / traced;
            assert!((0.75..1.6).contains(&ratio), "bin {bin}: {ratio}");
        }
        // The rainbow is narrower than a bin: its light is compared as a whole.
        let bow = |f: &dyn Fn(usize) -> f64| (0..12).map(f).sum::<f64>();
        let ratio = bow(&fitted) / bow(&|bin| traced[bin]);
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
}
