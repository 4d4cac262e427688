use super::*;

/// `f_T` and the length that `f_R` is proportional to, in f64.
fn exact(extinction: f32, distance: f32) -> [f64; 2] {
    let [b, d] = [extinction, distance].map(f64::from);
    let x = b * d;
    let length = if b == 0.0 { d } else { -(-x).exp_m1() / b };
    [(-x).exp(), length]
}

fn relative(got: f32, wanted: f64) -> f64 {
    // Below the least f32 there is nothing but 0.
    let floor = f64::from(f32::MIN_POSITIVE);
    (f64::from(got) - wanted).abs() / wanted.abs().max(floor)
}

/// A medium of this extinction that emits 1 per metre.
fn glowing(extinction: f32) -> Medium {
    Medium {
        absorption_density: extinction,
        absorption_color: LinearRgba::BLACK,
        emission: LinearRgba::WHITE,
        ..Medium::CLEAR
    }
}

#[test]
fn h50_every_density_and_length_is_as_exact_as_f32() {
    let mut worst = 0.0_f64;
    // Between the powers of ten too: the series ends at 0.5.
    let steps = (-180..=60).map(|i| 10_f32.powf(0.05 * i as f32));
    let lengths = [0.0, 1e-6, 1e-3, 0.49, 0.51, 1.0, 7.0, 1e6];
    for b in [0.0].into_iter().chain(steps) {
        for d in lengths {
            let medium = glowing(b);
            let [left, length] = exact(b, d);
            // Beyond it exp loses digits to the rounding of its argument, of 1e-6 and more.
            if b * d <= 16.0 {
                worst = worst.max(relative(medium.transmitted(d).x, left));
            }
            worst = worst.max(relative(medium.reflected(d, Vec3::ZERO).x, length));
        }
    }
    assert!(worst <= 1e-6, "{worst}");
}

#[test]
fn segments_compose_to_the_whole() {
    let medium = Medium {
        scattering_density: 0.8,
        scattering_color: LinearRgba::rgb(0.9, 0.5, 0.1),
        absorption_density: 1.5,
        absorption_color: LinearRgba::rgb(0.2, 1.0, 0.6),
        emission: LinearRgba::rgb(0.3, 0.0, 2.0),
    };
    let light = vec3(1.0, 0.7, 0.4);
    for whole in [1e-3, 0.3, 2.0, 9.0] {
        for cut in [0.001, 0.2, 0.5, 0.97] {
            let [near, far] = [cut * whole, (1.0 - cut) * whole];
            let left = medium.transmitted(near) * medium.transmitted(far);
            let sent = medium.reflected(near, light)
                + medium.transmitted(near) * medium.reflected(far, light);
            for (got, wanted) in [
                (left, medium.transmitted(whole)),
                (sent, medium.reflected(whole, light)),
            ] {
                let error = ((got - wanted) / wanted).abs().max_element();
                assert!(error <= 1e-5, "{whole} m cut at {cut}: {error}");
            }
        }
    }
}

#[test]
fn a_white_medium_in_white_light_neither_takes_nor_gives() {
    let fog = Medium::scattering(LinearRgba::WHITE, 2.0);
    for distance in [0.0, 1e-6, 0.1, 1.0, 1.4, 30.0, f32::INFINITY] {
        let sum = fog.transmitted(distance) + fog.reflected(distance, Vec3::ONE);
        assert!((sum - 1.0).abs().max_element() <= 1e-6, "{distance}: {sum}");
    }
}

#[test]
fn constructors_do_as_they_say() {
    let color = LinearRgba::rgb(0.2, 0.5, 0.9);
    let left = Medium::absorbing(color, 3.0).transmitted(3.0);
    assert!((left - color.to_vec3()).length() < 1e-6, "{left}");

    let fog = Medium::scattering(color, 3.0);
    let left = fog.transmitted(3.0);
    assert!((left - 0.5).length() < 1e-6, "{left}");
    let deep = fog.reflected(1e6, Vec3::ONE);
    assert!((deep - color.to_vec3()).length() < 1e-6, "{deep}");

    let flame = Medium::emitting(color, 3.0);
    assert_eq!(flame.transmitted(3.0), Vec3::ONE);
    let sent = flame.reflected(3.0, Vec3::ONE);
    assert!((sent - color.to_vec3()).length() < 1e-6, "{sent}");

    for distance in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for medium in [
            Medium::absorbing(color, distance),
            Medium::scattering(color, distance),
            Medium::emitting(color, distance),
        ] {
            assert_eq!(medium, Medium::clear());
        }
    }
}

#[test]
fn mixtures_do_what_their_parts_do() {
    let dye = Medium::absorbing(LinearRgba::rgb(0.2, 0.5, 0.9), 1.0);
    let fog = Medium::scattering(LinearRgba::rgb(0.9, 0.8, 0.1), 1.0);
    let glow = Medium::emitting(LinearRgba::rgb(1.0, 2.0, 3.0), 1.0);
    assert_eq!(dye + Medium::CLEAR, dye);
    assert_eq!(Medium::CLEAR + fog, fog);
    let all = dye + fog + glow + dye + fog;
    let extinction = 2.0 * (dye.extinction() + fog.extinction());
    assert!((all.extinction() - extinction).length() < 1e-5);
    let light = vec3(0.5, 1.0, 2.0);
    let source = 2.0 * fog.source(light) + glow.source(light);
    assert!((all.source(light) - source).length() < 1e-5);
}

#[test]
fn bad_fields_are_named_and_clamped() {
    let white = Medium {
        scattering_density: 1.0,
        absorption_density: 1.0,
        ..Medium::CLEAR
    };
    assert_eq!(white.validate(), Ok(()));
    let cases: [(&str, fn(&mut Medium, f32)); 5] = [
        ("`Medium::scattering_density`", |m, v| {
            m.scattering_density = v;
        }),
        ("`Medium::scattering_color.green`", |m, v| {
            m.scattering_color.green = v;
        }),
        ("`Medium::absorption_density`", |m, v| {
            m.absorption_density = v;
        }),
        ("`Medium::absorption_color.blue`", |m, v| {
            m.absorption_color.blue = v;
        }),
        ("`Medium::emission.red`", |m, v| m.emission.red = v),
    ];
    for (field, set) in cases {
        for value in [-1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            let mut bad = white;
            set(&mut bad, value);
            let error = bad.validate().unwrap_err().to_string();
            assert!(
                error.starts_with(field) && error.contains(&value.to_string()),
                "{error}"
            );
            assert_eq!(bad.clamped().validate(), Ok(()), "{field} {value}");
            for distance in [0.0, 1.0, f32::INFINITY, f32::NAN] {
                let [left, sent] = [
                    bad.transmitted(distance),
                    bad.reflected(distance, Vec3::ONE),
                ];
                assert!(
                    left.is_finite() && sent.is_finite(),
                    "{field} {value} {distance}"
                );
            }
        }
    }
    let mut above = white;
    above.scattering_color.red = 1.1;
    assert!(above.validate().is_err());
}
