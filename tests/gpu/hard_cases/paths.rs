//! h27 to h34 and h43: rays that meet what is not there, or too much of it.

use bevy::{math::DVec3, prelude::*};
use bevy_fluid::{
    prelude::*,
    render::{LayerBlending, Layers, SearchStatus},
    settings::Refractions,
};
use fluid_stage::TextureData;

use super::*;

const TRACED: ScreenSpaceFluid = ScreenSpaceFluid {
    refractions: Refractions::Four,
    ..RAW
};
const PARALLEL: View = View::new(
    64,
    Lens::Orthographic {
        height: 2.2,
        near: 0.0,
        far: 10.0,
    },
);
const CENTER: Vec3 = vec3(0.0, 0.0, -5.0);
const ALL: [Refractions; 4] = [
    Refractions::Zero,
    Refractions::One,
    Refractions::Two,
    Refractions::Four,
];

fn traced(refractions: Refractions) -> ScreenSpaceFluid {
    ScreenSpaceFluid {
        refractions,
        ..TRACED
    }
}

fn clear(index: f32) -> FluidMaterial {
    FluidMaterial {
        refractive_index: index,
        ..FluidMaterial::CLEAR_WATER
    }
}

fn rgb(texture: &TextureData, pixel: UVec2) -> DVec3 {
    let [r, g, b, _] = texture.f16x4(pixel.x, pixel.y);
    vec3(r, g, b).as_dvec3()
}

fn exits(view: &View, app: &App) -> Vec<(UVec2, Ray, Exit)> {
    assert_sound(app);
    let data = read(app, Layers::exits);
    pixels(view.size)
        .filter_map(|pixel| {
            let exit = Exit::at(view, &data, pixel.x, pixel.y)?;
            Some((pixel, view.ray(View::center(pixel)), exit))
        })
        .collect()
}

