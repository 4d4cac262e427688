//! What rain looks like, measured on the GPU, and what it costs a game without any.

mod common;
#[path = "rain/life.rs"]
mod life;

use core::time::Duration;

use bevy::{
    camera::{Exposure as CameraExposure, Viewport},
    core_pipeline::tonemapping::DebandDither,
    prelude::*,
    render::{RenderApp, view::ViewTarget},
};
use bevy_fluid::{
    prelude::*,
    rain::{
        BakedStreaks, Exposure, RainMethod, RainQuads, RainShelter, RainStreaks,
        drops::{LARGEST, SMALLEST, extinction, extinction_between},
        phase::phase,
    },
};
use common::{Lens, View, only, settle, spawn_box};
use fluid_stage::{
    TextureData, capture, gpu_spans, headless_app, read_texture, resize, set_time_step, step,
    validation_errors,
};
use image::RgbaImage;

/// At this setting a luminance of 1 cd/m² is a pixel of 1.
const UNIT_EXPOSURE: CameraExposure = CameraExposure {
    ev100: -0.263_034_4,
};

const VIEW: View = View {
    size: uvec2(160, 120),
    lens: Lens::Perspective {
        fov: 0.9,
        near: 0.05,
    },
    pose: Transform::from_xyz(0.3, 50.2, 0.7),
};

/// Rain that is as bright as opaque from all around, and nothing beyond it: a pixel is its opacity.
fn white_rain(rate: f32, distance: f32) -> Rain {
    Rain {
        distance,
        extent: 0.0,
        ..Rain::falling(rate)
    }
}

fn camera(view: &View, rain: Rain) -> impl Bundle {
    (
        view.plain_camera(),
        UNIT_EXPOSURE,
        DebandDither::Disabled,
        rain,
    )
}

/// An app in which rain falls before black, lit by 1 cd/m² from all around.
fn show(view: &View, rain: Rain, exposure: f32, scene: impl FnOnce(&mut World)) -> App {
    let mut app = headless_app(view.size, |app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        })
        .insert_resource(RainStreaks {
            exposure: Exposure::Seconds(exposure),
            ..default()
        });
        let world = app.world_mut();
        world.insert_resource(GlobalAmbientLight {
            brightness: 1.0,
            ..default()
        });
        world.spawn(camera(view, rain));
        scene(world);
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

fn show_plain(rain: Rain) -> App {
    show(&VIEW, rain, 1.0 / 60.0, |_| {})
}

/// The camera's picture before it is rounded to 8 bits.
fn radiance(app: &App) -> TextureData {
    let target = app
        .sub_app(RenderApp)
        .world()
        .iter_entities()
        .find_map(|entity| entity.get::<ViewTarget>())
        .unwrap();
    assert!(validation_errors(app).is_empty());
    read_texture(app, target.main_texture()).unwrap()
}

fn mean(data: &TextureData) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..data.size.y {
        for x in 0..data.size.x {
            sum += f64::from(data.f16x4(x, y)[1]);
            count += 1.0;
        }
    }
    sum / count
}

/// Optical depth of the rain in view, over `looks` directions and moments.
fn optical_depth(app: &mut App, looks: u32) -> f64 {
    set_time_step(app, Duration::from_secs_f64(0.37));
    let camera = only::<Camera3d>(app);
    let mut sum = 0.0;
    for look in 0..looks {
        let mut transform = app.world_mut().get_mut::<Transform>(camera).unwrap();
        transform.rotation = Quat::from_rotation_y(2.4 * look as f32);
        transform.translation += vec3(1.7, 0.9, 2.3);
        step(app, 1);
        sum += mean(&radiance(app));
    }
    set_time_step(app, Duration::ZERO);
    -(1.0 - sum / f64::from(looks)).ln()
}

fn quads(app: &App) -> Option<usize> {
    app.sub_app(RenderApp)
        .world()
        .iter_entities()
        .find_map(|entity| entity.get::<RainQuads>())
        .map(RainQuads::len)
}

