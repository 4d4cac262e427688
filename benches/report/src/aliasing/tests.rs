//! That pictures through other places of their pixels are what they should be.

use bevy::math::{DVec2, DVec3, UVec2, dvec2, uvec2};
use fluid_reference::{Image, metrics::decode_srgb};

use super::truth::{supersample, unfiltered};
use crate::{methods, rig::Rig, scenes};

fn rig(size: &str) -> (scenes::Scene, Rig) {
    // Each test's own: options write to it to see whether they may.
    let test = std::thread::current();
    let test = test.name().unwrap_or("test").replace("::", "-");
    let out = std::env::temp_dir().join(format!("{test}-{}", std::process::id()));
    let words = ["aliasing", "--size", size, "--out"].map(std::ffi::OsString::from);
    let options = crate::Options::parse_from(words.into_iter().chain([out.into()])).unwrap();
    let scene = scenes::make(&options, "cube-top").unwrap().unwrap();
    let mut rig = Rig::new(&scene).unwrap();
    rig.show(&unfiltered(&methods::default())).unwrap();
    (scene, rig)
}

/// Share of the pixels that are as those of another picture some pixels away, of those that have
/// such.
fn alike(a: &Image<DVec3>, b: &Image<DVec3>, away: UVec2) -> f64 {
    let inner = a.size() - away;
    let same = Image::from_fn(inner, |pixel| {
        (*a.get(pixel) - *b.get(pixel + away)).abs().max_element() < 0.03
    });
    let alike = same.pixels().iter().filter(|same| **same).count();
    alike as f64 / same.pixels().len() as f64
}

/// Both what is opaque and the liquid: its layers, what it refracts and what it reflects.
#[test]
fn a_picture_through_places_a_pixel_away_is_the_picture_a_pixel_away() {
    let (scene, mut rig) = rig("160x120");
    let middle = rig.picture().unwrap();
    let mut picture = |off| {
        rig.aim(&scene.camera, off);
        rig.frame();
        rig.picture().unwrap()
    };
    for (off, away) in [(dvec2(1.0, 0.0), UVec2::X), (dvec2(0.0, 1.0), UVec2::Y)] {
        let moved = picture(off);
        assert!(
            alike(&moved, &middle, UVec2::ZERO) < 0.9,
            "{off} moves something"
        );
        let share = alike(&moved, &middle, away);
        assert!(share > 0.99, "{off}: {share}");
    }
    assert_eq!(picture(DVec2::ZERO).pixels(), middle.pixels());
}

/// Edges that move by a part of a pixel change pixels by that part of what a whole one does.
#[test]
fn a_wall_moves_by_the_part_of_a_pixel_that_is_asked_for() {
    let (scene, mut rig) = rig("160x120");
    let middle = rig.picture().unwrap();
    let mut change = |off| {
        rig.aim(&scene.camera, off);
        rig.frame();
        let moved = rig.picture().unwrap();
        // Above the liquid.
        let wall = Image::from_fn(uvec2(160, 24), |pixel| {
            let [a, b] = [&moved, &middle].map(|picture| decode_srgb(*picture.get(pixel)).y);
            (a - b).abs()
        });
        wall.pixels().iter().sum::<f64>()
    };
    for axis in [DVec2::X, DVec2::Y] {
        let whole = change(axis);
        for part in [-0.25, 0.25, 0.5] {
            let share = change(axis * part) / whole;
            assert!(
                (share - part.abs()).abs() < 0.03,
                "{share} for {part} of {axis}"
            );
        }
    }
}

/// What is covered in part lies where the outline is, and all parts together are as large as the
/// liquid.
#[test]
fn the_mean_shows_edges_by_their_coverage() {
    let (scene, mut rig) = rig("160x120");
    let whole = rig.fronts().unwrap();
    let whole = whole.map(|front| f64::from(front.is_some()));
    let mean = supersample(&mut rig, &scene.camera, 64).unwrap();
    let pairs = mean.coverage.pixels().iter().zip(whole.pixels());
    let partial = |(mean, whole): &(&f64, &f64)| mean != whole;
    let edge = pairs.clone().filter(partial).count() as f64;
    // An outline is about as long as the box around it, and crosses a pixel or two on each pixel.
    assert!((300.0..1200.0).contains(&edge), "{edge}");
    let [mean, whole] = [&mean.coverage, &whole].map(|image| image.pixels().iter().sum::<f64>());
    assert!((mean / whole - 1.0).abs() < 0.005, "{mean} of {whole}");
    // Of one sample, it is the picture itself.
    let one = supersample(&mut rig, &scene.camera, 1).unwrap();
    let drawn = rig.picture().unwrap();
    let pairs = one.image.pixels().iter().zip(drawn.pixels());
    let worst = pairs.map(|(a, b)| (*a - *b).abs().max_element());
    assert!(worst.fold(0.0, f64::max) < 1e-6);
}
