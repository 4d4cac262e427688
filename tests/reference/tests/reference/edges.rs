//! Antialiasing, measured on edges whose coverage is known.

use crate::common::image;
use fluid_reference::{
    Image,
    metrics::{
        Edges, Front, MetricError, decode_srgb, encode_srgb, mean_difference, share_off, sharpness,
    },
    pixel_samples,
};
use glam::{DVec2, DVec3, UVec2};

const SIDE: u32 = 32;

/// Liquid on the left of a line that is a little turned: what a pixel is covered by, from so many
/// samples of it.
fn half_plane(samples: u32) -> Image<f64> {
    let normal = DVec2::new(0.96, 0.28);
    image(SIDE, |pixel| {
        let middle = DVec2::splat(f64::from(SIDE) / 2.0 + 0.3);
        let within = |at: &DVec2| (pixel.as_dvec2() + *at - middle).dot(normal) < 0.0;
        pixel_samples(samples).filter(within).count() as f64 / f64::from(samples)
    })
}

fn grey(of: &Image<f64>) -> Image<DVec3> {
    of.map(|value| encode_srgb(DVec3::splat(*value)))
}

/// Nothing is within reach of a step.
fn flat(coverage: &Image<f64>) -> Image<Option<Front>> {
    let front = Front {
        view_depth: 3.0,
        droplet: false,
    };
    coverage.map(|covered| (*covered >= 0.5).then_some(front))
}

#[test]
fn samples_of_a_pixel_lie_in_it_evenly() {
    let samples: Vec<DVec2> = pixel_samples(64).collect();
    let mean = samples.iter().sum::<DVec2>() / 64.0;
    assert!((mean - 0.5).abs().max_element() < 0.01, "{mean}");
    for (i, row) in (0..8).flat_map(|i| (0..8).map(move |row| (i, row))) {
        let cell = DVec2::new(f64::from(i), f64::from(row)) / 8.0;
        let inside =
            |at: &&DVec2| (**at - cell).min_element() >= 0.0 && (**at - cell).max_element() < 0.125;
        let count = samples.iter().filter(inside).count();
        assert!((0..=2).contains(&count), "{count} in {cell}");
    }
    assert!(
        samples
            .iter()
            .all(|at| at.min_element() >= 0.0 && at.max_element() < 1.0)
    );
}

#[test]
fn samples_find_an_edges_coverage() {
    let exact = half_plane(4096);
    let few = half_plane(64);
    let pairs = exact.pixels().iter().zip(few.pixels());
    let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 0.04, "{worst}");
}

#[test]
fn parts_of_a_half_plane_share_no_pixel_and_hold_all() {
    let coverage = half_plane(64);
    let edges = Edges::new(&coverage, &flat(&coverage), 0.1);
    let masks = [&edges.outer, &edges.inner, &edges.inside, &edges.beside];
    for index in 0..(SIDE * SIDE) as usize {
        let held = masks.iter().filter(|mask| mask.pixels()[index]).count();
        assert_eq!(held, 1);
    }
    let count = |mask: &Image<bool>| mask.pixels().iter().filter(|is| **is).count();
    // About three pixels wide, on both sides of the line.
    let width = count(&edges.outer) as f64 / f64::from(SIDE);
    assert!((3.0..4.5).contains(&width), "{width}");
    let covered = |is: &dyn Fn(f64) -> bool| {
        let mask = edges.outer.pixels().iter().zip(coverage.pixels());
        mask.filter(|(outer, c)| **outer && is(**c)).count()
    };
    assert!(covered(&|c| c == 0.0) > 20 && covered(&|c| c == 1.0) > 20);
    assert_eq!(count(&edges.inner), 0);
    assert_eq!(
        count(&edges.liquid()),
        count(&edges.outer) + count(&edges.inside)
    );
}

#[test]
fn inner_edges_are_steps_and_outlines_of_droplets_but_no_slopes() {
    let whole = image(SIDE, |_| 1.0);
    let inner = |front: &(dyn Fn(UVec2) -> Front + Sync)| {
        let fronts = image(SIDE, |pixel| Some(front(pixel)));
        let edges = Edges::new(&whole, &fronts, 0.1);
        assert!(!edges.outer.pixels().contains(&true));
        (0..SIDE)
            .filter(|&x| *edges.inner.get(UVec2::new(x, 9)))
            .collect::<Vec<_>>()
    };
    let at = |view_depth, droplet| Front {
        view_depth,
        droplet,
    };
    let step = |height| inner(&|pixel| at(if pixel.x < 16 { 3.0 } else { 3.0 + height }, false));
    assert_eq!(step(0.11), [14, 15, 16, 17]);
    assert!(step(0.09).is_empty());
    assert!(inner(&|pixel| at(3.0 + 0.2 * f64::from(pixel.x), false)).is_empty());
    assert_eq!(inner(&|pixel| at(3.0, pixel.x < 5)), [3, 4, 5, 6]);
}

