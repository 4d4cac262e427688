//! Rain in the life of an app: cameras, settings, sizes, and no rain at all.

use bevy::{
    camera::RenderTarget,
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore},
    window::WindowRef,
};
use bevy_fluid::rain::{BAKE_PROGRESS, BAKE_TIME};

use super::*;
use crate::fallbacks::lose_device;

#[test]
fn a_game_without_rain_pays_nothing() {
    let mut plain = new_app(VIEW.size, |app| {
        app.world_mut().spawn((VIEW.plain_camera(), UNIT_EXPOSURE));
        spawn_box(
            app.world_mut(),
            Vec3::ONE,
            Transform::from_xyz(0.0, 50.0, -4.0),
        );
    });
    settle(&mut plain).unwrap();
    let plain = picture(&mut plain);

    let mut app = new_app(VIEW.size, |app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        });
        app.world_mut().spawn((VIEW.plain_camera(), UNIT_EXPOSURE));
        spawn_box(
            app.world_mut(),
            Vec3::ONE,
            Transform::from_xyz(0.0, 50.0, -4.0),
        );
    });
    settle(&mut app).unwrap();
    let nothing = |app: &App| {
        assert_eq!(quads(app), None);
        let spans = gpu_spans(app);
        assert!(!spans.iter().any(|span| span.contains("rain")), "{spans:?}");
        assert!(
            !spans.iter().any(|span| span.contains("transparent")),
            "{spans:?}"
        );
    };
    nothing(&app);
    let baked = |app: &App| app.world().resource::<BakedStreaks>().exposure().is_some();
    assert!(!baked(&app));
    assert!(picture(&mut app) == plain);
    // Rain of no rate is none.
    for rate in [0.0, -1.0, f32::NAN] {
        let camera = only::<Camera3d>(&mut app);
        app.world_mut()
            .entity_mut(camera)
            .insert(Rain::falling(rate));
        settle(&mut app).unwrap();
        nothing(&app);
        assert!(!baked(&app));
        assert!(picture(&mut app) == plain, "{rate}");
    }
    let camera = only::<Camera3d>(&mut app);
    app.world_mut().entity_mut(camera).insert(Rain::HEAVY);
    settle(&mut app).unwrap();
    assert!(picture(&mut app) != plain && baked(&app));
    app.world_mut().entity_mut(camera).remove::<Rain>();
    settle(&mut app).unwrap();
    assert_eq!(quads(&app), None);
    assert!(!baked(&app));
    assert!(picture(&mut app) == plain);
}

#[test]
fn the_same_seed_rains_the_same_and_another_does_not() {
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        let rain = |seed: u64| {
            let mut app = show_plain(Rain {
                method,
                ..white_rain(20.0, 4.0)
            });
            app.world_mut().resource_mut::<RainStreakSettings>().seed = seed;
            set_time_step(&mut app, Duration::from_millis(16));
            step(&mut app, 5);
            app
        };
        let (a, mut b) = (rain(0), rain(0));
        let first = radiance(&a).bytes;
        assert!(first == radiance(&b).bytes);
        step(&mut b, 1);
        assert!(first != radiance(&b).bytes, "nothing falls");
        for other in [1, 1 << 40] {
            assert!(first != radiance(&rain(other)).bytes, "{method:?}, {other}");
        }
    }
}

/// As a server or a unit test has it.
#[test]
fn without_a_renderer_rain_comes_and_goes() {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, RainPlugin::default()));
    let [first, second] = [(); 2].map(|()| {
        app.world_mut()
            .spawn((Transform::default(), Rain::HEAVY))
            .id()
    });
    app.update();
    app.world_mut().entity_mut(first).remove::<Rain>();
    app.world_mut().despawn(second);
    app.update();
}

/// One frame that takes long draws no textures anew.
#[test]
fn a_hitch_changes_no_exposure() {
    let mut app = show_plain(white_rain(20.0, 4.0));
    app.world_mut()
        .resource_mut::<RainStreakSettings>()
        .exposure = Exposure::FrameTime;
    let exposure = |app: &App| app.world().resource::<BakedStreaks>().exposure();
    set_time_step(&mut app, Duration::from_secs_f64(1.0 / 60.0));
    step(&mut app, 60);
    let before = exposure(&app);
    assert!((before.unwrap() - 1.0 / 60.0).abs() < 1e-4, "{before:?}");
    set_time_step(&mut app, Duration::from_millis(250));
    step(&mut app, 1);
    set_time_step(&mut app, Duration::from_secs_f64(1.0 / 60.0));
    step(&mut app, 3);
    assert_eq!(exposure(&app), before);
    // Many do.
    set_time_step(&mut app, Duration::from_millis(250));
    step(&mut app, 60);
    assert!(exposure(&app).unwrap() > 0.025);
}

#[test]
fn rates_beyond_all_measure_are_clamped() {
    let of = |rate| radiance(&show_plain(white_rain(rate, 5.0))).bytes;
    let most = of(200.0);
    assert!(most == of(1e6));
    assert!(most == of(f32::INFINITY));
    assert!(most != of(100.0));
}

