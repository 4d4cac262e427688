//! Rain in the light of lamps and suns.

use super::*;

/// All of the rain that it sees is seen from the same side.
const NARROW: View = View {
    lens: Lens::Perspective {
        fov: 0.05,
        near: 0.05,
    },
    ..VIEW
};

fn lamp(intensity: f32, at: Vec3) -> impl Bundle {
    (
        SpotLight {
            intensity,
            range: 6.0,
            outer_angle: 0.6,
            ..default()
        },
        Transform::from_translation(VIEW.pose.translation + at)
            .looking_to(vec3(-0.6, -0.3, 0.2), Vec3::Y),
    )
}

#[test]
fn without_light_rain_is_dark() {
    let mut app = show_plain(Rain {
        extent: 500.0,
        ..white_rain(50.0, 10.0)
    });
    no_surroundings(&mut app);
    assert_eq!(mean(&radiance(&app)), 0.0);
    assert_eq!(quads(&app), Some(0));
}

/// Voxels that no light reaches are left out; a trace of light from all around draws them.
#[test]
fn leaving_out_unlit_voxels_changes_nothing_visible() {
    let mut app = show(&VIEW, white_rain(20.0, 10.0), 1.0 / 30.0, |world| {
        world.spawn(lamp(4000.0, vec3(2.0, 1.0, -5.0)));
        spawn_box(
            world,
            Vec3::splat(4.0),
            Transform::from_translation(VIEW.pose.translation + vec3(0.0, 0.0, -8.0)),
        );
    });
    no_surroundings(&mut app);
    let (few, left_out) = (quads(&app).unwrap(), capture(&mut app).unwrap());
    app.world_mut()
        .resource_mut::<GlobalAmbientLight>()
        .brightness = 1e-9;
    settle(&mut app).unwrap();
    let (all, drawn) = (quads(&app).unwrap(), capture(&mut app).unwrap());
    println!("{few} of {all} voxels");
    assert!(4 * few < 3 * all, "{few} of {all}");
    let largest = left_out
        .iter()
        .zip(drawn.iter())
        .map(|(a, b)| a.abs_diff(*b))
        .max();
    assert!(largest <= Some(1), "{largest:?}");
    // And the lamp does light rain.
    let lit = left_out.pixels().filter(|p| p.0[0] > 10).count();
    assert!(lit > 50, "{lit}");
}

/// Inverse-square falloff and the phase function, on the way of a lamp's light to the eye.
#[test]
fn light_falls_off_with_the_square_of_the_distance() {
    let at = |away: f32| {
        let mut app = show(&VIEW, white_rain(20.0, 4.0), 1.0 / 60.0, |world| {
            let pose = Transform::from_translation(VIEW.pose.translation + Vec3::Y * away);
            world.spawn((
                PointLight {
                    intensity: 1e6,
                    range: 1e5,
                    ..default()
                },
                pose,
            ));
        });
        no_surroundings(&mut app);
        mean(&radiance(&app))
    };
    let ratio = at(200.0) / at(400.0);
    assert!((ratio / 4.0 - 1.0).abs() < 0.1, "{ratio}");
}

