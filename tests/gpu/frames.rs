//! What a frame shows, and what it costs: pictures compared bit by bit.

use crate::common::*;
use bevy::{
    camera::{Viewport, visibility::RenderLayers},
    prelude::*,
    render::RenderApp,
};
use bevy_fluid::{particles::ShapedFluid, prelude::*, render::GpuSplats, settings::FluidDebugView};
use fluid_stage::{capture, headless_app, resize, step, validation_errors};
use image::{RgbaImage, imageops::crop_imm};

const VIEW: View = View {
    size: uvec2(96, 64),
    lens: Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    pose: Transform::IDENTITY,
};
const RADIUS: f32 = 0.08;

/// A block with a droplet over it, four metres ahead.
fn particles() -> Vec<Vec3> {
    let block = lattice(8, 2.0 * RADIUS, 0.1);
    let shifted = block.iter().map(|p| p + vec3(-0.56, -0.9, -4.6));
    shifted.chain([vec3(0.3, 0.7, -4.0)]).collect()
}

fn pool() -> impl Bundle {
    fluid(&particles(), RADIUS, SurfaceKernel::default())
}

/// A lit floor with a lit cube on it, and a wall behind.
fn scenery(world: &mut World) {
    world.spawn((
        DirectionalLight::default(),
        Transform::default().looking_to(vec3(-0.4, -1.0, -0.6), Vec3::Y),
    ));
    for (size, at) in [
        (vec3(8.0, 0.1, 8.0), vec3(0.0, -1.2, -5.0)),
        (vec3(0.6, 0.6, 0.6), vec3(1.0, -0.8, -6.0)),
    ] {
        let mesh = world
            .resource_mut::<Assets<Mesh>>()
            .add(Cuboid::from_size(size));
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(Color::srgb(0.8, 0.5, 0.2));
        world.spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_translation(at),
        ));
    }
    spawn_box(
        world,
        vec3(3.0, 1.0, 0.1),
        Transform::from_xyz(0.0, 0.5, -8.0),
    );
}

fn picture(app: &mut App) -> RgbaImage {
    capture(app).unwrap()
}

/// The scenery as it is in a program that has never heard of fluids.
fn without_fluid_plugin() -> RgbaImage {
    let mut app = headless_app(VIEW.size, |app| {
        app.world_mut().spawn(VIEW.plain_camera());
        scenery(app.world_mut());
    })
    .unwrap();
    settle(&mut app).unwrap();
    picture(&mut app)
}

fn show_scenery() -> App {
    show(&VIEW, ScreenSpaceFluid::default(), scenery)
}

fn show_pool() -> App {
    let mut app = show_scenery();
    pour(&mut app, pool());
    app
}

/// Changes the only fluid's component, and settles.
fn change<C: Component<Mutability = bevy::ecs::component::Mutable>>(
    app: &mut App,
    change: impl FnOnce(&mut C),
) {
    let fluid = only::<FluidParticles>(app);
    change(&mut app.world_mut().get_mut::<C>(fluid).unwrap());
    settle(app).unwrap();
}

#[test]
fn without_liquid_in_view_the_picture_is_bevys_own() {
    let plain = without_fluid_plugin();
    let mut app = show_scenery();
    assert!(picture(&mut app) == plain, "no fluid");
    for at in [Vec3::Z * 12.0, Vec3::X * 30.0] {
        pour(&mut app, (pool(), Transform::from_translation(at)));
        assert!(view_surfaces(&app).is_none(), "{at}");
        assert!(picture(&mut app) == plain, "out of view at {at}");
    }
    pour(&mut app, (pool(), Visibility::Hidden));
    assert!(picture(&mut app) == plain, "hidden");
    pour(&mut app, pool());
    assert!(picture(&mut app) != plain, "in view");
    let camera = only::<ScreenSpaceFluid>(&mut app);
    app.world_mut()
        .entity_mut(camera)
        .remove::<ScreenSpaceFluid>();
    step(&mut app, 1);
    assert!(view_surfaces(&app).is_none());
    assert!(picture(&mut app) == plain, "a camera that draws no fluids");
}

#[test]
fn a_frame_is_the_same_twice() {
    let mut app = show_pool();
    let first = picture(&mut app);
    for _ in 0..3 {
        step(&mut app, 1);
        assert!(picture(&mut app) == first);
    }
    let mut again = show_pool();
    assert!(picture(&mut again) == first, "in another app");
}