#[test]
fn what_makes_no_sense_is_said_once() {
    let mut app = show_plain(white_rain(20.0, 5.0));
    // Other tests' apps say much of entities with small numbers.
    let other = only::<Camera3d>(&mut app);
    let world = app.world_mut();
    world.despawn(other);
    let camera = (0..1000).map(|_| world.spawn_empty().id()).last().unwrap();
    let bundle = self::camera(&VIEW, white_rain(20.0, 5.0));
    world.entity_mut(camera).insert(bundle);
    let said = |what: &str| log::count(&format!("entity {camera}: `Rain::{what}"));
    assert_eq!(said(""), 0);
    for frame in 0..3 {
        // Set anew in every frame, as by an animation.
        let rain = white_rain(1e6 + frame as f32, 5.0);
        app.world_mut().entity_mut(camera).insert(rain);
        step(&mut app, 1);
    }
    assert_eq!(said("rate` is 1000000; it must be from 0 to 200"), 1);
    assert_eq!(said("rate"), 1);
    set_rain(&mut app, white_rain(f32::NAN, 5.0));
    assert_eq!(said("rate"), 1);
    // Another field is another matter; and what is mended may be bad again.
    set_rain(&mut app, white_rain(20.0, -1.0));
    assert_eq!(said("distance"), 1);
    set_rain(&mut app, white_rain(20.0, 5.0));
    set_rain(&mut app, white_rain(-1.0, 5.0));
    assert_eq!(said("rate"), 2);
}

#[test]
fn the_camera_may_jump_a_kilometre() {
    let mut app = show_plain(white_rain(20.0, 5.0));
    let before = mean(&radiance(&app));
    let camera = only::<Camera3d>(&mut app);
    for jump in [
        vec3(1000.0, 0.0, 0.0),
        vec3(0.0, 1000.0, -1000.0),
        vec3(1e5, -1e4, 1e5),
    ] {
        app.world_mut()
            .get_mut::<Transform>(camera)
            .unwrap()
            .translation += jump;
        step(&mut app, 1);
        let after = mean(&radiance(&app));
        assert!(
            (after / before - 1.0).abs() < 0.25,
            "{jump}: {before}, {after}"
        );
    }
}

#[test]
fn orthographic_cameras_see_rain_all_over() {
    let view = View {
        lens: Lens::Orthographic {
            height: 6.0,
            near: 0.0,
            far: 100.0,
        },
        ..VIEW
    };
    let mut app = show(&view, white_rain(20.0, 10.0), 1.0 / 60.0, |_| {});
    let ratio = optical_depth(&mut app, 12) / (extinction(20.0) * 10.0);
    println!("{ratio:.4}");
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
    for x in 0..4 {
        let data = radiance(&app);
        let column = (40 * x..40 * (x + 1)).flat_map(|x| (0..120).map(move |y| (x, y)));
        assert!(column.map(|(x, y)| data.f16x4(x, y)[0]).sum::<f32>() > 0.0);
    }
}

#[test]
fn two_cameras_see_the_same_rain() {
    let half = |x: u32| Camera {
        viewport: Some(Viewport {
            physical_position: uvec2(x, 0),
            physical_size: uvec2(80, 120),
            ..default()
        }),
        order: x as isize,
        clear_color: if x == 0 {
            ClearColorConfig::Custom(Color::BLACK)
        } else {
            ClearColorConfig::None
        },
        ..default()
    };
    let rain = Rain {
        wind: vec2(4.0, -3.0),
        ..white_rain(50.0, 10.0)
    };
    let mut app = new_app(VIEW.size, |app| {
        app.add_plugins(RainPlugin {
            synchronous_bake: true,
        })
        .insert_resource(GlobalAmbientLight {
            brightness: 1.0,
            ..default()
        });
        // One of them has been elsewhere in the meantime.
        for (x, height) in [(0, 0.0), (80, 300.0)] {
            let mut second = app.world_mut().spawn(camera(&VIEW, rain));
            second.insert(half(x));
            let mut place = second.get_mut::<Transform>().unwrap();
            place.translation.y += height;
        }
    });
    settle(&mut app).unwrap();
    set_time_step(&mut app, Duration::from_millis(16));
    step(&mut app, 5);
    let world = app.world_mut();
    for mut place in world
        .query_filtered::<&mut Transform, With<Camera3d>>()
        .iter_mut(world)
    {
        *place = VIEW.pose;
    }
    step(&mut app, 2);
    let image = picture(&mut app);
    let (mut lit, mut differ) = (0, 0);
    for y in 0..120 {
        for x in 0..80 {
            let (a, b) = (image.get_pixel(x, y).0[0], image.get_pixel(x + 80, y).0[0]);
            lit += u32::from(a > 5);
            differ += u32::from(a.abs_diff(b) > 2);
        }
    }
    assert!(lit > 1000 && differ == 0, "{lit} lit, {differ} differ");
}

