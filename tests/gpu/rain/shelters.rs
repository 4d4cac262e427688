//! It is dry in and below shelters, however large, many or mobile, and wet everywhere else.

use bevy::math::{DVec2, dvec2};

use super::*;

/// A shelter placed relative to the camera's place.
fn shelter(world: &mut World, center: Vec3, half_size: Vec3) -> Entity {
    let pose = Transform::from_translation(VIEW.pose.translation + center);
    world.spawn((RainShelter { half_size }, pose)).id()
}

/// The means over the pixels for which a test holds, and over the others. It is given the place on
/// the screen, from −1 at the left and below to 1 at the right and above.
fn halves(app: &App, test: impl Fn(DVec2) -> bool) -> [f64; 2] {
    let data = radiance(app);
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for at in common::pixels(data.size) {
        let place = (at.as_dvec2() + 0.5) / data.size.as_dvec2() * 2.0 - 1.0;
        let half = usize::from(!test(place * dvec2(1.0, -1.0)));
        sums[half] += f64::from(data.f16x4(at.x, at.y)[1]);
        counts[half] += 1.0;
    }
    [sums[0] / counts[0], sums[1] / counts[1]]
}

/// Near one end of a hall of 200 m, eight sheds are nearer than the hall's centre.
#[test]
fn it_is_dry_in_a_hall_beside_eight_sheds() {
    for (extent, method) in [
        (0.0, RainMethod::Streaks),
        (0.0, RainMethod::PerDrop),
        // Beyond the streaks too.
        (15.0, RainMethod::Streaks),
    ] {
        let rain = Rain {
            extent,
            method,
            ..white_rain(50.0, 4.0)
        };
        let mut app = show_plain(rain);
        assert!(mean(&radiance(&app)) > 1e-3);
        let world = app.world_mut();
        shelter(world, vec3(80.0, 0.0, 0.0), vec3(100.0, 12.0, 20.0));
        for i in 0..8 {
            shelter(world, vec3(-5.0 + i as f32, 0.0, 25.0), Vec3::ONE);
        }
        settle(&mut app).unwrap();
        assert_eq!(mean(&radiance(&app)), 0.0, "{extent}, {method:?}");
    }
}

/// Twelve houses of two boxes and an awning each, wall to wall along both sides of the view, keep
/// all of it dry; without one of them it rains there.
#[test]
fn every_house_of_a_street_counts() {
    let mut app = show_plain(white_rain(50.0, 6.0));
    // Each covers 0.6 m of the view from left to right, above all that is seen.
    let houses: Vec<_> = (0..12)
        .map(|house| {
            let x = 0.6 * house as f32 - 3.3;
            [-1.0, -3.0, -5.0]
                .map(|z| shelter(app.world_mut(), vec3(x, 6.0, z), vec3(0.301, 1.0, 1.05)))
        })
        .collect();
    settle(&mut app).unwrap();
    assert_eq!(mean(&radiance(&app)), 0.0);
    // The fifth from the left.
    app.world_mut().despawn(houses[4][1]);
    settle(&mut app).unwrap();
    let [left, right] = halves(&app, |at| at.x < 0.0);
    assert!(left > 1e-3 && right == 0.0, "{left}, {right}");
}

/// The rain beyond the streaks lacks what is dry, once where dry places overlap.
#[test]
fn far_rain_lacks_the_stretch_below_roofs() {
    let rain = Rain {
        extent: 100.0,
        ..white_rain(200.0, 1.0)
    };
    for lens in [
        VIEW.lens,
        Lens::Orthographic {
            height: 2.0,
            near: 0.0,
            far: 200.0,
        },
    ] {
        let view = View { lens, ..VIEW };
        let mut app = show(&view, rain, 1.0 / 60.0, |_| {});
        // Where the view's middle looks, nothing else differs.
        let depth = |app: &App| {
            let data = radiance(app);
            -(1.0 - f64::from(data.f16x4(80, 60)[1])).ln() / extinction(200.0)
        };
        let wet = depth(&app);
        let mut roof = |start: f32, end: f32| {
            let center = vec3(3.0, 20.0, -0.5 * (start + end));
            let half_size = vec3(50.0, 0.1, 0.5 * (end - start));
            shelter(app.world_mut(), center, half_size);
            settle(&mut app).unwrap();
            wet - depth(&app)
        };
        for (start, end, expected) in [
            (20.0, 50.0, 30.0),
            // Overlaps it.
            (40.0, 60.0, 40.0),
            // Within both.
            (45.0, 48.0, 40.0),
            // As far as it rains.
            (90.0, 300.0, 50.0),
        ] {
            let dry = roof(start, end);
            println!("{lens:?}: {start}..{end} m: {dry:.2} m dry");
            assert!((dry - expected).abs() < 1.0, "{dry} instead of {expected}");
        }
    }
}

/// A deck that heaves and rolls with its ship, frame by frame: dry below, wet above.
#[test]
fn it_is_dry_below_a_deck_that_moves_and_wet_above() {
    // Streaks as short as drops.
    let mut app = show(&VIEW, white_rain(50.0, 6.0), 1.0 / 2000.0, |_| {});
    let at = VIEW.pose.translation;
    let ship = app
        .world_mut()
        .spawn((Transform::from_translation(at), Visibility::default()))
        .id();
    let deck = app
        .world_mut()
        .spawn(RainShelter {
            half_size: vec3(50.0, 0.01, 50.0),
        })
        .id();
    app.world_mut().entity_mut(ship).add_child(deck);
    settle(&mut app).unwrap();
    let mut mean_below = |height: f32, roll: f32| {
        let mut pose = app.world_mut().get_mut::<Transform>(ship).unwrap();
        pose.translation = at + height * Vec3::Y;
        pose.rotation = Quat::from_rotation_z(roll);
        // The picture of the frame in which it has moved.
        step(&mut app, 1);
        // Apart from drops at the border.
        let slope = f64::from(roll.tan());
        let aspect = f64::from(VIEW.size.x) / f64::from(VIEW.size.y);
        let below = halves(&app, |at| at.y < slope * at.x * aspect - 0.1)[0];
        let above = halves(&app, |at| at.y > slope * at.x * aspect + 0.1)[0];
        (below, above)
    };
    for roll in [0.0, 0.3, -0.5] {
        let (below, above) = mean_below(0.0, roll);
        let is_split = below < 0.02 * above && above > 1e-3;
        assert!(is_split, "{roll}: {below}, {above}");
    }
    let (below, above) = mean_below(4.0, 0.0);
    assert_eq!((below, above), (0.0, 0.0), "all is below");
    let (below, above) = mean_below(-4.0, 0.0);
    assert!(below > 1e-3 && above > 1e-3, "all is above");
}