#[test]
fn only_changed_particles_are_shaped_and_uploaded() {
    let mut app = show_pool();
    let counts = |app: &mut App| {
        let fluid = only::<FluidParticles>(app);
        let generation = app.world().get::<ShapedFluid>(fluid).unwrap().generation();
        let mut entities = app.sub_app(RenderApp).world().iter_entities();
        let uploads = entities.find_map(|entity| Some(entity.get::<GpuSplats>()?.uploads));
        (generation, uploads.unwrap())
    };
    assert_eq!(counts(&mut app), (1, 1));
    step(&mut app, 3);
    assert_eq!(counts(&mut app), (1, 1), "nothing changed");
    change::<Transform>(&mut app, |transform| transform.translation.x += 0.1);
    change::<FluidMaterial>(&mut app, |material| material.refractive_index = 1.4);
    look(&mut app, Transform::from_xyz(0.1, 0.2, 0.3));
    assert_eq!(counts(&mut app), (1, 1), "only moved and dyed");
    change::<FluidParticles>(&mut app, |particles| particles.positions[0].y += 0.1);
    assert_eq!(counts(&mut app), (2, 2), "a particle moved");
    change::<SurfaceKernel>(&mut app, |kernel| kernel.spray_threshold = 4);
    assert_eq!(counts(&mut app), (3, 3), "another kernel");
}

#[test]
fn every_debug_view_is_drawn() {
    let mut app = show_pool();
    let plain = picture(&mut app);
    for view in FluidDebugView::ALL {
        for msaa in [Msaa::Off, Msaa::Sample4] {
            look(&mut app, (view, msaa));
            assert!(picture(&mut app) != plain, "{view:?}, {msaa:?}");
            assert_eq!(validation_errors(&app), [""; 0]);
        }
    }
    let camera = only::<Camera3d>(&mut app);
    app.world_mut()
        .entity_mut(camera)
        .remove::<FluidDebugView>();
    look(&mut app, Msaa::Off);
    assert!(picture(&mut app) == plain, "back to the liquid");
}

fn part(at: UVec2, size: UVec2) -> Viewport {
    Viewport {
        physical_position: at,
        physical_size: size,
        ..default()
    }
}

/// Sets the viewport of a camera, and settles.
fn set_viewport(app: &mut App, camera: Entity, viewport: Viewport) {
    app.world_mut().get_mut::<Camera>(camera).unwrap().viewport = Some(viewport);
    settle(app).unwrap();
}

/// The largest difference of two pictures' colours.
fn difference(a: &RgbaImage, b: &RgbaImage) -> u8 {
    assert_eq!(a.dimensions(), b.dimensions());
    let pairs = a.as_raw().iter().zip(b.as_raw());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

#[test]
fn a_viewport_shows_what_a_picture_of_its_size_does() {
    let whole = picture(&mut show_pool());
    let mut app = show_pool();
    resize(&mut app, VIEW.size * 2).unwrap();
    let camera = only::<Camera3d>(&mut app);
    for at in [uvec2(0, 0), uvec2(37, 21), VIEW.size] {
        set_viewport(&mut app, camera, part(at, VIEW.size));
        let picture = picture(&mut app);
        let part = crop_imm(&picture, at.x, at.y, VIEW.size.x, VIEW.size.y).to_image();
        assert_same_but_for_rounding(&part, &whole, at);
    }
}

/// Larger coordinates round differently, by a step of 1/255 at the most, but that a ray or two take
/// another surface where two meet.
fn assert_same_but_for_rounding(part: &RgbaImage, whole: &RgbaImage, at: UVec2) {
    let off = part.pixels().zip(whole.pixels());
    let other = off.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 1));
    assert!(other.count() <= 2, "at {at}: {}", difference(part, whole));
}

#[test]
fn two_cameras_draw_the_same_liquid() {
    let whole = picture(&mut show_pool());
    let mut app = show_pool();
    resize(&mut app, VIEW.size * uvec2(2, 1)).unwrap();
    let left = only::<Camera3d>(&mut app);
    let right = app
        .world_mut()
        .spawn(VIEW.camera(ScreenSpaceFluid::default()))
        .id();
    let mut camera = app.world_mut().get_mut::<Camera>(right).unwrap();
    camera.order = 1;
    // The first camera has cleared the whole picture; what lies beyond the scenery stays black.
    camera.clear_color = ClearColorConfig::None;
    app.insert_resource(ClearColor(Color::BLACK));
    let halves = [uvec2(0, 0), uvec2(VIEW.size.x, 0)];
    for (camera, at) in [left, right].into_iter().zip(halves) {
        set_viewport(&mut app, camera, part(at, VIEW.size));
    }
    let picture = picture(&mut app);
    for at in halves {
        let half = crop_imm(&picture, at.x, at.y, VIEW.size.x, VIEW.size.y).to_image();
        assert_same_but_for_rounding(&half, &whole, at);
    }
}

