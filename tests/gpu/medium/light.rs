//! What the medium sends: of its own, and of the light that falls on the scene.

use super::*;

/// Fog that takes some of the light, in other amounts per channel.
fn fog() -> Medium {
    Medium {
        scattering_density: 0.8,
        scattering_color: LinearRgba::rgb(0.9, 0.5, 0.1),
        absorption_density: 0.5,
        absorption_color: LinearRgba::rgb(0.2, 1.0, 0.6),
        ..Medium::CLEAR
    }
}

/// Compares the radiance of every pixel of the sphere to that of its chord in this light.
fn assert_lit(app: &App, medium: &Medium, light: Vec3) {
    let radiance = read(app, Layers::radiance);
    let transmission = read(app, Layers::transmission);
    let mut seen = 0;
    for pixel in pixels(PARALLEL.size) {
        let Some(chord) = chord(pixel) else { continue };
        let sent = medium.reflected(chord as f32, light).as_dvec3();
        let left = medium.transmitted(chord as f32).as_dvec3();
        let errors = [
            rgb(&radiance, pixel) - sent,
            rgb(&transmission, pixel) - left,
        ];
        let error = errors.map(|e| e.abs().max_element()).into_iter();
        let error = error.fold(0.0, f64::max);
        assert!(error < 2.0 * HALF, "{pixel}: {error} of {sent}");
        seen += 1;
    }
    assert!(seen > 5000, "{seen}");
}

#[test]
fn each_combination_of_terms_sends_what_the_closed_form_says() {
    let mut app = show(&PARALLEL, TRACED, |_| {});
    app.insert_resource(GlobalAmbientLight {
        brightness: 0.4 * white(),
        ..default()
    });
    let (scattering, absorption, emission) = (
        Medium::scattering(LinearRgba::rgb(0.9, 0.5, 0.1), 1.0),
        Medium::absorbing(LinearRgba::rgb(0.2, 0.7, 0.9), 1.0),
        Medium::emitting(LinearRgba::rgb(0.3, 0.2, 0.1) * white(), 1.0),
    );
    for medium in [
        Medium::CLEAR,
        scattering,
        absorption,
        scattering + absorption,
        emission,
        scattering + emission,
        absorption + emission,
        scattering + absorption + emission,
    ] {
        pour(&mut app, sphere(unbent(medium)));
        // The closed form in the units of the picture.
        let exposed = Medium {
            emission: medium.emission * (1.0 / white()),
            ..medium
        };
        assert_lit(&app, &exposed, Vec3::splat(0.4));
    }
}

#[test]
fn all_light_of_the_scene_counts_by_its_mean() {
    let medium = fog();
    let mut app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(unbent(medium)));
    });
    app.insert_resource(GlobalAmbientLight::NONE);
    settle(&mut app).unwrap();
    assert_lit(&app, &medium, Vec3::ZERO);

    // Two suns, one of them red: E / 4π each, wherever they stand.
    let sun = |color: Color, share: f32| DirectionalLight {
        color,
        illuminance: share * white() * 4.0 * core::f32::consts::PI,
        ..default()
    };
    for (direction, light) in [
        (Vec3::NEG_Y, sun(Color::WHITE, 0.25)),
        (Vec3::X, sun(Color::linear_rgb(1.0, 0.0, 0.0), 0.5)),
    ] {
        let pose = Transform::default().looking_to(direction, Vec3::Z);
        app.world_mut().spawn((light, pose));
    }
    settle(&mut app).unwrap();
    let suns = vec3(0.75, 0.25, 0.25);
    assert_lit(&app, &medium, suns);

    // The camera's own ambient light stands in for the scene's.
    app.insert_resource(GlobalAmbientLight::default());
    look(
        &mut app,
        AmbientLight {
            brightness: 0.2 * white(),
            ..default()
        },
    );
    assert_lit(&app, &medium, suns + 0.2);

    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut map = EnvironmentMapLight::hemispherical_gradient(
        &mut images,
        Color::linear_rgb(0.1, 0.2, 1.0),
        Color::linear_rgb(0.1, 0.2, 0.5),
        Color::linear_rgb(0.1, 0.2, 0.0),
    );
    map.intensity = 0.5 * white();
    look(&mut app, map);
    // The gradient goes straight from above to below, so half of it is its mean; its texels
    // have eight bits.
    assert_lit(&app, &medium, suns + 0.2 + 0.5 * vec3(0.1, 0.2, 0.5));
}

