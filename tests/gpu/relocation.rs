//! The same picture after the world was shifted; and what no camera sees is not shaped.

use std::time::Duration;

use crate::common::*;
use bevy::{
    camera::visibility::RenderLayers, core_pipeline::tonemapping::DebandDither, prelude::*,
};
use bevy_fluid::{
    particles::ShapedFluid,
    prelude::*,
    rain::{Exposure, RainShelter, RainStreakSettings},
};
use fluid_stage::{capture, headless_app, set_time_step, step};
use image::RgbaImage;

const VIEW: View = View {
    size: uvec2(160, 120),
    lens: Lens::Perspective {
        fov: 0.8,
        near: 0.1,
    },
    pose: Transform::from_xyz(0.25, 0.5, 4.0),
};

/// Moves everything without a parent, and says so.
fn shift(app: &mut App, way: Vec3) {
    let world = app.world_mut();
    let mut roots = world.query_filtered::<&mut Transform, Without<ChildOf>>();
    for mut root in roots.iter_mut(world) {
        root.translation += way;
    }
    world.write_message(WorldShift(way));
}

/// Puts the only camera's picture over gray: both ink and rain show.
fn over_gray(app: &mut App) {
    let camera = only::<Camera3d>(app);
    let mut camera = app.world_mut().get_mut::<Camera>(camera).unwrap();
    camera.clear_color = ClearColorConfig::Custom(Color::srgb(0.5, 0.5, 0.5));
}

/// Pixels that differ by more than `slack` in any channel.
fn differing(a: &RgbaImage, b: &RgbaImage, slack: u8) -> usize {
    let pairs = a.pixels().zip(b.pixels());
    let differ = |(a, b): &(&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > slack)
    };
    pairs.filter(differ).count()
}

/// A fountain over a floor with a box beside it.
fn fountain(world: &mut World) {
    world.spawn((
        ParticleEmitter::fountain(2000.0, 4.0),
        FluidMaterial::INK,
        Transform::from_xyz(0.0, -0.5, 0.0),
    ));
    world.spawn((
        ParticleCollider::ground(),
        Transform::from_xyz(0.0, -1.0, 0.0),
    ));
    spawn_box(
        world,
        vec3(0.5, 1.0, 0.5),
        Transform::from_xyz(1.25, -0.5, -1.0),
    );
}

/// A floating origin: in one frame everything is moved by the same way, while nothing else moves.
#[test]
fn a_fountain_comes_along_when_the_world_is_shifted() {
    let mut app = headless_app(uvec2(160, 120), |app| {
        app.add_plugins(FluidPlugin::default())
            .insert_resource(ClearColor(Color::WHITE));
        let world = app.world_mut();
        world.spawn((Camera3d::default(), ScreenSpaceFluid::default()));
        let at = Transform::from_xyz(0.0, -1.0, -4.0);
        let fountain = ParticleEmitter::fountain(2000.0, 4.0);
        world.spawn((fountain, FluidMaterial::INK, at));
    })
    .unwrap();
    settle(&mut app).unwrap();
    set_time_step(&mut app, Duration::from_secs_f64(1.0 / 60.0));
    step(&mut app, 90);
    let before = capture(&mut app).unwrap();
    set_time_step(&mut app, Duration::ZERO);
    shift(&mut app, Vec3::X * -1000.0);
    let dark = |picture: &RgbaImage| picture.pixels().filter(|it| it.0[0] < 128).count();
    let ink = dark(&before);
    assert!(ink > 200, "{ink}");
    for _ in 0..2 {
        step(&mut app, 1);
        let after = dark(&capture(&mut app).unwrap());
        assert!(
            after.abs_diff(ink) < 40,
            "{ink} pixels of ink, then {after}"
        );
    }
}

