//! Each metric on a pair whose answer is known.

use crate::common::image;
use fluid_reference::{
    Camera, Image, Lens, Span, layers,
    metrics::{
        MetricError, Quantiles, Regions, Search, Status, depth_error, encode_srgb, furnace_error,
        mean, normal_error, psnr, search_report, silhouette_iou, ssim,
    },
    surface::{HalfSpace, Sphere},
};
use glam::{DQuat, DVec3, UVec2, dvec3};

#[test]
fn quantiles_of_a_hundred_and_one_values() {
    let values = (0..=100).rev().map(f64::from);
    let found = Quantiles::of("test", values).unwrap();
    let expected = Quantiles {
        count: 101,
        mean: 50.0,
        p50: 50.0,
        p95: 95.0,
        max: 100.0,
    };
    assert_eq!(found, expected);
    assert_eq!(Quantiles::of("test", [1.0, 2.0]).unwrap().p50, 1.5);
}

#[test]
fn values_that_are_no_numbers_are_named() {
    for bad in [f64::NAN, f64::INFINITY] {
        let error = Quantiles::of("depth", [1.0, bad]).unwrap_err();
        assert_eq!(error.to_string(), "depth: value 1 is not finite");
    }
    let error = Quantiles::of("depth", []).unwrap_err();
    assert_eq!(error, MetricError::Empty { metric: "depth" });
}

#[test]
fn depth_errors_are_split_into_offset_and_roughness() {
    let truth = image(10, |pixel| (pixel.x < 8).then_some(3.0));
    // Farther by half a radius, and bumpy by a quarter.
    let measured = image(10, |pixel| {
        let bump = if pixel.y % 2 == 0 { 0.05 } else { -0.05 };
        (pixel.x > 1).then_some(3.1 + bump)
    });
    let found = depth_error(&measured, &truth, None, 0.2).unwrap();
    assert_eq!(found.absolute.count, 60);
    assert!((found.offset - 0.5).abs() < 1e-12);
    assert!((found.roughness - 0.25).abs() < 1e-12);
    assert!((found.rmse - 0.5_f64.hypot(0.25)).abs() < 1e-12);
    assert!((found.absolute.max - 0.75).abs() < 1e-12);

    let even = image(10, |pixel| pixel.y % 2 == 0);
    let masked = depth_error(&measured, &truth, Some(&even), 0.2).unwrap();
    assert!((masked.offset - 0.75).abs() < 1e-12 && masked.roughness < 1e-12);
    assert_eq!(masked.absolute.count, 30);

    let holed = measured.map(|depth| depth.map(|_| f64::NAN));
    let error = depth_error(&holed, &truth, None, 0.2).unwrap_err();
    assert!(matches!(
        error,
        MetricError::NotFinite {
            metric: "depth error",
            ..
        }
    ));
    let other = image(9, |_| Some(1.0));
    let error = depth_error(&other, &truth, None, 0.2).unwrap_err();
    assert!(matches!(error, MetricError::Size { .. }));
}

#[test]
fn normal_errors_are_degrees() {
    let truth = image(10, |_| Some(DVec3::Z));
    let turned = image(10, |pixel| {
        let degrees = f64::from(pixel.y * 10 + pixel.x);
        Some(DQuat::from_rotation_x(degrees.to_radians()) * DVec3::Z)
    });
    let found = normal_error(&turned, &truth, None).unwrap();
    assert!((found.p50 - 49.5).abs() < 1e-9 && (found.max - 99.0).abs() < 1e-9);
    let tiny = turned.map(|_| Some(dvec3(1e-9, 0.0, 1.0)));
    let found = normal_error(&tiny, &truth, None).unwrap();
    assert!((found.max - 1e-9_f64.to_degrees()).abs() < 1e-20);
    let zero = turned.map(|_| Some(DVec3::ZERO));
    assert!(normal_error(&zero, &truth, None).is_err());
}