#[test]
fn smoke_darkens_at_night() {
    let mut app = show(&PARALLEL, TRACED, |world| {
        world.spawn(sphere(FluidMaterial::SMOKE));
    });
    app.insert_resource(GlobalAmbientLight::NONE);
    let axis = PARALLEL.size / 2;
    let mut shown = [1.0, 0.1, 0.0].map(|light| {
        furnace(&mut app, light * white());
        rgb(&read(&app, Layers::radiance), axis).y
    });
    let day = shown[0];
    assert!(day > 0.3, "{day}");
    shown = shown.map(|light| light / day);
    assert!(
        (shown[1] - 0.1).abs() < 1e-3 && shown[2] == 0.0,
        "{shown:?}"
    );
}

#[test]
fn in_a_white_furnace_white_fog_is_not_seen() {
    for index in [1.0, 1.333] {
        let material = FluidMaterial {
            refractive_index: index,
            ..unbent(Medium::scattering(LinearRgba::WHITE, 0.7))
        };
        let mut app = show(&PARALLEL, TRACED, |world| {
            world.spawn(sphere(material));
            // A second body along the way, of bulk.
            let behind = FluidParticles::new(vec![vec3(0.3, 0.2, -8.0)], 1.0);
            world.spawn((behind, BULK, material));
        });
        furnace(&mut app, white());
        let radiance = read(&app, Layers::radiance);
        let transmission = read(&app, Layers::transmission);
        let exits = read(&app, Layers::exits);
        let mut seen = 0;
        for pixel in pixels(PARALLEL.size) {
            if Exit::at(&PARALLEL, &exits, pixel.x, pixel.y).is_none() {
                continue;
            }
            let sum = rgb(&radiance, pixel) + rgb(&transmission, pixel);
            // Both are rounded to halves, and so are the light's texels.
            assert!(
                (sum - 1.0).abs().max_element() < 1e-3,
                "{index}, {pixel}: {sum}"
            );
            seen += 1;
        }
        assert!(seen > 5000, "{seen}");
    }
}

#[test]
fn bulk_and_spray_compose_in_order() {
    // A sphere of bulk before one of spray; the ray along the axis goes straight through both.
    let medium = fog() + Medium::emitting(LinearRgba::rgb(0.1, 0.2, 0.3) * white(), 1.0);
    let index = 1.2;
    let mut app = show(&PARALLEL, TRACED, |world| {
        let material = FluidMaterial {
            refractive_index: index,
            ..unbent(medium)
        };
        let near = FluidParticles::new(vec![vec3(0.0, 0.0, -3.0)], 1.0);
        world.spawn((near, BULK, material));
        let far = FluidParticles::new(vec![vec3(0.0, 0.0, -7.0)], 1.0);
        world.spawn((far, SPRAY, material));
    });
    app.insert_resource(GlobalAmbientLight {
        brightness: 0.4 * white(),
        ..default()
    });
    settle(&mut app).unwrap();
    let axis = PARALLEL.size / 2;
    let exposed = Medium {
        emission: medium.emission * (1.0 / white()),
        ..medium
    };
    let left = exposed.transmitted(2.0);
    let sent = exposed.reflected(2.0, Vec3::splat(0.4));
    let passes = 1.0 - ((index - 1.0) / (index + 1.0)).powi(2);
    // Surroundings are black: what is reflected is nothing.
    let wanted = passes * sent + passes.powi(3) * left * sent;
    let got = rgb(&read(&app, Layers::radiance), axis);
    let error = (got - wanted.as_dvec3()).abs().max_element();
    // The search stops within a fiftieth of the radius.
    assert!(error < 0.02, "{got}, not {wanted}");
    let wanted = passes.powi(4) * left * left;
    let got = rgb(&read(&app, Layers::transmission), axis);
    let error = (got - wanted.as_dvec3()).abs().max_element();
    assert!(error < 0.02, "{got}, not {wanted}");
}