#[test]
fn multisampling_leaves_the_liquid_as_it_is() {
    let mut app = show_pool();
    let single = picture(&mut app);
    look(&mut app, Msaa::Sample4);
    let multi = picture(&mut app);
    // Edges of the scenery are smoothed, before the liquid and behind it; the rest stays.
    let pairs = single.pixels().zip(multi.pixels());
    let changed = pairs.filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 2));
    let share = changed.count() as f32 / VIEW.size.element_product() as f32;
    assert!(share < 0.1, "{share}");
}

#[test]
fn a_resized_picture_is_that_of_an_app_of_its_size() {
    let mut app = show_pool();
    let large = picture(&mut app);
    resize(&mut app, VIEW.size / 2).unwrap();
    step(&mut app, 1);
    assert_eq!(picture(&mut app).dimensions(), (VIEW.size / 2).into());
    resize(&mut app, VIEW.size).unwrap();
    step(&mut app, 1);
    assert!(picture(&mut app) == large);
}

#[test]
fn particles_that_are_not_finite_are_dropped_and_counted() {
    let mut app = show_pool();
    let clean = picture(&mut app);
    change::<FluidParticles>(&mut app, |particles| {
        let (nan, infinite) = (Vec3::splat(f32::NAN), vec3(0.0, f32::INFINITY, 0.0));
        particles.positions.extend([nan, infinite, -infinite]);
    });
    let fluid = only::<FluidParticles>(&mut app);
    assert_eq!(app.world().get::<ShapedFluid>(fluid).unwrap().dropped(), 3);
    assert!(picture(&mut app) == clean);
}

#[test]
fn a_radius_that_is_no_length_draws_nothing() {
    let plain = without_fluid_plugin();
    let mut app = show_pool();
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        change::<FluidParticles>(&mut app, |particles| particles.radius = radius);
        assert!(picture(&mut app) == plain, "radius {radius}");
    }
    change::<FluidParticles>(&mut app, |particles| particles.radius = RADIUS);
    assert!(picture(&mut app) != plain, "mended");
}

#[test]
fn particles_that_are_gone_are_gone_from_the_picture() {
    let plain = without_fluid_plugin();
    let mut app = show_pool();
    let full = picture(&mut app);
    change::<FluidParticles>(&mut app, |particles| particles.positions.truncate(100));
    let less = picture(&mut app);
    assert!(less != full && less != plain);
    change::<FluidParticles>(&mut app, |particles| particles.positions.clear());
    assert!(picture(&mut app) == plain, "no particles");
    change::<FluidParticles>(&mut app, |fluid| fluid.positions = particles());
    assert!(picture(&mut app) == full, "all of them again");
    let fluid = only::<FluidParticles>(&mut app);
    app.world_mut().despawn(fluid);
    settle(&mut app).unwrap();
    assert!(picture(&mut app) == plain, "despawned");
}

#[test]
fn render_layers_are_honoured() {
    let mut app = show_pool();
    let drawn = picture(&mut app);
    let fluid = only::<FluidParticles>(&mut app);
    app.world_mut()
        .entity_mut(fluid)
        .insert(RenderLayers::layer(1));
    settle(&mut app).unwrap();
    assert!(picture(&mut app) == without_fluid_plugin(), "another layer");
    look(&mut app, RenderLayers::from_layers(&[0, 1]));
    assert!(picture(&mut app) == drawn, "both layers");
}

#[test]
fn an_opaque_thing_in_front_hides_the_liquid() {
    let cube = |world: &mut World| {
        spawn_box(world, Vec3::splat(1.6), Transform::from_xyz(0.0, 0.0, -2.5));
    };
    let mut app = show_scenery();
    cube(app.world_mut());
    settle(&mut app).unwrap();
    let alone = picture(&mut app);
    // Within the silhouette of the cube, whose front is 1.7 m away.
    pour(&mut app, (pool(), Transform::from_scale(Vec3::splat(0.95))));
    let hidden = view_surfaces(&app).is_some();
    assert!(hidden, "the liquid is in the frustum");
    assert!(picture(&mut app) == alone);
}