#[test]
fn sizes_and_samples_may_change() {
    let mut app = show_plain(white_rain(20.0, 5.0));
    let whole = mean(&radiance(&app));
    let camera = only::<Camera3d>(&mut app);
    for (size, msaa) in [
        (uvec2(1, 1), Msaa::Off),
        (uvec2(33, 7), Msaa::Sample4),
        (uvec2(300, 200), Msaa::Off),
        (uvec2(160, 120), Msaa::Sample4),
    ] {
        resize(&mut app, size).unwrap();
        app.world_mut().entity_mut(camera).insert(msaa);
        settle(&mut app).unwrap();
        let data = radiance(&app);
        assert_eq!(data.size, size);
        // All see about as much; a single ray meets voxels by chance.
        let slack = if size == UVec2::ONE { 0.6 } else { 0.25 };
        let opacity = mean(&data);
        assert!(
            (opacity / whole - 1.0).abs() < slack,
            "{size}: {opacity}, {whole}"
        );
    }
}

/// Several samples a pixel change nothing of how much light drops take.
#[test]
fn samples_take_no_light() {
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        let mut app = show_plain(Rain {
            method,
            ..white_rain(20.0, 4.0)
        });
        let single = mean(&radiance(&app));
        let camera = only::<Camera3d>(&mut app);
        app.world_mut().entity_mut(camera).insert(Msaa::Sample4);
        settle(&mut app).unwrap();
        let ratio = mean(&radiance(&app)) / single;
        println!("{method:?}: {ratio:.4}");
        assert!((ratio - 1.0).abs() < 0.01, "{method:?}: {ratio}");
    }
}

/// Beyond the streaks the scene fades as e^(−β way).
#[test]
fn the_background_fades_beyond_the_streaks() {
    let mut app = show_plain(white_rain(50.0, 1.0));
    let near = mean(&radiance(&app));
    let camera = only::<Camera3d>(&mut app);
    app.world_mut().entity_mut(camera).insert(Rain {
        extent: 201.0,
        ..white_rain(50.0, 1.0)
    });
    settle(&mut app).unwrap();
    let far = mean(&radiance(&app));
    let expected = 1.0 - (-extinction(50.0) * 200.0).exp();
    assert!(
        (far - near - expected).abs() < 0.01,
        "{near}, {far}, {expected}"
    );
}

/// While textures are drawn in the background, frames go on.
#[test]
fn textures_come_without_being_waited_for() {
    let mut app = new_app(VIEW.size, |app| {
        app.add_plugins(RainPlugin::default());
        app.world_mut().spawn(camera(&VIEW, Rain::HEAVY));
    });
    let settled = |app: &App| app.world().resource::<BakedStreaks>().is_settled();
    let measured = |app: &App, path: &DiagnosticPath| {
        let store = app.world().resource::<DiagnosticsStore>();
        store.get(path).and_then(Diagnostic::value)
    };
    step(&mut app, 1);
    assert!(!settled(&app) && quads(&app).is_none());
    assert_eq!(measured(&app, &BAKE_TIME), None);
    let mut progress = vec![0.0];
    for _ in 0..2000 {
        progress.extend(measured(&app, &BAKE_PROGRESS));
        if settled(&app) {
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
        step(&mut app, 1);
    }
    assert!(settled(&app));
    assert!(progress.is_sorted(), "{progress:?}");
    assert_eq!(progress.last(), Some(&1.0));
    assert!(measured(&app, &BAKE_TIME) > Some(0.0));
    settle(&mut app).unwrap();
    assert!(quads(&app).is_some());
}

/// Entities of the render world: a device that is lost must not leave some behind.
fn render_entities(app: &App) -> usize {
    let world = app.sub_app(RenderApp).world();
    world.iter_entities().count()
}

#[test]
fn a_lost_device_is_survived() {
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        let rain = Rain {
            method,
            ..white_rain(20.0, 6.0)
        };
        let mut app = show_plain(rain);
        let before = picture(&mut app);
        lose_device(&mut app);
        let entities = render_entities(&app);
        assert!(picture(&mut app) == before, "{method:?}");
        assert!(validation_errors(&app).is_empty());
        lose_device(&mut app);
        assert!(picture(&mut app) == before, "{method:?}, again");
        assert_eq!(render_entities(&app), entities, "{method:?}");
    }
}

/// Of two windows one has no surface, as if minimised, and is closed: the other's rain falls on.
#[test]
fn a_window_that_is_closed_stops_no_rain_elsewhere() {
    let mut both = show_plain(white_rain(20.0, 4.0));
    let mut alone = show_plain(white_rain(20.0, 4.0));
    let window = both.world_mut().spawn(Window::default()).id();
    let target = RenderTarget::Window(WindowRef::Entity(window));
    let beside = (camera(&VIEW, white_rain(20.0, 4.0)), target);
    both.world_mut().spawn(beside);
    settle(&mut both).unwrap();
    let fall = |both: &mut App, alone: &mut App| {
        for app in [&mut *both, &mut *alone] {
            set_time_step(app, Duration::from_secs_f64(1.0 / 60.0));
            step(app, 2);
        }
        let seen = picture(both);
        assert!(seen == picture(alone));
        seen
    };
    let minimised = fall(&mut both, &mut alone);
    both.world_mut().despawn(window);
    let closed = fall(&mut both, &mut alone);
    assert!(closed != minimised, "nothing falls");
}