/// The same light from everywhere.
fn surround(app: &mut App, color: Color) {
    let camera = only::<Camera3d>(app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(color);
    settle(app).unwrap();
}

/// Where all around is white, what the liquid sends and what it lets through add up to white.
fn assert_white(view: &View, app: &App) {
    let [radiance, transmission] = [Layers::radiance, Layers::transmission].map(|of| read(app, of));
    for (pixel, ..) in exits(view, app) {
        let sum = rgb(&radiance, pixel) + rgb(&transmission, pixel);
        assert!((sum - 1.0).abs().max_element() < 2e-3, "{pixel}: {sum}");
    }
}

/// Reflectance for unpolarised light at an interface to `index`.
fn fresnel(sine: f64, index: f64) -> f64 {
    let (ci, ct) = ((1.0 - sine * sine).sqrt(), 1.0 - (sine / index).powi(2));
    if ct <= 0.0 {
        return 1.0;
    }
    let ct = ct.sqrt();
    let s = (ci - index * ct) / (ci + index * ct);
    let p = (index * ci - ct) / (index * ci + ct);
    0.5 * (s * s + p * p)
}

#[test]
fn h27_without_a_back_layer_one_refraction_with_its_status() {
    // An orthographic view so deep that the whole droplet is at the near plane, as far as f32
    // tells. Its back then equals what the depth-only draws hold for "nothing".
    let view = View::new(
        64,
        Lens::Orthographic {
            height: 2.2,
            near: 0.0,
            far: 1e9,
        },
    );
    let plugin = FluidPlugin {
        layer_blending: LayerBlending::DepthDraws,
        ..default()
    };
    let mut app = show_with(plugin, &view, TRACED, |world| {
        world.spawn(fluid(&[vec3(0.0, 0.0, -2.0)], 1.0, SPRAY));
    });
    surround(&mut app, Color::WHITE);
    let layers = read(&app, Layers::spray);
    let exits = exits(&view, &app);
    assert!(exits.len() > 1000, "{}", exits.len());
    for (pixel, ..) in &exits {
        assert_eq!(layers.f32x2(pixel.x, pixel.y)[1], NOTHING[1], "{pixel}");
    }
    for (pixel, ray, exit) in exits {
        assert_eq!(
            (exit.searches[0], exit.interfaces),
            (SearchStatus::Invalid, 1),
            "{pixel}"
        );
        let sine = ray.origin.truncate().length();
        let bent = angle(exit.direction, ray.direction);
        let wanted = (sine.asin() - (sine / 1.333).asin()).to_degrees();
        // The normal is the ellipsoid's; it turns by degrees a pixel at the silhouette.
        assert!(
            sine > 0.9 || (bent - wanted).abs() < 0.2,
            "{pixel}: {bent}°, not {wanted}°"
        );
    }
    assert_white(&view, &app);
}

#[test]
fn h28_spray_is_met_in_order_before_in_and_behind_the_bulk() {
    let droplet = |depth: f32| vec3(0.0, 0.0, -depth);
    // Bulk of 1 m about 5 m; on the axis rays pass straight through all surfaces.
    let mut app = show(&PARALLEL, TRACED, |_| {});
    let axis = PARALLEL.size / 2;
    for (depth, first, interfaces, exit_depth) in [
        (2.5, true, 4, 6.0),
        (5.0, false, 2, 6.0),
        (8.0, false, 4, 8.4),
        // In the front and in the back surface.
        (4.0, true, 2, 6.0),
        (6.0, false, 2, 6.4),
    ] {
        pour(&mut app, fluid(&[CENTER], 1.0, BULK));
        app.world_mut().spawn(fluid(&[droplet(depth)], 0.4, SPRAY));
        settle(&mut app).unwrap();
        assert_sound(&app);
        let exit = Exit::at(&PARALLEL, &read(&app, Layers::exits), axis.x, axis.y).unwrap();
        assert_eq!(exit.spray_first, first, "droplet at {depth} m: {exit:?}");
        let met = -exit.position.z;
        assert!(
            exit.interfaces == interfaces && (met - exit_depth).abs() < 0.03,
            "droplet at {depth} m: leaves at {met} m, {exit:?}"
        );
        assert_eq!(exit.searches[0], SearchStatus::Hit);
        let passed = rgb(&read(&app, Layers::transmission), axis).x;
        let wanted = (1.0 - fresnel(0.0, 1.333)).powi(interfaces as i32);
        assert!((passed - wanted).abs() < 5e-4, "{passed}, not {wanted}");
    }
}

/// A front and a back plate, each at a depth on the axis and turned about y.
fn slab(app: &mut App, material: FluidMaterial, [front, back]: [(f32, f32); 2]) {
    let [front, back] = [front, back]
        .map(|(depth, turn)| plate(20.0, Vec3::NEG_Z * depth, Quat::from_rotation_y(turn)));
    pour(app, front);
    let world = app.world_mut();
    world.spawn(back);
    for mut of in world.query::<&mut FluidMaterial>().iter_mut(world) {
        *of = material;
    }
    settle(app).unwrap();
}

#[test]
fn h29_at_the_critical_angle_no_root_is_taken_of_a_negative() {
    // The formula itself is tested in `render::shader_tests`, to a millionth of a radian; here
    // the normals' 11 bits decide which side of it a ray is on.
    let critical = (1.0_f32 / 1.333).asin();
    let mut app = show(&PARALLEL, TRACED, |_| {});
    surround(&mut app, Color::WHITE);
    for apart in [0.0, 1e-6, -1e-6, 1e-3, -1e-3] {
        slab(
            &mut app,
            clear(1.333),
            [(1.0, 0.0), (5.0, critical + apart)],
        );
        assert_white(&PARALLEL, &app);
        let statuses = exits(&PARALLEL, &app);
        let known = [
            SearchStatus::Hit,
            SearchStatus::TotalReflection,
            SearchStatus::LeftLayer,
        ];
        assert!(
            statuses
                .iter()
                .all(|(.., exit)| known.contains(&exit.searches[0]))
        );
    }
    // Grazing from outside: the same angle the other way round.
    pour(&mut app, fluid(&[CENTER], 1.0, SPRAY));
    assert_white(&PARALLEL, &app);
}

#[test]
fn h30_endless_total_reflection_stops_at_the_budget() {
    // In a sphere the angle is the same at every reflection, and so is the length of all chords.
    let center = DVec3::new(-0.7, 0.0, 0.0);
    let view = View::new(
        64,
        Lens::Perspective {
            fov: 2.4,
            near: 0.05,
        },
    );
    let mut app = show(&view, TRACED, |world| {
        world.spawn((fluid(&[vec3(-0.7, 0.0, 0.0)], 1.0, SPRAY),));
    });
    let liquid = only::<FluidParticles>(&mut app);
    app.world_mut().entity_mut(liquid).insert(clear(5.0));
    surround(&mut app, Color::WHITE);
    for refractions in [Refractions::Two, Refractions::Four] {
        look(&mut app, traced(refractions));
        let exits = exits(&view, &app);
        assert_eq!(exits.len() as u32, view.size.element_product());
        let mut spent = 0;
        let [mut seen, mut found] = [0, 0];
        for (pixel, ray, exit) in exits {
            assert!(exit.interfaces <= refractions.count(), "{pixel}: {exit:?}");
            let first = exit.searches[0];
            let middle = ray.direction.dot(center - ray.origin);
            let half = (1.0 - (ray.at(middle) - center).length_squared()).sqrt();
            let at = ray.at(middle + half);
            let second = at + 2.0 * half * ray.direction.reflect(at - center);
            let [w, h] = view.half_extent_at(-second.z).to_array();
            let on_screen = second.z < -0.2 && second.x.abs() < 0.9 * w && second.y.abs() < 0.9 * h;
            if on_screen && first == SearchStatus::TotalReflection {
                seen += 1;
                let again = exit.searches[1] == SearchStatus::TotalReflection;
                found += usize::from(again && exit.position.distance(second) < 0.1);
            }
            let all = exit.interfaces == refractions.count();
            spent += usize::from(all && first == SearchStatus::TotalReflection);
        }
        assert!(spent > 1000, "{spent} rays spend all {refractions:?}");
        if refractions == Refractions::Two {
            assert!(
                seen > 100 && 20 * found > 19 * seen,
                "{found} of {seen} meet the sphere again where they should"
            );
        }
        assert_white(&view, &app);
    }
}

#[test]
fn h31_index_one_neither_bends_nor_reflects() {
    let material = FluidMaterial {
        medium: Medium {
            absorption_density: 1.0,
            absorption_color: LinearRgba::rgb(0.0, 0.5, 1.0),
            ..Medium::CLEAR
        },
        ..clear(1.0)
    };
    let mut app = show(&PARALLEL, TRACED, |_| {});
    surround(&mut app, Color::WHITE);
    for kernel in [SPRAY, BULK] {
        for refractions in ALL {
            pour(
                &mut app,
                (FluidParticles::new(vec![CENTER], 1.0), kernel, material),
            );
            look(&mut app, traced(refractions));
            let [radiance, transmission] =
                [Layers::radiance, Layers::transmission].map(|of| read(&app, of));
            for (pixel, ray, exit) in exits(&PARALLEL, &app) {
                assert!(exit.direct && exit.interfaces == 0, "{pixel}");
                assert!(angle(exit.direction, ray.direction) < 0.01, "{pixel}");
                assert_eq!(rgb(&radiance, pixel), DVec3::ZERO, "{pixel}");
                let sine = ray.origin.truncate().length();
                // Beyond it the chord's f32 depths differ in their last digits only.
                if sine < 0.999 {
                    let chord = 2.0 * (1.0 - sine * sine).sqrt();
                    let wanted = DVec3::from([1.0, 0.5, 0.0].map(|b: f64| (-b * chord).exp()));
                    let error = (rgb(&transmission, pixel) - wanted).abs().max_element();
                    assert!(error < 5e-4, "{pixel}: {error}");
                }
            }
        }
    }
}

#[test]
fn h32_a_bubble_reflects_totally_outside() {
    let index = 0.75;
    let mut app = show(&PARALLEL, TRACED, |_| {});
    pour(
        &mut app,
        (
            FluidParticles::new(vec![CENTER], 1.0),
            SPRAY,
            clear(index as f32),
        ),
    );
    surround(&mut app, Color::WHITE);
    for refractions in [Refractions::One, Refractions::Four] {
        look(&mut app, traced(refractions));
        let [radiance, transmission] =
            [Layers::radiance, Layers::transmission].map(|of| read(&app, of));
        let [mut inside, mut outside] = [0; 2];
        for (pixel, ray, exit) in exits(&PARALLEL, &app) {
            let sine = ray.origin.truncate().length();
            let [reflected, passed] = [&radiance, &transmission].map(|of| rgb(of, pixel).x);
            if sine > index + 0.01 && sine < 0.97 {
                outside += 1;
                assert!(
                    (reflected - 1.0).abs() < 1e-3 && passed == 0.0,
                    "{pixel}: {reflected}"
                );
                let wanted = 180.0 - 2.0 * sine.asin().to_degrees();
                let bent = angle(exit.direction, ray.direction);
                assert!(
                    (bent - wanted).abs() < 0.5,
                    "{pixel}: {bent}°, not {wanted}°"
                );
            } else if sine < 0.6 {
                inside += 1;
                let wanted = fresnel(sine, index);
                let crossings = if refractions == Refractions::One {
                    1
                } else {
                    2
                };
                let through = (1.0 - wanted).powi(crossings);
                assert!(
                    (passed - through).abs() < 5e-3,
                    "{pixel}: {passed}, not {through}"
                );
                let away = (sine / index).asin() - sine.asin();
                let wanted = (away * f64::from(crossings)).to_degrees();
                let bent = angle(exit.direction, ray.direction);
                assert!(
                    (bent - wanted).abs() < 0.7,
                    "{pixel}: {bent}°, not {wanted}°"
                );
            }
        }
        assert!(inside > 500 && outside > 300, "{inside}, {outside}");
        assert_white(&PARALLEL, &app);
    }
}

#[test]
fn h33_opaque_absorption_lets_nothing_through() {
    let mut app = show(&PARALLEL, TRACED, |_| {});
    surround(&mut app, Color::WHITE);
    for density in [1e6, 1e30, f32::MAX] {
        for index in [1.0, 1.333] {
            let material = FluidMaterial {
                medium: Medium {
                    absorption_density: density,
                    absorption_color: LinearRgba::BLACK,
                    ..Medium::CLEAR
                },
                ..clear(index)
            };
            assert_eq!(material.medium.transmitted(1e-3), Vec3::ZERO);
            for kernel in [SPRAY, BULK] {
                pour(
                    &mut app,
                    (FluidParticles::new(vec![CENTER], 1.0), kernel, material),
                );
                for refractions in ALL {
                    look(
                        &mut app,
                        ScreenSpaceFluid {
                            refractions,
                            ..TRACED
                        },
                    );
                    let transmission = read(&app, Layers::transmission);
                    for (pixel, ray, _) in exits(&PARALLEL, &app) {
                        let sine = ray.origin.truncate().length();
                        let passed = rgb(&transmission, pixel);
                        assert!(sine > 0.99 || passed == DVec3::ZERO, "{pixel}: {passed}");
                    }
                }
            }
        }
    }
}

#[test]
fn h34_paths_of_no_length_and_of_endless_length_are_finite() {
    // A disc of no thickness to speak of lets all light through that its surfaces do.
    let mut app = show(&PARALLEL, TRACED, |_| {});
    surround(&mut app, Color::WHITE);
    let ink = FluidMaterial {
        refractive_index: 1.333,
        ..FluidMaterial::INK
    };
    for refractions in ALL {
        pour(&mut app, plate(20.0, CENTER, Quat::IDENTITY));
        let disc = only::<FluidParticles>(&mut app);
        app.world_mut().entity_mut(disc).insert(ink);
        look(&mut app, traced(refractions));
        let transmission = read(&app, Layers::transmission);
        let crossings = refractions.count().clamp(1, 2);
        let wanted = (1.0 - fresnel(0.0, 1.333)).powi(crossings as i32);
        for (pixel, ..) in exits(&PARALLEL, &app) {
            let passed = rgb(&transmission, pixel).max_element();
            // Twice PLATE_THICKNESS of ink takes 0.2 %.
            assert!(
                (passed - wanted).abs() < 3e-3,
                "{pixel}: {passed}, not {wanted}"
            );
        }
    }
    // In a sphere as large as the earth's orbit, nothing is left of any light.
    let view = View::new(32, PERSPECTIVE);
    let mut app = show(&view, TRACED, |_| {});
    surround(&mut app, Color::WHITE);
    for radius in [1e6, 9e8] {
        pour(
            &mut app,
            (FluidParticles::new(vec![Vec3::ZERO], radius), SPRAY, ink),
        );
        let transmission = read(&app, Layers::transmission);
        let exits = exits(&view, &app);
        assert_eq!(exits.len() as u32, view.size.element_product());
        for (pixel, ..) in exits {
            assert_eq!(
                rgb(&transmission, pixel),
                DVec3::ZERO,
                "{pixel}, radius {radius}"
            );
        }
    }
    // The same in Rust; its WGSL twin is compared with it in `render::shader_tests`.
    for distance in [0.0, f32::INFINITY, f32::MAX, -1.0] {
        let left = ink.medium.transmitted(distance);
        assert!(
            left.is_finite() && (left == Vec3::ONE) == (distance <= 0.0),
            "{distance}: {left}"
        );
    }
}

#[test]
fn h43_a_ray_that_leaves_the_screen_sees_the_environment() {
    let mut app = show(&PARALLEL, TRACED, |world| {
        // Behind the liquid is a green wall, but for what is next to the screen's border: there
        // it would be taken to go on.
        let place = Transform::from_xyz(0.0, 0.0, -9.0);
        spawn_box(world, vec3(2.0, 9.0, 0.1), place);
    });
    let mut images = app.world_mut().resource_mut::<Assets<Image>>();
    let mut map = EnvironmentMapLight::solid_color(&mut images, Color::linear_rgb(1.0, 0.0, 0.0));
    map.intensity = 1.0 / bevy::camera::Exposure::default().exposure();
    look(&mut app, map);
    let turn = 0.7;
    slab(&mut app, clear(1.333), [(3.0, turn), (6.5, turn)]);
    let exits = exits(&PARALLEL, &app);
    assert_eq!(exits.len() as u32, PARALLEL.size.element_product());
    let shown = picture(&mut app);
    let [mut left, mut stayed] = [0; 2];
    for (pixel, _, exit) in exits {
        let [r, g, ..] = shown.get_pixel(pixel.x, pixel.y).0;
        match exit.searches[0] {
            SearchStatus::LeftLayer => {
                left += 1;
                assert!(r > 200 && g < 40, "{pixel}: {r} {g}, {exit:?}");
            }
            SearchStatus::Hit if exit.position.x.abs() < 0.95 => {
                stayed += 1;
                assert!(r < 100 && g > 100, "{pixel}: {r} {g}, {exit:?}");
            }
            SearchStatus::Hit => {}
            other => panic!("{pixel}: {other:?}"),
        }
    }
    assert!(left > 200 && stayed > 1000, "{left} left, {stayed} stayed");
}
