//! The WGSL form against the Rust form and f64.

use bevy::prelude::*;
use bevy_fluid::prelude::Medium;

use super::gpu::measure;

/// A medium of this extinction that sends 1 a metre.
fn glowing(extinction: f32) -> Medium {
    Medium {
        absorption_density: extinction,
        absorption_color: LinearRgba::BLACK,
        emission: LinearRgba::WHITE,
        ..Medium::CLEAR
    }
}

/// What is left and what a source of 1 sends, in f64.
fn exact([extinction, length]: [f32; 2]) -> [f64; 2] {
    let [b, d] = [extinction, length].map(f64::from);
    let seen = if b == 0.0 { d } else { -(-b * d).exp_m1() / b };
    [(-b * d).exp(), seen]
}

fn relative(got: f32, wanted: f64) -> f64 {
    // Below the least f32 there is nothing but 0.
    (f64::from(got) - wanted).abs() / wanted.abs().max(f64::from(f32::MIN_POSITIVE))
}

/// The grid of the hard cases, and finer steps about where the series ends.
fn paths() -> Vec<[f32; 2]> {
    let densities = [0.0, 1e-9, 1e-6, 1e-3, 1.0, 1e3];
    let lengths = [0.0, 1e-6, 1.0, 1e6];
    let grid = densities.into_iter().flat_map(|b| lengths.map(|d| [b, d]));
    let steps = (0..200).map(|i| [1.0, 0.01 * i as f32]);
    grid.chain(steps).collect()
}

#[test]
fn h50_the_gpu_agrees_with_rust_and_with_f64() {
    let paths = paths();
    let (mut from_f64, mut from_rust) = (0.0_f64, 0.0_f64);
    for (path, got) in paths.iter().zip(measure(&paths)) {
        let medium = glowing(path[0]);
        let rust = [
            medium.transmitted(path[1]).x,
            medium.reflected(path[1], Vec3::ZERO).x,
        ];
        for ((got, exact), rust) in got.into_iter().zip(exact(*path)).zip(rust) {
            assert!(got.is_finite(), "{path:?}");
            from_f64 = from_f64.max(relative(got, exact));
            from_rust = from_rust.max(relative(got, f64::from(rust)));
        }
    }
    println!("relative error: {from_f64:.1e} of f64, {from_rust:.1e} of Rust");
    assert!(from_f64 <= 1e-6, "{from_f64}");
    assert!(from_rust <= 1e-6, "{from_rust}");
}

#[test]
fn h34_paths_without_end_are_finite() {
    let paths: Vec<_> = [0.0, 1e-9, 1.0, 1e12]
        .into_iter()
        .flat_map(|b| [0.0, 1e30, f32::MAX, f32::INFINITY].map(|d| [b, d]))
        .collect();
    for (path, [left, seen]) in paths.iter().zip(measure(&paths)) {
        assert!((0.0..=1.0).contains(&left), "{path:?}: {left}");
        assert!(seen.is_finite() && seen >= 0.0, "{path:?}: {seen}");
    }
}
