//! The marched differential equation against its closed form.

use fluid_reference::medium::{Medium, march};
use glam::{DVec3, dvec3};

const BEHIND: DVec3 = dvec3(0.7, 0.2, 1.5);

fn fog() -> Medium {
    Medium::new(
        [0.8, 1.5],
        [dvec3(0.9, 0.5, 0.1), dvec3(0.2, 1.0, 0.6)],
        dvec3(0.3, 0.0, 2.0),
    )
}

fn relative(got: DVec3, wanted: DVec3) -> f64 {
    ((got - wanted) / wanted).abs().max_element()
}

#[test]
fn it_converges_to_the_closed_form_with_the_fourth_power() {
    let medium = fog();
    let error = |steps| {
        let marched = march(|_| medium, 3.0, BEHIND, steps);
        relative(marched, medium.through(3.0, BEHIND))
    };
    let ratios = [8, 16, 32, 64].map(|steps| error(steps) / error(2 * steps));
    for ratio in ratios {
        assert!((14.0..24.0).contains(&ratio), "{ratios:?}");
    }
    assert!(error(2000) < 1e-13, "{}", error(2000));
}

#[test]
fn media_of_each_kind_alone_do_what_they_are_for() {
    let white = [DVec3::ONE, DVec3::ONE];
    for (medium, wanted) in [
        (Medium::NONE, BEHIND),
        // Towards its colour.
        (Medium::new([50.0, 0.0], white, DVec3::ZERO), DVec3::ONE),
        // Towards black.
        (
            Medium::new([0.0, 50.0], [DVec3::ONE, DVec3::ZERO], DVec3::ZERO),
            DVec3::ZERO,
        ),
        // Brighter with every metre.
        (
            Medium::new([0.0, 7.0], white, dvec3(1.0, 2.0, 3.0)),
            BEHIND + 2.0 * dvec3(1.0, 2.0, 3.0),
        ),
    ] {
        for got in [
            medium.through(2.0, BEHIND),
            march(|_| medium, 2.0, BEHIND, 1000),
        ] {
            assert!(
                (got - wanted).abs().max_element() < 1e-12,
                "{got}, not {wanted}"
            );
        }
    }
}

#[test]
fn h50_thin_and_short_and_deep_media_agree() {
    for density in [0.0, 1e-9, 1e-6, 1e-3, 1.0, 1e3] {
        for length in [0.0, 1e-6, 1.0] {
            let medium = Medium {
                source: dvec3(1.0, 0.5, 2.0),
                extinction: DVec3::splat(density),
            };
            let wanted = medium.through(length, BEHIND);
            let error = relative(march(|_| medium, length, BEHIND, 20_000), wanted);
            assert!(error < 1e-6, "{density} {length}: {error}");
        }
    }
}

#[test]
fn two_puffs_and_the_gap_between_them_compose() {
    // Fog from 0.5 to 1 m and from 2 to 3 m; steps end at the borders.
    let at = |t: f64| {
        if (0.5..1.0).contains(&t) || (2.0..3.0).contains(&t) {
            fog()
        } else {
            Medium::NONE
        }
    };
    // The borders themselves are no length: a step that starts on one would see both sides.
    let marched = march(at, 4.0, BEHIND, 400_000);
    let wanted = fog().through(0.5, fog().through(1.0, BEHIND));
    assert!(relative(marched, wanted) < 1e-5, "{marched}, not {wanted}");
    // Were the gap full, it would be another picture.
    let full = fog().through(2.5, BEHIND);
    assert!(relative(full, wanted) > 0.05);
}

#[test]
fn density_that_changes_smoothly_is_as_its_mean() {
    // Where all of the medium thins alike, only the whole depth counts.
    let at = |t: f64| {
        let share = (std::f64::consts::PI * t / 2.0).sin().powi(2);
        Medium {
            source: share * fog().source,
            extinction: share * fog().extinction,
        }
    };
    let marched = march(at, 2.0, BEHIND, 2000);
    let wanted = fog().through(1.0, BEHIND);
    assert!(relative(marched, wanted) < 1e-9, "{marched}, not {wanted}");
}