/// By 10 km, under a fountain, a shelter and rain in the wind: in the frame of the shift and after it
/// the picture is that of an app that was not shifted.
#[test]
fn h63_a_shifted_world_looks_the_same() {
    let build = || {
        let mut app = headless_app(VIEW.size, |app| {
            app.add_plugins((
                FluidPlugin::default(),
                RainPlugin {
                    synchronous_bake: true,
                },
            ))
            .insert_resource(RainStreakSettings {
                exposure: Exposure::Seconds(1.0 / 60.0),
                ..default()
            })
            .insert_resource(GlobalAmbientLight {
                brightness: 2000.0,
                ..default()
            });
            let world = app.world_mut();
            let rain = Rain {
                wind: vec2(2.0, -1.0),
                distance: 10.0,
                extent: 0.0,
                brightness: 4.0,
                ..Rain::HEAVY
            };
            let camera = VIEW.camera(ScreenSpaceFluid::default());
            world.spawn((camera, DebandDither::Disabled, rain));
            world.spawn((
                RainShelter {
                    half_size: vec3(1.0, 0.1, 1.0),
                },
                Transform::from_xyz(-2.0, 2.0, 0.0),
            ));
            fountain(world);
        })
        .unwrap();
        over_gray(&mut app);
        settle(&mut app).unwrap();
        set_time_step(&mut app, Duration::from_secs_f64(1.0 / 64.0));
        step(&mut app, 60);
        app
    };
    let (mut still, mut shifted) = (build(), build());
    let first = capture(&mut still).unwrap();
    assert!(first == capture(&mut shifted).unwrap());
    // A step of f32 at 10 km is 1/1024 m: what is given in 1/64 m does not move at all.
    for (frame, way) in [
        Some(vec3(-10_000.0, 512.0, 8000.0)),
        None,
        Some(vec3(10_000.0, -512.0, -8000.0)),
        None,
    ]
    .into_iter()
    .enumerate()
    {
        if let Some(way) = way {
            shift(&mut shifted, way);
        }
        step(&mut still, 1);
        step(&mut shifted, 1);
        let (expected, picture) = (capture(&mut still).unwrap(), capture(&mut shifted).unwrap());
        let differ = differing(&expected, &picture, 12);
        // Drops on the move fill hundreds of pixels anew in each frame.
        let moved = differing(&expected, &first, 12);
        assert!(moved > 1000, "{moved}");
        assert!(
            15 * differ < moved,
            "frame {frame}: {differ} pixels differ, {moved} have moved"
        );
    }
}

/// Without fluids nothing is rounded: rain is the same bit for bit, however far and often the world
/// is shifted.
#[test]
fn h63_rain_is_the_same_after_many_shifts() {
    let build = || {
        let mut app = headless_app(VIEW.size, |app| {
            app.add_plugins(RainPlugin {
                synchronous_bake: true,
            })
            .insert_resource(GlobalAmbientLight {
                brightness: 2000.0,
                ..default()
            });
            let rain = Rain {
                wind: vec2(2.0, -1.0),
                ..Rain::HEAVY
            };
            app.world_mut().spawn((VIEW.plain_camera(), rain));
        })
        .unwrap();
        settle(&mut app).unwrap();
        set_time_step(&mut app, Duration::from_secs_f64(1.0 / 64.0));
        step(&mut app, 10);
        app
    };
    let (mut flying, mut shifted) = (build(), build());
    // One camera flies 3000 km; under the other the world is shifted instead. Both places are
    // multiples of what f32 resolves there.
    let way = vec3(65_536.0, 2048.0, -98_304.0);
    let camera = only::<Camera3d>(&mut flying);
    for frame in 0..30 {
        let mut place = flying.world_mut().get_mut::<Transform>(camera).unwrap();
        place.translation += way;
        shifted.world_mut().write_message(WorldShift(-way));
        step(&mut flying, 1);
        step(&mut shifted, 1);
        if frame % 10 == 9 {
            let (expected, picture) = (
                capture(&mut flying).unwrap(),
                capture(&mut shifted).unwrap(),
            );
            let lit = expected.pixels().filter(|it| it.0[0] > 5).count();
            assert!(lit > 1000, "{lit}");
            let differ = differing(&expected, &picture, 0);
            assert_eq!(differ, 0, "of {lit} pixels, frame {frame}");
        }
    }
}

fn generation(app: &App, fluid: Entity) -> u64 {
    app.world().get::<ShapedFluid>(fluid).unwrap().generation()
}

/// Hidden, on another layer, out of view, or by a camera that is off: particles fly on unshaped, and
/// are there in the frame in which they are seen again.
#[test]
fn what_no_camera_sees_is_not_shaped() {
    let build = || {
        let mut app = show(&VIEW, ScreenSpaceFluid::default(), fountain);
        over_gray(&mut app);
        set_time_step(&mut app, Duration::from_secs_f64(1.0 / 64.0));
        step(&mut app, 40);
        app
    };
    let ways: [(&str, fn(&mut World, [Entity; 2], bool)); 5] = [
        ("hidden", |world, [_, fluid], away| {
            let visibility = if away {
                Visibility::Hidden
            } else {
                Visibility::Inherited
            };
            world.entity_mut(fluid).insert(visibility);
        }),
        ("on another layer", |world, [_, fluid], away| {
            let layers = RenderLayers::layer(usize::from(away));
            world.entity_mut(fluid).insert(layers);
        }),
        ("behind the camera", |world, [camera, _], away| {
            let turn = if away { std::f32::consts::PI } else { 0.0 };
            let mut place = world.get_mut::<Transform>(camera).unwrap();
            place.rotation = Quat::from_rotation_y(turn);
        }),
        ("by a camera that is off", |world, [camera, _], away| {
            world.get_mut::<Camera>(camera).unwrap().is_active = !away;
        }),
        (
            "by a camera that draws no fluids",
            |world, [camera, _], away| {
                let mut camera = world.entity_mut(camera);
                if away {
                    camera.remove::<ScreenSpaceFluid>();
                } else {
                    camera.insert(ScreenSpaceFluid::default());
                }
            },
        ),
    ];
    let (mut seen, mut app) = (build(), build());
    let [camera, fluid] = [only::<Camera3d>(&mut app), only::<FluidParticles>(&mut app)];
    for (name, set) in ways {
        set(app.world_mut(), [camera, fluid], true);
        let shaped = generation(&app, fluid);
        let before = app.world().get::<FluidParticles>(fluid).unwrap().clone();
        step(&mut app, 20);
        assert_eq!(generation(&app, fluid), shaped, "{name}");
        let after = app.world().get::<FluidParticles>(fluid).unwrap();
        assert_ne!(after.positions, before.positions, "they fly on");
        set(app.world_mut(), [camera, fluid], false);
        step(&mut app, 1);
        assert_eq!(generation(&app, fluid), shaped + 1, "{name}");
        step(&mut seen, 21);
        let (picture, expected) = (capture(&mut app).unwrap(), capture(&mut seen).unwrap());
        assert!(picture == expected, "{name}");
        let ink = picture.pixels().filter(|it| it.0[0] < 100).count();
        assert!(ink > 200, "{ink} pixels of ink");
    }
}