/// METHOD 7: the mean transmittance over a length L is e^(−βL), whatever the exposure. It is the
/// exponent that is compared: transmittances are all near 1.
#[test]
fn rain_takes_as_much_light_as_its_drops() {
    for exposure in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0] {
        let mut app = show(&VIEW, white_rain(1.0, 10.0), exposure, |_| {});
        let camera = only::<Camera3d>(&mut app);
        for rate in [1.0, 5.0, 10.0, 20.0] {
            app.world_mut()
                .entity_mut(camera)
                .insert(white_rain(rate, 10.0));
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

/// A wall two and a half metres away hides what is behind it, to the part of a voxel.
#[test]
fn the_scene_hides_what_is_behind_it() {
    let mut app = show_plain(white_rain(20.0, 10.0));
    let camera = only::<Camera3d>(&mut app);
    let wall = spawn_black(app.world_mut(), AlphaMode::Opaque);
    app.world_mut().entity_mut(camera).add_child(wall);
    // Rays to the corners are longer.
    let ratio = optical_depth(&mut app, 24) / (extinction(20.0) * 2.5);
    println!("{ratio:.4}");
    assert!((1.0..1.2).contains(&ratio), "{ratio}");
}

/// A transparent thing hides as much, though it is drawn among the voxels.
#[test]
fn transparent_things_sort_between_the_voxels() {
    let mut app = show_plain(white_rain(20.0, 10.0));
    let camera = only::<Camera3d>(&mut app);
    set_time_step(&mut app, Duration::from_secs_f64(0.37));
    let mut sum = 0.0;
    for _ in 0..8 {
        // Bevy sorts a thing that moves by where it was at first: this one is a new one each time.
        let mut place = app.world_mut().get_mut::<Transform>(camera).unwrap();
        place.translation += vec3(1.7, 0.9, 2.3);
        let wall_place = place.translation - 2.5 * Vec3::Z;
        let wall = spawn_black(app.world_mut(), AlphaMode::Blend);
        let pose = Transform::from_translation(wall_place);
        app.world_mut().entity_mut(wall).insert(pose);
        settle(&mut app).unwrap();
        for _ in 0..3 {
            step(&mut app, 1);
            sum += mean(&radiance(&app)) / 24.0;
        }
        app.world_mut().despawn(wall);
    }
    let ratio = -(1.0 - sum).ln() / (extinction(20.0) * 2.5);
    println!("{ratio:.4}");
    // Voxels, two thirds of a metre of them at a time, are drawn before or after it as a whole.
    assert!((0.75..1.3).contains(&ratio), "{ratio}");
}

/// A black wall across the view, 2.5 m ahead.
fn spawn_black(world: &mut World, alpha_mode: AlphaMode) -> Entity {
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Rectangle::new(20.0, 20.0));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial {
            base_color: Color::BLACK,
            unlit: true,
            alpha_mode,
            ..default()
        });
    world
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_xyz(0.0, 0.0, -2.5),
        ))
        .id()
}

#[test]
fn it_is_dry_under_a_shelter() {
    // A roof over everything in sight.
    let mut app = show_plain(white_rain(20.0, 10.0));
    let wet = mean(&radiance(&app));
    let half_size = vec3(30.0, 0.5, 30.0);
    let roof = app
        .world_mut()
        .spawn((
            RainShelter { half_size },
            Transform::from_xyz(0.0, 60.0, 0.0),
        ))
        .id();
    settle(&mut app).unwrap();
    assert_eq!(mean(&radiance(&app)), 0.0);
    // The same below the camera keeps nothing off but what falls deeper than it.
    let mut place = app.world_mut().get_mut::<Transform>(roof).unwrap();
    place.translation.y = -60.0;
    settle(&mut app).unwrap();
    assert_eq!(mean(&radiance(&app)), wet);
    // One that has no volume is said to be none.
    app.world_mut().entity_mut(roof).insert(RainShelter {
        half_size: Vec3::NAN,
    });
    settle(&mut app).unwrap();
    assert_eq!(mean(&radiance(&app)), wet);
}

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
    app.world_mut()
        .resource_mut::<GlobalAmbientLight>()
        .brightness = 0.0;
    settle(&mut app).unwrap();
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
    app.world_mut()
        .resource_mut::<GlobalAmbientLight>()
        .brightness = 0.0;
    settle(&mut app).unwrap();
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
        app.world_mut()
            .resource_mut::<GlobalAmbientLight>()
            .brightness = 0.0;
        settle(&mut app).unwrap();
        mean(&radiance(&app))
    };
    let ratio = at(200.0) / at(400.0);
    assert!((ratio / 4.0 - 1.0).abs() < 0.1, "{ratio}");
}

/// The phase function that shaders have is the one that is documented.
#[test]
fn light_goes_where_the_phase_function_says() {
    let view = View {
        lens: Lens::Perspective {
            fov: 0.05,
            near: 0.05,
        },
        ..VIEW
    };
    let mut app = show(&view, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
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

fn picture(app: &mut App) -> RgbaImage {
    capture(app).unwrap()
}