#[test]
fn stairs_are_off_by_what_they_should_have_been_covered() {
    let truth = half_plane(4096);
    let stairs = truth.map(|covered| covered.round());
    let coverage = Edges::new(&truth, &flat(&truth), 0.1);
    let (a, b) = (grey(&stairs), grey(&truth));
    let outer = Some(&coverage.outer);
    // A pixel of the edge is off by its coverage or the rest of it, encoded.
    let mut expected = (0.0, 0, 0);
    for (covered, outer) in truth.pixels().iter().zip(coverage.outer.pixels()) {
        let encoded = encode_srgb(DVec3::splat(*covered)).x;
        let off = (encoded - covered.round()).abs();
        expected.0 += off;
        expected.1 += u32::from(off > 0.2);
        expected.2 += u32::from(*outer);
    }
    let count = f64::from(expected.2);
    let mean = mean_difference(&a, &b, outer).unwrap();
    assert!((mean - expected.0 / count).abs() < 1e-12, "{mean}");
    let share = share_off(&a, &b, 0.2, outer).unwrap();
    assert!(share > 0.1 && (share - f64::from(expected.1) / count).abs() < 1e-12);
    let inside = Some(&coverage.inside);
    assert_eq!(mean_difference(&a, &b, inside).unwrap(), 0.0);
    assert_eq!(share_off(&a, &b, 0.2, inside).unwrap(), 0.0);
}

#[test]
fn a_blurred_picture_is_less_sharp_and_noise_more() {
    let wave = |x: f64| DVec3::splat(0.5 + 0.4 * x.sin());
    let truth = image(SIDE, |pixel| wave(0.7 * f64::from(pixel.x)));
    let of = |picture: &Image<DVec3>| sharpness(picture, &truth, None).unwrap();
    assert_eq!(of(&truth), 1.0);
    // A blur over three pixels weakens this wave to a known part.
    let blurred = image(SIDE, |pixel| {
        let x = f64::from(pixel.x);
        [-0.7, 0.0, 0.7]
            .map(|d| wave(0.7 * x + d))
            .iter()
            .sum::<DVec3>()
            / 3.0
    });
    let weaker = (1.0 + 2.0 * 0.7_f64.cos()) / 3.0;
    assert!((of(&blurred) - weaker * weaker).abs() < 1e-9);
    // A picture moved by a pixel is as sharp, though it is off.
    let moved = image(SIDE, |pixel| wave(0.7 * f64::from(pixel.x) + 0.7));
    assert!((of(&moved) - 1.0).abs() < 0.05);
    assert!(mean_difference(&moved, &truth, None).unwrap() > 0.1);
    let noisy = image(SIDE, |pixel| {
        let sign = if (pixel.x + pixel.y).is_multiple_of(2) {
            0.1
        } else {
            -0.1
        };
        *truth.get(pixel) + sign
    });
    assert!(of(&noisy) > 1.2);
    // Only pairs that both count.
    let one = image(SIDE, |pixel| pixel == UVec2::splat(3));
    let error = sharpness(&truth, &truth, Some(&one)).unwrap_err();
    assert_eq!(
        error,
        MetricError::Empty {
            metric: "sharpness"
        }
    );
}

#[test]
fn values_that_are_no_numbers_are_named() {
    let good = image(4, |_| DVec3::ZERO);
    let bad = image(4, |pixel| {
        DVec3::splat(if pixel.x == 2 { f64::NAN } else { 0.0 })
    });
    let errors = [
        mean_difference(&good, &bad, None),
        share_off(&good, &bad, 0.1, None),
        sharpness(&bad, &good, None),
    ];
    for error in errors {
        assert!(
            matches!(error, Err(MetricError::NotFinite { .. })),
            "{error:?}"
        );
    }
}

#[test]
fn encoding_has_an_inverse() {
    for i in 0..=100 {
        let linear = DVec3::splat(f64::from(i) / 100.0);
        assert!(
            (decode_srgb(encode_srgb(linear)) - linear)
                .abs()
                .max_element()
                < 1e-7
        );
    }
}