/// What flew out of view is not drawn where it was seen last, and a jump leaves nothing there.
#[test]
fn h64_what_leaves_the_view_leaves_no_ghost() {
    let mut app = show(&VIEW, ScreenSpaceFluid::default(), fountain);
    over_gray(&mut app);
    let plain = {
        let fluid = only::<FluidParticles>(&mut app);
        app.world_mut().entity_mut(fluid).insert(Visibility::Hidden);
        step(&mut app, 1);
        let plain = capture(&mut app).unwrap();
        app.world_mut()
            .entity_mut(fluid)
            .insert(Visibility::Inherited);
        plain
    };
    let fluid = only::<FluidParticles>(&mut app);
    set_time_step(&mut app, Duration::from_secs_f64(1.0 / 64.0));
    step(&mut app, 40);
    assert!(differing(&capture(&mut app).unwrap(), &plain, 5) > 300);
    let way = Vec3::X * 50.0;
    let mut place = app.world_mut().get_mut::<Transform>(fluid).unwrap();
    place.translation += way;
    app.world_mut()
        .write_message(Teleport::of(fluid).carrying(way));
    for frame in 0..3 {
        step(&mut app, 1);
        let picture = capture(&mut app).unwrap();
        assert_eq!(differing(&picture, &plain, 5), 0, "frame {frame}");
    }
    // A camera that follows sees it as before.
    let camera = only::<Camera3d>(&mut app);
    let mut eye = app.world_mut().get_mut::<Transform>(camera).unwrap();
    eye.translation += way;
    step(&mut app, 1);
    assert!(differing(&capture(&mut app).unwrap(), &plain, 5) > 300);
}

/// A fluid in a hierarchy whose scale changes in each frame, passes zero and mirrors: each frame is
/// that of an app that starts so, and without an extent there is nothing.
#[test]
fn h72_a_scale_may_pass_zero_and_mirror() {
    let liquid = |scale: Vec3| {
        let corner = |i: u32| ivec3(i as i32 % 4, i as i32 / 4 % 4, i as i32 / 16);
        let mut block: Vec<_> = (0..64).map(|i| corner(i).as_vec3() * 0.2 - 0.3).collect();
        // Something to mirror.
        block.push(vec3(0.7, 0.6, 0.0));
        move |world: &mut World| {
            let arm = (
                Transform::from_xyz(0.25, 0.5, 0.0).with_scale(scale),
                Visibility::default(),
            );
            let fluid = fluid(&block, 0.1, SurfaceKernel::default());
            let turned = Transform::from_rotation(Quat::from_rotation_z(0.4));
            let arm = world.spawn(arm).id();
            let fluid = world.spawn((fluid, turned)).insert(FluidMaterial::INK).id();
            world.entity_mut(arm).add_child(fluid);
        }
    };
    let settings = ScreenSpaceFluid::default();
    let mut app = show(&VIEW, settings, liquid(Vec3::ONE));
    over_gray(&mut app);
    let arm = only::<Children>(&mut app);
    let scales = [1.0_f32, 0.5, 0.25, 0.0, -0.25, -0.7, -1.0, 0.0, 0.8];
    for axes in [Vec3::ONE, Vec3::X] {
        for scale in scales {
            let scale = Vec3::ONE + (scale - 1.0) * axes;
            app.world_mut().get_mut::<Transform>(arm).unwrap().scale = scale;
            step(&mut app, 1);
            let picture = capture(&mut app).unwrap();
            let dark = picture.pixels().filter(|it| it.0[0] < 100).count();
            if scale.element_product() == 0.0 {
                assert_eq!(dark, 0, "nothing at {scale}");
                continue;
            }
            assert!(dark > 0, "something at {scale}");
            let mut fresh = show(&VIEW, settings, liquid(scale));
            over_gray(&mut fresh);
            step(&mut fresh, 1);
            assert!(picture == capture(&mut fresh).unwrap(), "{scale}");
        }
    }
}