#[test]
fn fluids_of_different_materials_are_bodies_of_their_own() {
    let mut app = show_pool();
    let ink = FluidMaterial {
        medium: Medium {
            absorption_density: 5.0,
            absorption_color: LinearRgba::BLUE,
            ..Medium::CLEAR
        },
        ..default()
    };
    let at = Transform::from_xyz(0.6, 0.4, 0.5);
    app.world_mut().spawn((pool(), at)).insert(ink);
    settle(&mut app).unwrap();
    assert_eq!(view_surfaces(&app).unwrap().surfaces.len(), 2);
    let two = picture(&mut app);
    change_all_materials(&mut app, ink);
    assert_eq!(view_surfaces(&app).unwrap().surfaces.len(), 1);
    assert!(picture(&mut app) != two);
}

fn change_all_materials(app: &mut App, to: FluidMaterial) {
    let world = app.world_mut();
    for mut material in world.query::<&mut FluidMaterial>().iter_mut(world) {
        *material = to;
    }
    settle(app).unwrap();
}

/// A droplet before black whose highlight is all that directional lights do to it.
#[test]
fn a_light_that_is_gone_leaves_no_highlight() {
    let show_lit = |lights: usize| {
        show(&VIEW, ScreenSpaceFluid::default(), |world| {
            world.spawn(fluid(&[vec3(0.0, 0.0, -4.0)], 0.8, SPRAY));
            for i in 0..lights {
                let from = vec3(i as f32 - 0.5, 1.0, 2.0);
                world.spawn((
                    DirectionalLight::default(),
                    Transform::default().looking_to(-from, Vec3::Y),
                ));
            }
        })
    };
    let [none, one] = [0, 1].map(|lights| capture(&mut show_lit(lights)).unwrap());
    let mut app = show_lit(2);
    let two = capture(&mut app).unwrap();
    assert!(two != one && one != none, "highlights show");
    let lights: Vec<_> = {
        let world = app.world_mut();
        let mut lights = world.query_filtered::<Entity, With<DirectionalLight>>();
        lights.iter(world).collect()
    };
    app.world_mut().despawn(lights[1]);
    settle(&mut app).unwrap();
    assert!(capture(&mut app).unwrap() == one, "despawned");
    app.world_mut()
        .entity_mut(lights[0])
        .insert(Visibility::Hidden);
    settle(&mut app).unwrap();
    assert!(capture(&mut app).unwrap() == none, "hidden");
}

/// A change that needs other pipelines must not make the liquid vanish until they are compiled.
#[test]
fn no_frame_is_without_liquid() {
    const SKY: Color = Color::srgb(1.0, 0.0, 1.0);
    let mut app = show(&VIEW, ScreenSpaceFluid::default(), |world| {
        world.insert_resource(ClearColor(SKY));
        world.spawn(pool()).insert(FluidMaterial::INK);
    });
    let camera = only::<Camera3d>(&mut app);
    app.world_mut()
        .get_mut::<Camera>(camera)
        .unwrap()
        .clear_color = ClearColorConfig::Default;
    let liquid = only::<FluidParticles>(&mut app);
    settle(&mut app).unwrap();
    let covered = |app: &mut App| {
        let picture = capture(app).unwrap();
        let is_sky = |pixel: &&image::Rgba<u8>| pixel.0 == [255, 0, 255, 255];
        picture.pixels().count() - picture.pixels().filter(is_sky).count()
    };
    let before = covered(&mut app);
    assert!(before > 500, "{before}");
    let changes: [(&str, fn(&mut World, [Entity; 2])); 6] = [
        ("no droplet", |world, [_, liquid]| {
            let mut fluid = world.get_mut::<FluidParticles>(liquid).unwrap();
            fluid.positions.pop();
        }),
        ("another medium", |world, [_, liquid]| {
            world.entity_mut(liquid).insert(FluidMaterial::MILK);
        }),
        ("smoke", |world, [_, liquid]| {
            world.entity_mut(liquid).insert(FluidMaterial::SMOKE);
        }),
        ("other smoothing", |world, [camera, liquid]| {
            world.entity_mut(liquid).insert(FluidMaterial::INK);
            world.entity_mut(camera).insert(ScreenSpaceFluid::THESIS);
        }),
        ("fewer refractions", |world, [camera, _]| {
            world.entity_mut(camera).insert(ScreenSpaceFluid::FAST);
        }),
        ("another fluid", |world, _| {
            let droplet = fluid(&[vec3(-0.5, 0.7, -4.0)], RADIUS, SPRAY);
            world.spawn(droplet).insert(FluidMaterial::HONEY);
        }),
    ];
    for (name, change) in changes {
        change(app.world_mut(), [camera, liquid]);
        for frame in 0..4 {
            step(&mut app, 1);
            let now = covered(&mut app);
            assert!(2 * now > before, "{name}, frame {frame}: {now} of {before}");
        }
        assert_sound(&app);
    }
}