#[test]
fn outlines_that_overlap_by_a_third() {
    let [a, b] = [0, 4].map(|start| image(16, |pixel| (start..start + 8).contains(&pixel.x)));
    assert_eq!(silhouette_iou(&a, &b).unwrap(), 1.0 / 3.0);
    assert_eq!(silhouette_iou(&a, &a).unwrap(), 1.0);
    let none = image(16, |_| false);
    assert_eq!(silhouette_iou(&none, &a).unwrap(), 0.0);
    assert_eq!(silhouette_iou(&none, &none).unwrap(), 1.0);
}

#[test]
fn searches_are_counted_and_measured() {
    let at = |status, x: f64, truth: Option<f64>| Search {
        status,
        position: DVec3::X * x,
        truth: truth.map(|x| DVec3::X * x),
    };
    let searches = [
        at(Status::Hit, 1.0, Some(1.0)),
        at(Status::Hit, 1.2, Some(1.0)),
        at(Status::TotalReflection, 1.4, Some(1.0)),
        at(Status::Hit, 1.0, None),
        at(Status::LeftLayer, f64::NAN, Some(1.0)),
        at(Status::NoBracket, 0.0, None),
    ];
    let report = search_report(&searches, 0.1).unwrap();
    assert_eq!(report.counts, [0, 3, 1, 1, 0, 1, 0, 0]);
    assert_eq!((report.missed, report.invented), (1, 1));
    assert_eq!(report.rate(Status::Hit), 0.5);
    let error = report.error.unwrap();
    assert!((error.max - 4.0).abs() < 1e-12 && (error.p50 - 2.0).abs() < 1e-12);
    assert_eq!(error.count, 3);
    let lost = [at(Status::Hit, f64::NAN, Some(1.0))];
    assert!(search_report(&lost, 0.1).is_err());
    assert_eq!(search_report(&[], 0.1).unwrap().error, None);
}

#[test]
fn a_furnace_shows_light_that_is_made_or_lost() {
    let radiance = image(4, |_| dvec3(0.25, 0.5, 0.0));
    let transmission = image(4, |pixel| {
        dvec3(0.75, 0.5, if pixel.x == 0 { 0.9 } else { 1.0 })
    });
    let found = furnace_error(&radiance, &transmission, None).unwrap();
    assert!((found.max - 0.1).abs() < 1e-12 && (found.mean - 0.025).abs() < 1e-12);
    let hole = radiance.map(|_| dvec3(0.0, f64::NAN, 0.0));
    assert!(furnace_error(&hole, &transmission, None).is_err());
}

#[test]
fn psnr_of_a_tenth_is_twenty_decibels() {
    let a = image(8, |_| DVec3::splat(0.4));
    let b = image(8, |_| DVec3::splat(0.5));
    assert!((psnr(&a, &b, None).unwrap() - 20.0).abs() < 1e-9);
    assert_eq!(psnr(&a, &a, None).unwrap(), f64::INFINITY);
    // A mask that leaves out what differs.
    let half = image(8, |pixel| DVec3::splat(if pixel.x < 4 { 0.4 } else { 0.5 }));
    let left = image(8, |pixel| pixel.x < 4);
    assert_eq!(psnr(&a, &half, Some(&left)).unwrap(), f64::INFINITY);
    let none = image(8, |_| false);
    assert!(matches!(
        psnr(&a, &half, Some(&none)),
        Err(MetricError::Empty { .. })
    ));
}