/// The phase function that shaders have is the one that is documented.
#[test]
fn light_goes_where_the_phase_function_says() {
    let mut app = show(&NARROW, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
    let opacity = mean(&radiance(&app));
    app.world_mut()
        .resource_mut::<GlobalAmbientLight>()
        .brightness = 0.0;
    let sun = app.world_mut().spawn_empty().id();
    // The eye looks along −z; light that comes towards it goes straight on.
    for angle in [0.0_f32, 0.3, 0.8, 1.3, 2.0, 2.48, 3.0] {
        app.world_mut().entity_mut(sun).insert((
            DirectionalLight {
                illuminance: 10.0,
                ..default()
            },
            Transform::default().looking_to(vec3(angle.sin(), 0.0, angle.cos()), Vec3::Y),
        ));
        settle(&mut app).unwrap();
        let shone = mean(&radiance(&app)) / opacity / 10.0;
        let expected = f64::from(phase(angle.cos()));
        assert!(
            (shone / expected - 1.0).abs() < 0.02,
            "{angle}: {shone}, {expected}"
        );
    }
}

/// Rain in the light of one lamp, 200 m above, over the same in that of a point light without end.
fn against_a_point_light(lamp: impl Bundle, rotation: Quat) -> (f64, Option<usize>) {
    let mut app = show(&NARROW, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
    no_surroundings(&mut app);
    let place = Transform::from_translation(VIEW.pose.translation + 200.0 * Vec3::Y);
    let whole = PointLight {
        intensity: 1e7,
        range: 1e6,
        ..default()
    };
    let light = app.world_mut().spawn((whole, place)).id();
    settle(&mut app).unwrap();
    let whole = mean(&radiance(&app));
    assert!(whole > 0.0);
    app.world_mut()
        .entity_mut(light)
        .remove::<PointLight>()
        .insert((place.with_rotation(rotation), lamp));
    settle(&mut app).unwrap();
    (mean(&radiance(&app)) / whole, quads(&app))
}

/// Bevy's cone: all of the light up to the inner angle, none beyond the outer one, and the square of
/// a straight line in the cosine between them.
#[test]
fn spot_lights_light_what_is_in_their_cone() {
    let (inner, outer) = (0.3_f64, 0.6_f64);
    for off in [0.0_f64, 0.25, 0.35, 0.45, 0.55, 0.7, 2.0] {
        let spot = SpotLight {
            intensity: 1e7,
            range: 1e6,
            inner_angle: inner as f32,
            outer_angle: outer as f32,
            ..default()
        };
        // The rain is below, 5 m ahead of the point under the lamp.
        let down = Transform::default().looking_to(vec3(0.0, -200.0, -5.0), Vec3::X);
        let turned = Quat::from_rotation_z(off as f32) * down.rotation;
        let (ratio, drawn) = against_a_point_light(spot, turned);
        let part = (off.cos() - outer.cos()) / (inner.cos() - outer.cos());
        let expected = part.clamp(0.0, 1.0).powi(2);
        println!("{off}: {ratio:.4}, {expected:.4}");
        assert!(
            (ratio - expected).abs() < 0.01,
            "{off}: {ratio}, {expected}"
        );
        assert_eq!(drawn == Some(0), off > outer, "{off}: {drawn:?}");
    }
}

/// Bevy's range: (1 − (d/range)⁴)² of the light, and none beyond it.
#[test]
fn lamps_light_what_is_in_their_range() {
    for range in [150.0_f64, 210.0, 250.0, 400.0] {
        let lamp = PointLight {
            intensity: 1e7,
            range: range as f32,
            ..default()
        };
        let (ratio, drawn) = against_a_point_light(lamp, Quat::IDENTITY);
        let expected = (1.0 - (200.0 / range).powi(4)).max(0.0).powi(2);
        println!("{range}: {ratio:.4}, {expected:.4}");
        assert!(
            (ratio - expected).abs() < 0.01,
            "{range}: {ratio}, {expected}"
        );
        assert_eq!(drawn == Some(0), range < 200.0, "{range}: {drawn:?}");
    }
}

/// A headlight across the view lights the same part of it, as brightly, as where every drop is lit by
/// itself: its cone is no disc where it meets a billboard.
#[test]
fn a_headlights_cone_is_where_single_drops_show_it() {
    // Mean light in blocks of the picture, from the eye on to six metres.
    let blocks = |method| {
        let rain = Rain {
            method,
            ..white_rain(50.0, 6.0)
        };
        let mut app = show(&VIEW, rain, 1.0 / 60.0, |world| {
            world.spawn((
                SpotLight {
                    intensity: 1e5,
                    range: 20.0,
                    outer_angle: 0.35,
                    inner_angle: 0.25,
                    ..default()
                },
                Transform::from_translation(VIEW.pose.translation + vec3(-3.4, 0.2, -4.0))
                    .looking_to(vec3(1.0, 0.0, 0.25), Vec3::Y),
            ));
        });
        no_surroundings(&mut app);
        set_time_step(&mut app, Duration::from_secs_f64(0.37));
        let camera = only::<Camera3d>(&mut app);
        let mut sums = [0.0; 8 * 6];
        let lamp = only::<SpotLight>(&mut app);
        for _ in 0..40 {
            // Other voxels, the same view of the lamp.
            for entity in [camera, lamp] {
                let mut place = app.world_mut().get_mut::<Transform>(entity).unwrap();
                place.translation += vec3(1.7, 0.9, 0.61);
            }
            step(&mut app, 1);
            let data = radiance(&app);
            for at in common::pixels(data.size) {
                let block = at * uvec2(8, 6) / data.size;
                sums[(block.y * 8 + block.x) as usize] += f64::from(data.f16x4(at.x, at.y)[1]);
            }
        }
        sums
    };
    let (streaks, drops) = (blocks(RainMethod::Streaks), blocks(RainMethod::PerDrop));
    let all: f64 = drops.iter().sum();
    let apart: f64 = streaks.iter().zip(&drops).map(|(a, b)| (a - b).abs()).sum();
    for sums in [&streaks, &drops] {
        for row in sums.chunks(8) {
            println!(
                "{:.3?}",
                row.iter().map(|sum| sum / all).collect::<Vec<_>>()
            );
        }
    }
    println!("{:.3}", apart / all);
    assert!(apart < 0.1 * all, "{}", apart / all);
}

/// A sun on another render layer than the camera's does not light its rain; of many suns the four
/// brightest do.
#[test]
fn suns_count_as_the_camera_sees_them() {
    let mut app = show_plain(white_rain(20.0, 10.0));
    no_surroundings(&mut app);
    let sun = |illuminance: f32| {
        (
            DirectionalLight {
                illuminance,
                ..default()
            },
            Transform::default().looking_to(vec3(0.1, -1.0, 0.4), Vec3::Y),
        )
    };
    let elsewhere = app
        .world_mut()
        .spawn((sun(10.0), RenderLayers::layer(3)))
        .id();
    settle(&mut app).unwrap();
    assert_eq!(mean(&radiance(&app)), 0.0);
    app.world_mut().despawn(elsewhere);
    for illuminance in [1.0, 2.0, 1.0, 1.0, 8.0, 4.0, 16.0] {
        app.world_mut().spawn(sun(illuminance));
    }
    settle(&mut app).unwrap();
    let many = mean(&radiance(&app));
    let world = app.world_mut();
    let suns: Vec<Entity> = world
        .query_filtered::<Entity, With<DirectionalLight>>()
        .iter(world)
        .collect();
    suns.into_iter().for_each(|sun| {
        world.despawn(sun);
    });
    world.spawn(sun(30.0));
    settle(&mut app).unwrap();
    let one = mean(&radiance(&app));
    assert!(
        one > 0.0 && (many / one - 1.0).abs() < 1e-2,
        "{many}, {one}"
    );
}

/// Parallel rays see far to the side: a lamp there lights the rain around it.
#[test]
fn a_lamp_at_the_side_of_an_orthographic_view_lights_its_rain() {
    let view = View {
        lens: Lens::Orthographic {
            height: 60.0,
            near: 0.0,
            far: 100.0,
        },
        ..VIEW
    };
    let mut app = show(&view, white_rain(50.0, 10.0), 1.0 / 60.0, |_| {});
    no_surroundings(&mut app);
    let lamp = app
        .world_mut()
        .spawn((
            PointLight {
                intensity: 1e5,
                range: 6.0,
                ..default()
            },
            Transform::from_translation(VIEW.pose.translation + vec3(30.0, 0.0, -5.0)),
        ))
        .id();
    settle(&mut app).unwrap();
    let aside = mean(&radiance(&app));
    let mut place = app.world_mut().get_mut::<Transform>(lamp).unwrap();
    place.translation.x -= 30.0;
    settle(&mut app).unwrap();
    let middle = mean(&radiance(&app));
    assert!(
        (aside / middle - 1.0).abs() < 0.3 && middle > 0.0,
        "{aside}, {middle}"
    );
}
