//! How much light rain takes, and which way its streaks lean.

use super::*;

/// The mean transmittance over a length L is e^(−βL), whatever the exposure. It is the
/// exponent that is compared: transmittances are all near 1.
#[test]
fn rain_takes_as_much_light_as_its_drops() {
    for exposure in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0] {
        let mut app = show(&VIEW, white_rain(1.0, 10.0), exposure, |_| {});
        for rate in [1.0, 5.0, 10.0, 20.0] {
            set_rain(&mut app, white_rain(rate, 10.0));
            let depth = optical_depth(&mut app, 40);
            let ratio = depth / (extinction(f64::from(rate)) * 10.0);
            println!("{rate} mm/h, 1/{:.0} s: {ratio:.4}", 1.0 / exposure);
            assert!(
                (ratio - 1.0).abs() < 0.03,
                "{rate} mm/h at {exposure} s: {ratio}"
            );
        }
    }
}

#[test]
fn drops_one_by_one_take_as_much() {
    for wind in [Vec2::ZERO, vec2(6.0, -5.0)] {
        let rain = Rain {
            method: RainMethod::PerDrop,
            wind,
            ..white_rain(10.0, 4.0)
        };
        let mut app = show_plain(rain);
        // Streaks that reach nearer than the near plane are left out: half of the way that wind takes
        // them along the view, on average over its directions, comes on top of it.
        let approach = f64::from(wind.length()) / 60.0 * core::f64::consts::FRAC_2_PI;
        let way = 4.0 - 0.05 - 0.5 * approach;
        let drawn = extinction_between(10.0, SMALLEST, LARGEST) * way;
        let ratio = optical_depth(&mut app, 96) / drawn;
        println!("{wind}: {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.03, "{wind}: {ratio}");
    }
}

/// Also where voxels are of several sizes, and where rain leans.
#[test]
fn distance_and_wind_change_nothing_of_it() {
    for (distance, wind) in [
        (3.0, Vec2::ZERO),
        (30.0, Vec2::ZERO),
        (10.0, vec2(4.0, -3.0)),
    ] {
        let rain = Rain {
            wind,
            ..white_rain(10.0, distance)
        };
        let mut app = show_plain(rain);
        let ratio = optical_depth(&mut app, 24) / (extinction(10.0) * f64::from(distance));
        println!("{distance} m, {wind}: {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.04, "{distance} m, {wind}: {ratio}");
    }
}

/// Streaks of drops near the eye lean the way the wind blows them.
#[test]
fn wind_slants_the_streaks_of_near_drops() {
    // Across the view, and only what is near.
    let rain = Rain {
        distance: 1.5,
        wind: vec2(8.0, 0.0),
        ..white_rain(100.0, 1.5)
    };
    let slant = |rain: Rain| {
        let mut app = show(&VIEW, rain, 1.0 / 60.0, |_| {});
        set_time_step(&mut app, Duration::from_secs_f64(0.37));
        let (mut along, mut against) = (0.0, 0.0);
        for _ in 0..6 {
            step(&mut app, 1);
            let data = radiance(&app);
            let at = |x: u32, y: u32| f64::from(data.f16x4(x, y)[0]);
            for y in 8..data.size.y - 8 {
                for x in 8..data.size.x - 8 {
                    // Down is +y: drops that go right as they fall lean from upper left to lower right.
                    along += at(x, y) * at(x + 5, y + 4);
                    against += at(x, y) * at(x + 5, y - 4);
                }
            }
        }
        along / against
    };
    let (right, left) = (
        slant(rain),
        slant(Rain {
            wind: vec2(-8.0, 0.0),
            ..rain
        }),
    );
    println!("{right:.2}, {left:.2}");
    assert!(right > 1.3 && left < 1.0 / 1.3, "{right}, {left}");
}

/// Views from above, as of isometric games, and views along the fall: whatever is streaks there and
/// what is haze, there is as much rain in the way.
#[test]
fn steep_views_see_as_much_rain() {
    let orthographic = Lens::Orthographic {
        height: 8.0,
        near: 0.0,
        far: 100.0,
    };
    for lens in [orthographic, VIEW.lens] {
        let view = View { lens, ..VIEW };
        let mut app = show(&view, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
        for pitch in [-0.5, -0.8, 1.2, -1.45, core::f32::consts::FRAC_PI_2] {
            let ratio = optical_depth_at(&mut app, pitch, 30) / (extinction(20.0) * 10.0);
            println!("{lens:?}, {pitch}: {ratio:.4}");
            assert!((ratio - 1.0).abs() < 0.06, "{lens:?}, {pitch}: {ratio}");
        }
    }
    // And wherever in the picture: its upper and its lower quarter as much as its middle.
    let view = View {
        lens: orthographic,
        ..VIEW
    };
    let mut app = show(&view, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
    let camera = only::<Camera3d>(&mut app);
    set_time_step(&mut app, Duration::from_secs_f64(0.37));
    let mut sums = [0.0; 4];
    for look in 0..60 {
        let mut transform = app.world_mut().get_mut::<Transform>(camera).unwrap();
        transform.rotation = Quat::from_euler(EulerRot::YXZ, 2.4 * look as f32, -0.8, 0.0);
        step(&mut app, 1);
        let data = radiance(&app);
        for at in common::pixels(data.size) {
            sums[4 * at.y as usize / data.size.y as usize] += f64::from(data.f16x4(at.x, at.y)[1]);
        }
    }
    let all = sums.iter().sum::<f64>() / 4.0;
    println!("{:.3?}", sums.map(|sum| sum / all));
    assert!(
        sums.iter().all(|sum| (sum / all - 1.0).abs() < 0.1),
        "{sums:?}"
    );
}

/// Drops one by one stay where and what they are while others join them, after any time.
#[test]
fn a_denser_rain_holds_the_drops_of_a_thinner_one() {
    let rain = |rate| Rain {
        method: RainMethod::PerDrop,
        ..white_rain(rate, 4.0)
    };
    let mut app = show_plain(rain(2.0));
    set_time_step(&mut app, Duration::from_secs_f64(47.3));
    step(&mut app, 3);
    set_time_step(&mut app, Duration::ZERO);
    let look = |app: &mut App, rate| {
        set_rain(app, rain(rate));
        let data = radiance(app);
        let pixels = common::pixels(data.size).map(|at| data.f16x4(at.x, at.y)[1]);
        pixels.collect::<Vec<f32>>()
    };
    let mut thinner = look(&mut app, 2.0);
    for rate in [2.5, 10.0, 80.0] {
        let denser = look(&mut app, rate);
        // What covers a drop takes of its light no more than its own opacity.
        let lost = thinner
            .iter()
            .zip(&denser)
            .filter(|(a, b)| **b < 0.98 * **a);
        assert_eq!(lost.count(), 0, "{rate} mm/h");
        let sum = |picture: &[f32]| picture.iter().sum::<f32>();
        assert!(sum(&denser) > 1.05 * sum(&thinner) && sum(&thinner) > 1.0);
        thinner = denser;
    }
}

/// As the rate rises, drops fade in: there is as much rain as the rate says at any time, and no drop
/// is suddenly there. Parallel rays, so that there are only drops of the textures.
#[test]
fn rates_between_those_of_the_textures_are_mixed() {
    let view = View {
        lens: Lens::Orthographic {
            height: 2.0,
            near: 0.0,
            far: 100.0,
        },
        ..VIEW
    };
    let mut app = show(&view, white_rain(1.0, 10.0), 1.0 / 60.0, |_| {});
    let look = |app: &mut App, rate: f32| {
        set_rain(app, white_rain(rate, 10.0));
        let data = radiance(app);
        let pixels = common::pixels(data.size).map(|at| data.f16x4(at.x, at.y)[1]);
        pixels.collect::<Vec<f32>>()
    };
    let mut before = look(&mut app, 1.0);
    let (mut rate, mut largest) = (1.0, 0.0_f32);
    // What of βL there is in these pixels, at every rate.
    let mut ratios = Vec::new();
    while rate < 60.0 {
        rate *= 1.02;
        let now = look(&mut app, rate);
        let brightest = now.iter().copied().fold(0.0, f32::max);
        let change = now.iter().zip(&before).map(|(now, before)| now - before);
        largest = largest.max(change.map(f32::abs).fold(0.0, f32::max) / brightest);
        let mean = now.iter().copied().map(f64::from).sum::<f64>() / now.len() as f64;
        ratios.push(-(1.0 - mean).ln() / (extinction(f64::from(rate)) * 10.0));
        before = now;
    }
    println!("{largest:.3} of the brightest pixel; {ratios:.2?}");
    assert!(largest < 0.2, "{largest}");
    let steps = ratios
        .windows(2)
        .map(|pair| (pair[1] / pair[0] - 1.0).abs());
    assert!(steps.fold(0.0, f64::max) < 0.03, "{ratios:?}");
}
