//! What reads the scene's depth after the opaque pass finds the liquid in it: decals and soft
//! particles, transparency that is independent of order, depth of field. And views whose main pass
//! is drawn smaller.

use super::*;
use bevy::{
    camera::MainPassResolutionOverride,
    core_pipeline::oit::OrderIndependentTransparencySettings,
    pbr::{
        ExtendedMaterial,
        decal::{ForwardDecal, ForwardDecalMaterial, ForwardDecalMaterialExt},
    },
    render::{Extract, ExtractSchedule, RenderApp, sync_world::RenderEntity},
};
use bevy_post_process::{PostProcessPlugin, dof::DepthOfField};

/// Where the nearest point of the scene's ball lies.
const FRONT: f32 = -2.5;

/// A ball of milk, or an opaque one at the same place.
fn milk_or_mesh(milk: bool, more: impl FnOnce(&mut App, Entity)) -> App {
    let mut app = headless_app(SIZE, |app| {
        let (color, at) = (Color::srgb(0.05, 0.05, 0.05), Vec3::NEG_Z * 3.0);
        let mut camera = Entity::PLACEHOLDER;
        fill(app, color, FluidMaterial::MILK, |_, it| camera = it);
        if !milk {
            let world = app.world_mut();
            let fluid = world
                .query_filtered::<Entity, With<FluidParticles>>()
                .single(world);
            world.despawn(fluid.unwrap());
            let mesh = world
                .resource_mut::<Assets<Mesh>>()
                .add(Sphere::new(0.5).mesh().uv(64, 32));
            let white = world
                .resource_mut::<Assets<StandardMaterial>>()
                .add(unlit(Color::WHITE));
            let at = Transform::from_translation(at);
            world.spawn((Mesh3d(mesh), MeshMaterial3d(white), at));
        }
        more(app, camera);
    })
    .unwrap();
    settle(&mut app).unwrap();
    app
}

/// How red a pixel is.
fn red([r, g, b, _]: [u8; 4]) -> i32 {
    i32::from(r) - i32::from(g.max(b))
}

/// A red decal that fades within 15 cm of a depth.
fn decal(app: &mut App, depth: f32) {
    let world = app.world_mut();
    let mut materials = world.resource_mut::<Assets<ForwardDecalMaterial<StandardMaterial>>>();
    let material = materials.add(ExtendedMaterial {
        base: blended(Color::srgb(1.0, 0.0, 0.0)),
        extension: ForwardDecalMaterialExt {
            depth_fade_factor: 0.15,
        },
    });
    // Its quad lies in the plane y = 0.
    let place = Transform::from_xyz(0.0, 0.0, depth)
        .with_rotation(Quat::from_rotation_x(core::f32::consts::FRAC_PI_2))
        .with_scale(Vec3::splat(0.4));
    world.spawn((ForwardDecal, MeshMaterial3d(material), place));
}

/// A decal shows on a surface near it: by the depth that soft particles fade by too.
#[test]
fn a_decal_on_milk_is_as_on_an_opaque_thing() {
    // By how far behind the milk's front it lies.
    for (behind, shows) in [(0.0, true), (0.3, false)] {
        let [milk, mesh] = [true, false].map(|milk| {
            let mut app = milk_or_mesh(milk, |app, _| decal(app, FRONT - behind));
            red(pixel(&mut app, MIDDLE))
        });
        assert!((milk > 100) == shows, "{behind} m: {milk}");
        assert!(shows == (mesh > 100), "{behind} m: {mesh}");
    }
}

#[test]
fn panes_independent_of_order_are_hidden_by_milk_as_by_an_opaque_thing() {
    for (depth, shows) in [(FRONT + 0.5, true), (FRONT - 0.5, false), (-5.0, false)] {
        let [milk, mesh] = [true, false].map(|milk| {
            let mut app = milk_or_mesh(milk, |app, camera| {
                let world = app.world_mut();
                let settings = OrderIndependentTransparencySettings::default();
                world.entity_mut(camera).insert((settings, Msaa::Off));
                let pane = blended(Color::srgba(1.0, 0.0, 0.0, 0.8));
                paint(world, vec3(0.4, 0.4, 0.02), pane, vec3(0.0, 0.0, depth));
            });
            red(pixel(&mut app, MIDDLE))
        });
        assert!((milk > 60) == shows, "{depth}: {milk}");
        assert!((mesh > 60) == shows, "{depth}: {mesh}");
    }
}

