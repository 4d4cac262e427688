//! ꟻLIP against its own definition and against numbers of the authors' tool, `flip-evaluator`
//! 1.7.

use crate::common::image;
use fluid_reference::{
    Image,
    metrics::{MetricError, PIXELS_PER_DEGREE, flip, mean},
};
use glam::{DVec3, UVec2, dvec3};

fn constant(color: DVec3) -> Image<DVec3> {
    image(32, |_| color)
}

fn error(reference: &Image<DVec3>, test: &Image<DVec3>) -> f64 {
    let map = flip(reference, test, PIXELS_PER_DEGREE).unwrap();
    assert!(map.pixels().iter().all(|e| (0.0..=1.0 + 1e-12).contains(e)));
    mean("FLIP", &map, None).unwrap()
}

fn waves(pixel: UVec2) -> DVec3 {
    let [x, y] = pixel.as_dvec2().to_array();
    dvec3(
        0.5 + 0.5 * (0.3 * x + 0.11 * y).sin(),
        0.5 + 0.5 * (0.23 * y).cos(),
        0.5 + 0.4 * (0.05 * x * 1.7 - 0.4 * y).sin(),
    )
}

/// The same with stripes, a darker half and a disc.
fn changed(size: UVec2, pixel: UVec2) -> DVec3 {
    let p = pixel.as_dvec2();
    let mut c = waves(pixel);
    c.x = c.x * 0.8 + 0.1 * (1.3 * p.x).sin().powi(2);
    if 2 * pixel.x > size.x {
        c.z *= 0.5;
    }
    if (p.x - 20.0).powi(2) + (p.y - 12.0).powi(2) < 30.0 {
        c.y = 1.0 - c.y;
    }
    c
}

#[test]
fn pictures_give_the_errors_of_the_authors_tool() {
    let cases = [
        (
            UVec2::new(48, 32),
            PIXELS_PER_DEGREE,
            [0.484_216, 0.446_897, 0.986_299, 0.087_652],
        ),
        (
            UVec2::new(48, 32),
            20.0,
            [0.428_357, 0.519_212, 0.982_734, 0.057_303],
        ),
        (
            UVec2::new(96, 64),
            PIXELS_PER_DEGREE,
            [0.429_901, 0.446_897, 0.986_186, 0.782_383],
        ),
        (
            UVec2::new(96, 64),
            20.0,
            [0.389_937, 0.519_212, 0.982_734, 0.747_762],
        ),
    ];
    for (size, pixels_per_degree, expected) in cases {
        let reference = Image::from_fn(size, waves);
        let test = Image::from_fn(size, |pixel| changed(size, pixel));
        let map = flip(&reference, &test, pixels_per_degree).unwrap();
        let found = [
            mean("FLIP", &map, None).unwrap(),
            *map.get(UVec2::new(5, 3)),
            *map.get(UVec2::new(20, 12)),
            *map.get(size - 1),
        ];
        for (found, expected) in found.into_iter().zip(expected) {
            // The tool computes in f32.
            assert!((found - expected).abs() < 2e-4, "{found}, not {expected}");
        }
    }
}

#[test]
fn plain_colours_give_the_errors_of_the_authors_tool() {
    let cases = [
        (DVec3::ZERO, DVec3::ONE, 0.967_395),
        (DVec3::Y, DVec3::Z, 1.0),
        (dvec3(0.2, 0.5, 0.7), dvec3(0.25, 0.45, 0.7), 0.254_590),
    ];
    for (a, b, expected) in cases {
        let found = error(&constant(a), &constant(b));
        // The tool computes in f32, with rounded matrices.
        assert!((found - expected).abs() < 5e-5, "{found}, not {expected}");
    }
}

#[test]
fn equal_pictures_have_no_error_and_order_does_not_matter() {
    let size = UVec2::splat(40);
    let [a, b] = [
        Image::from_fn(size, waves),
        Image::from_fn(size, |p| changed(size, p)),
    ];
    assert_eq!(error(&a, &a), 0.0);
    assert!((error(&a, &b) - error(&b, &a)).abs() < 1e-12);
}

#[test]
fn more_difference_is_more_error() {
    let a = image(40, waves);
    let mut last = 0.0;
    for step in 1..=8 {
        let darker = a.map(|c| *c * (1.0 - 0.1 * f64::from(step)));
        let found = error(&a, &darker);
        assert!(found > last, "{found} after {last}");
        last = found;
    }
}

#[test]
fn what_is_too_fine_to_see_counts_less() {
    let grey = constant(DVec3::splat(0.5));
    let stripes = |period: u32| {
        image(32, |pixel| {
            DVec3::splat(if (pixel.x / period).is_multiple_of(2) {
                0.4
            } else {
                0.6
            })
        })
    };
    assert!(error(&grey, &stripes(1)) < error(&grey, &stripes(4)));
}

#[test]
fn bad_pictures_are_errors() {
    let a = constant(DVec3::ONE);
    let smaller = image(31, |_| DVec3::ONE);
    assert!(matches!(
        flip(&a, &smaller, PIXELS_PER_DEGREE),
        Err(MetricError::Size { metric: "FLIP", .. })
    ));
    let hole = image(32, |pixel| {
        if pixel == UVec2::new(3, 1) {
            DVec3::NAN
        } else {
            DVec3::ONE
        }
    });
    assert_eq!(
        flip(&a, &hole, PIXELS_PER_DEGREE),
        Err(MetricError::NotFinite {
            metric: "FLIP",
            index: 35
        })
    );
}
