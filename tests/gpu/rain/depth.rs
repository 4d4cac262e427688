//! Rain among other things: before and behind them, and under a roof.

use super::*;

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

/// Liquid stands in the scene's depth: what rains behind it is hidden as behind a wall.
#[test]
fn liquids_hide_what_is_behind_them() {
    let radius = 0.06;
    // A wall of ink from 2.5 m on, three particles thick, wider than the view.
    let wall = (0..3 * 40 * 40).map(|i| {
        let at = vec3((i % 40) as f32, (i / 40 % 40) as f32, (i / 1600) as f32);
        (at - vec3(19.5, 19.5, 0.0)) * vec3(1.6, 1.6, -1.6) * radius - 2.5 * Vec3::Z
    });
    let wall: Vec<Vec3> = wall.collect();
    let mut app = new_app(VIEW.size, |app| {
        let plugin = RainPlugin {
            synchronous_bake: true,
        };
        app.add_plugins((plugin, FluidPlugin::default()))
            .insert_resource(GlobalAmbientLight {
                brightness: 1.0,
                ..default()
            });
        let camera = app.world_mut().spawn((
            camera(&VIEW, white_rain(20.0, 10.0)),
            ScreenSpaceFluid::default(),
        ));
        let camera = camera.id();
        let black = FluidMaterial {
            refractive_index: 1.0,
            medium: Medium::absorbing(LinearRgba::rgb(1e-4, 1e-4, 1e-4), 0.01),
            ..FluidMaterial::WATER
        };
        let ink = app
            .world_mut()
            .spawn((FluidParticles::new(wall, radius), black));
        let ink = ink.id();
        app.world_mut().entity_mut(camera).add_child(ink);
    });
    settle(&mut app).unwrap();
    // What the ink sends by itself must not be taken for rain.
    let camera = only::<Camera3d>(&mut app);
    app.world_mut().entity_mut(camera).remove::<Rain>();
    settle(&mut app).unwrap();
    let ink = mean(&radiance(&app));
    assert!(ink < 1e-4, "{ink}");
    set_rain(&mut app, white_rain(20.0, 10.0));
    let ratio = optical_depth(&mut app, 24) / (extinction(20.0) * 2.5);
    println!("{ratio:.4}");
    // As for the wall above, but its front is a particle's radius nearer.
    assert!((0.97..1.2).contains(&ratio), "{ratio}");
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
}

/// A shelter without volume, over everything in sight, is said to be none, and is none.
#[test]
fn a_shelter_without_volume_keeps_no_rain_off() {
    let mut app = show_plain(white_rain(20.0, 10.0));
    let wet = mean(&radiance(&app));
    let above = Transform::from_xyz(0.0, 60.0, 0.0);
    for (half_size, scale, named) in [
        (Vec3::NAN, Vec3::ONE, "entity"),
        (Vec3::splat(30.0), Vec3::ZERO, "shelter"),
    ] {
        let world = app.world_mut();
        let bundle = (RainShelter { half_size }, above.with_scale(scale));
        // Other tests' apps say much of entities with small numbers.
        let roof = (0..2000).map(|_| world.spawn_empty().id()).last().unwrap();
        world.entity_mut(roof).insert(bundle);
        settle(&mut app).unwrap();
        assert_eq!(mean(&radiance(&app)), wet);
        assert_eq!(log::count(&format!("{named} {roof}")), 1);
    }
}

/// The dry air under a roof leans as the rain does.
#[test]
fn wind_blows_rain_under_a_roof() {
    // A roof that covers the left half of what is seen at its middle, five metres above it.
    let wet = |wind: f32| {
        let rain = Rain {
            wind: vec2(wind, 0.0),
            ..white_rain(50.0, 6.0)
        };
        let mut app = show_plain(rain);
        let roof = (
            RainShelter {
                half_size: vec3(50.0, 0.5, 50.0),
            },
            Transform::from_translation(VIEW.pose.translation + vec3(-50.0, 5.5, 0.0)),
        );
        app.world_mut().spawn(roof);
        settle(&mut app).unwrap();
        let data = radiance(&app);
        let (left, right) = common::pixels(data.size)
            .map(|at| (at.x < 80, f64::from(data.f16x4(at.x, at.y)[1])))
            .fold((0.0, 0.0), |(left, right), (is_left, light)| {
                if is_left {
                    (left + light, right)
                } else {
                    (left, right + light)
                }
            });
        (left, right)
    };
    let (left, right) = wet(0.0);
    assert!(left < 0.02 * right && right > 1.0, "{left}, {right}");
    // From the right it is blown in, from the left it is kept off farther.
    let (blown_in, _) = wet(-5.0);
    let (_, kept_off) = wet(5.0);
    println!("{left:.2} {right:.2} {blown_in:.2} {kept_off:.2}");
    assert!(blown_in > 0.2 * right, "{blown_in}, {right}");
    assert!(kept_off < 0.8 * right, "{kept_off}, {right}");
}

/// Distances are metres whatever the camera's scale.
#[test]
fn a_scaled_camera_sees_the_same() {
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        let rain = Rain {
            method,
            extent: 100.0,
            ..white_rain(50.0, 4.0)
        };
        let look = |scale: f32| {
            let mut app = show_plain(rain);
            let camera = only::<Camera3d>(&mut app);
            let wall = spawn_black(app.world_mut(), AlphaMode::Opaque);
            let world = app.world_mut();
            world.get_mut::<Transform>(camera).unwrap().scale = Vec3::splat(scale);
            // As near a near plane, in metres.
            if let Projection::Perspective(lens) =
                &mut *world.get_mut::<Projection>(camera).unwrap()
            {
                lens.near /= scale;
            }
            let mut place = world.get_mut::<Transform>(wall).unwrap();
            place.translation += VIEW.pose.translation;
            settle(&mut app).unwrap();
            mean(&radiance(&app))
        };
        let (one, large, small) = (look(1.0), look(4.0), look(0.25));
        for other in [large, small] {
            assert!(
                (other / one - 1.0).abs() < 1e-3,
                "{method:?}: {one}, {other}"
            );
        }
    }
}
