//! That pictures through other places of their pixels are what they should be.

use bevy::math::{DVec2, DVec3, UVec2, dvec2, uvec2};
use fluid_reference::Image;

use super::truth::{supersample, unfiltered};
use crate::{methods, rig::Rig, scenes};

fn rig(size: &str) -> (scenes::Scene, Rig) {
    let out = std::env::temp_dir();
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

/// The mean over its jitters of a picture whose pixels are a quarter as wide and high is that of a
/// pixel's quarters.
#[test]
fn the_mean_shows_edges_by_their_coverage() {
    let (scene, mut rig) = rig("160x120");
    let mean = supersample(&mut rig, &scene.camera, 64).unwrap();
    let fronts = rig.fronts().unwrap();
    let partial = mean.coverage.pixels().iter();
    let partial = partial.filter(|c| **c > 0.0 && **c < 1.0).count();
    assert!(partial > 100, "{partial}");
    // The liquid's area is the same, seen either way.
    let area: f64 = mean.coverage.pixels().iter().sum();
    let whole = fronts.pixels().iter().flatten().count() as f64;
    assert!((area / whole - 1.0).abs() < 0.01, "{area} of {whole}");
    // The sky and the floor are the same, but for the squares' edges.
    let corner = *mean.image.get(uvec2(2, 2));
    assert!(corner.is_finite() && corner.min_element() > 0.0);
}
