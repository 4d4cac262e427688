//! What is reflected, what is absorbed and what is left.

use bevy::prelude::*;
use bevy_fluid::{
    prelude::ScreenSpaceFluid,
    render::Layers,
    settings::{Fresnel, Refractions},
};

use crate::common::*;

use super::{
    INDEX, PARALLEL, PERSPECTIVE, TRACED, clear, exact, exits, kept, refracted_angle, rgb, sphere,
    sphere_sine, surround, tinted,
};

fn schlick(incident: f64, _: f64) -> f64 {
    let normal = exact(0.0, 0.0);
    normal + (1.0 - normal) * (1.0 - incident.cos()).powi(5)
}

#[test]
fn light_fades_along_the_bent_chord() {
    let app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(SPRAY, tinted(INDEX)));
    });
    let transmission = read(&app, Layers::transmission);
    for (pixel, ray, _) in exits(&PARALLEL, &app) {
        let sine = sphere_sine(&ray);
        if sine > 0.9 {
            continue;
        }
        let [incident, refracted] = [sine.asin(), refracted_angle(sine)];
        let passes = 1.0 - exact(incident, refracted);
        let wanted = passes * passes * kept(2.0 * refracted.cos());
        let error = (rgb(&transmission, pixel) - wanted).abs().max_element();
        // The chord is found to a fiftieth of the radius, and the steepest of fading is 1/m.
        assert!(error < 0.02, "{pixel}, sine {sine}: {error}");
    }
}

#[test]
fn the_first_interface_reflects_as_fresnel_says() {
    for (setting, formula) in [
        (Fresnel::Exact, exact as fn(f64, f64) -> f64),
        (Fresnel::Schlick, schlick),
    ] {
        let settings = ScreenSpaceFluid {
            refractions: Refractions::One,
            fresnel: setting,
            ..RAW
        };
        let mut app = show(&PARALLEL, settings, |world| {
            world.spawn(sphere(SPRAY, clear(INDEX)));
        });
        surround(&mut app, Color::WHITE);
        let radiance = read(&app, Layers::radiance);
        let transmission = read(&app, Layers::transmission);
        for (pixel, ray, _) in exits(&PARALLEL, &app) {
            let sine = sphere_sine(&ray);
            if sine > 0.97 {
                continue;
            }
            let wanted = formula(sine.asin(), refracted_angle(sine));
            let [reflected, passed] = [&radiance, &transmission].map(|t| rgb(t, pixel).x);
            // A normal off by 0.05° makes 0.001 of it at 75°.
            assert!(
                (reflected - wanted).abs() < 2e-3,
                "{pixel}: {reflected}, not {wanted}"
            );
            assert!(
                (1.0 - passed - wanted).abs() < 2e-3,
                "{pixel}: {passed} passed"
            );
        }
    }
}

#[test]
fn in_a_white_furnace_no_light_is_lost_or_made() {
    let mut app = show(&PERSPECTIVE, TRACED, |world| {
        world.spawn(sphere(BULK, clear(INDEX)));
        let behind = vec3(0.4, 0.3, -7.0);
        world.spawn(fluid(&[behind], 0.6, SPRAY));
    });
    surround(&mut app, Color::WHITE);
    let counts = [
        Refractions::Zero,
        Refractions::One,
        Refractions::Two,
        Refractions::Four,
    ];
    for refractions in counts {
        for fresnel in [Fresnel::Exact, Fresnel::Schlick] {
            look(
                &mut app,
                ScreenSpaceFluid {
                    refractions,
                    fresnel,
                    ..TRACED
                },
            );
            assert_white(&app);
        }
    }
    // The same white as a cubemap, under a black background.
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut map = EnvironmentMapLight::solid_color(&mut images, Color::WHITE);
    map.intensity = 1.0 / bevy::camera::Exposure::default().exposure();
    surround(&mut app, Color::BLACK);
    look(&mut app, map);
    assert_white(&app);
}

fn assert_white(app: &App) {
    let radiance = read(app, Layers::radiance);
    let transmission = read(app, Layers::transmission);
    for (pixel, ..) in exits(&PERSPECTIVE, app) {
        let sum = rgb(&radiance, pixel) + rgb(&transmission, pixel);
        assert!((sum - 1.0).abs().max_element() < 2e-3, "{pixel}: {sum}");
    }
}