/// The largest difference that a blur makes within 4 pixels inside of the ball's silhouette.
fn blurred_edge(milk: bool, msaa: Msaa, focal_distance: f32) -> u8 {
    let [sharp, blurred] = [false, true].map(|blur| {
        let mut app = milk_or_mesh(milk, |app, camera| {
            app.add_plugins(PostProcessPlugin);
            let mut camera = app.world_mut().entity_mut(camera);
            let bright = AmbientLight {
                brightness: 3000.0,
                ..default()
            };
            camera.insert((msaa, bright));
            if blur {
                camera.insert(DepthOfField {
                    focal_distance,
                    aperture_f_stops: 1.0 / 50.0,
                    max_depth: 100.0,
                    ..default()
                });
            }
        });
        capture(&mut app).unwrap()
    });
    // The last bright pixel to the right of the middle.
    let bright = |x: &u32| sharp.get_pixel(*x, MIDDLE.y).0[1] > 128;
    let edge = (MIDDLE.x..SIZE.x).take_while(bright).last().unwrap();
    let inside = (edge - 4)..edge;
    let change = inside.map(|x| {
        let [sharp, blurred] = [&sharp, &blurred].map(|it| it.get_pixel(x, MIDDLE.y).0);
        differ(sharp, blurred)
    });
    change.max().unwrap()
}

#[test]
fn depth_of_field_sees_milk_as_an_opaque_thing() {
    for msaa in [Msaa::Off, Msaa::Sample4] {
        // Focused on the ball's silhouette, and far behind it.
        for (distance, is_sharp) in [(3.0, true), (50.0, false)] {
            let [milk, mesh] = [true, false].map(|milk| blurred_edge(milk, msaa, distance));
            let text = format!("{msaa:?}, {distance} m: {milk} {mesh}");
            assert!((milk < 12) == is_sharp && (mesh < 12) == is_sharp, "{text}");
        }
    }
}

/// The size of the main pass, for cameras of the render world.
#[derive(Resource)]
struct MainPassSize(UVec2);

fn override_resolution(
    cameras: Extract<Query<RenderEntity, With<Camera3d>>>,
    size: Extract<Res<MainPassSize>>,
    mut commands: Commands,
) {
    for camera in &cameras {
        commands
            .entity(camera)
            .insert(MainPassResolutionOverride(size.0));
    }
}

/// The main pass then covers a part of the target, which holds what a small target would.
#[test]
fn a_main_pass_of_less_resolution_holds_the_small_picture() {
    let small = SIZE / 2;
    for msaa in [Msaa::Off, Msaa::Sample4] {
        let [whole, part] = [false, true].map(|part| {
            let size = if part { SIZE } else { small };
            let mut app = headless_app(size, |app| {
                fill(app, Color::BLACK, FluidMaterial::INK, |world, camera| {
                    world.entity_mut(camera).insert(msaa);
                    let green = unlit(Color::srgb(0.1, 0.9, 0.1));
                    paint(world, vec3(3.0, 3.0, 0.1), green, vec3(0.5, 0.0, -5.0));
                });
                if part {
                    app.insert_resource(MainPassSize(small));
                    app.sub_app_mut(RenderApp)
                        .add_systems(ExtractSchedule, override_resolution);
                }
            })
            .unwrap();
            settle(&mut app).unwrap();
            capture(&mut app).unwrap()
        });
        let mut dark = 0;
        for y in 0..small.y {
            for x in 0..small.x {
                let [a, b] = [&whole, &part].map(|it| it.get_pixel(x, y).0);
                assert!(differ(a, b) < 3, "{msaa:?}, {x} {y}: {a:?} {b:?}");
                dark += u32::from(a[1] < 40 && a[0] < 40);
            }
        }
        assert!(dark > 100, "{msaa:?}: ink covers {dark} pixels");
    }
}