#[test]
fn ssim_of_plain_pictures_and_of_opposites() {
    // Windows that lie inside the picture.
    let inner = image(24, |pixel| {
        pixel.min_element() >= 5 && pixel.max_element() < 19
    });
    let average = |a: &Image<DVec3>, b: &Image<DVec3>| {
        mean("SSIM", &ssim(a, b).unwrap(), Some(&inner)).unwrap()
    };
    // No structure: only the term of the means is left.
    let [a, b] = [0.3, 0.7].map(|grey| image(24, |_| DVec3::splat(grey)));
    let expected = (2.0 * 0.3 * 0.7 + 1e-4) / (0.3 * 0.3 + 0.7 * 0.7 + 1e-4);
    assert!((average(&a, &b) - expected).abs() < 1e-9);
    let stripes = |sign: f64| {
        image(24, |pixel| {
            DVec3::splat(if pixel.x % 2 == 0 {
                0.5 + sign
            } else {
                0.5 - sign
            })
        })
    };
    assert!((average(&stripes(0.4), &stripes(0.4)) - 1.0).abs() < 1e-12);
    // The same means, opposite structure: (C₂ − 2σ²) / (C₂ + 2σ²).
    let expected = (9e-4 - 0.32) / (9e-4 + 0.32);
    let opposite = average(&stripes(0.4), &stripes(-0.4));
    assert!(
        (opposite - expected).abs() < 1e-3,
        "{opposite}, not {expected}"
    );
    // Less contrast is less alike.
    let [weak, weaker] = [0.2, 0.1].map(|c| average(&stripes(0.4), &stripes(c)));
    assert!(1.0 > weak && weak > weaker);
    assert!(ssim(&a, &image(24, |_| DVec3::NAN)).is_err());
}

#[test]
fn srgb_is_encoded_as_the_standard_says() {
    let encoded = encode_srgb(dvec3(0.002, 0.214_041_14, 2.0));
    assert!(
        encoded.distance(dvec3(0.025_84, 0.5, 1.0)) < 1e-7,
        "{encoded}"
    );
}

const LENS: Lens = Lens::Orthographic {
    height: 2.0,
    near: 0.0,
    far: 10.0,
};

#[test]
fn regions_share_no_pixel_and_leave_none_of_the_liquid_out() {
    let camera = Camera::new(UVec2::splat(100), LENS);
    let ball = Sphere {
        center: dvec3(0.0, 0.0, -3.0),
        radius: 0.8,
    };
    let truth = layers(&camera, &ball);
    let regions = Regions::new(&camera, &truth, 3, 0.5, 0.5);
    for y in 0..100 {
        for x in 0..100 {
            let pixel = UVec2::new(x, y);
            let at =
                [&regions.interior, &regions.silhouette, &regions.grazing].map(|m| *m.get(pixel));
            let count = at.iter().filter(|there| **there).count();
            assert!(count <= 1);
            assert!(count == 1 || truth.get(pixel).is_none());
            let sine = (pixel.as_dvec2() - 49.5).length() * 0.02 / 0.8;
            // Cosine below ½ from a sine of 0.866 on; the band is 3 pixels or 0.075 wide, along
            // the diagonals 1.4 times that.
            let expected = match sine {
                ..0.86 => Some([true, false, false]),
                0.875..0.88 => Some([false, false, true]),
                0.99..1.0 => Some([false, true, false]),
                1.15.. => Some([false; 3]),
                _ => None,
            };
            if let Some(expected) = expected {
                assert_eq!(at, expected, "sine {sine}");
            }
        }
    }
}

#[test]
fn an_outline_before_liquid_is_an_outline_too() {
    let camera = Camera::new(UVec2::splat(20), LENS);
    let spans = |far: f64| {
        let truth = layers(
            &camera,
            &HalfSpace {
                point: DVec3::ZERO,
                normal: DVec3::Z,
            },
        );
        assert!(
            truth.pixels().iter().all(Option::is_none),
            "unbounded bodies have no back"
        );
        let ball = Sphere {
            center: DVec3::NEG_Z * 5.0,
            radius: 4.0,
        };
        let spans = layers(&camera, &ball);
        Image::from_fn(camera.size, |pixel| {
            spans.get(pixel).map(|mut span: Span| {
                span.front.view_depth += if pixel.x < 10 { 0.0 } else { far };
                span
            })
        })
    };
    let count = |far| {
        let regions = Regions::new(&camera, &spans(far), 2, 0.5, 0.1);
        regions
            .silhouette
            .pixels()
            .iter()
            .filter(|there| **there)
            .count()
    };
    assert_eq!(count(0.0), 0);
    // Two columns to either side.
    assert_eq!(count(1.0), 80);
}
