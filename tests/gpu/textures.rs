//! How much memory the textures of surfaces take: as much as what is drawn.

use crate::common::*;
use bevy::{camera::Viewport, prelude::*};
use bevy_fluid::{
    material::Medium,
    prelude::*,
    render::{Layers, TextureMemory},
};

const VIEW: View = View {
    size: uvec2(1920, 1080),
    ..View::new(
        1080,
        Lens::Perspective {
            fov: 0.7,
            near: 0.1,
        },
    )
};

fn bytes(app: &App) -> f64 {
    app.world().resource::<TextureMemory>().bytes() as f64
}

/// Bulk and spray across the whole view.
fn pool(world: &mut World) {
    world.spawn(fluid(&[Vec3::NEG_Z * 3.0], 2.5, BULK));
    world.spawn(fluid(&[vec3(0.5, 0.0, -1.5)], 0.2, SPRAY));
}

#[test]
fn a_surface_across_the_view_takes_74_bytes_a_pixel() {
    let app = show(&VIEW, ScreenSpaceFluid::default(), pool);
    let each = bytes(&app) / VIEW.size.as_dvec2().element_product();
    // 72 and the margin.
    assert!((70.0..74.0).contains(&each), "{each}");
}

#[test]
fn many_small_surfaces_take_little_more_than_a_large_one() {
    let one = bytes(&show(&VIEW, ScreenSpaceFluid::default(), pool));
    // A sixteenth of the view each, and each of its own colour.
    let app = show(&VIEW, ScreenSpaceFluid::default(), |world| {
        for i in 0..16 {
            let at = vec2((i % 4) as f32 - 1.5, (i / 4) as f32 - 1.5) * vec2(0.9, 0.5);
            let material = FluidMaterial {
                medium: Medium {
                    absorption_density: 1.0 + i as f32,
                    ..Medium::CLEAR
                },
                ..FluidMaterial::WATER
            };
            world
                .spawn(fluid(&[at.extend(-3.0)], 0.25, BULK))
                .insert(material);
        }
    });
    assert_eq!(surfaces(&app).len(), 16);
    assert!(bytes(&app) < 1.5 * one, "{} of {one}", bytes(&app));
}

#[test]
fn four_viewports_take_as_much_as_one() {
    let one = bytes(&show(&VIEW, ScreenSpaceFluid::default(), pool));
    let quarter = VIEW.size / 2;
    let app = show(&VIEW, ScreenSpaceFluid::default(), |world| {
        pool(world);
        let cameras: Vec<_> = world
            .query_filtered::<Entity, With<Camera>>()
            .iter(world)
            .collect();
        for i in 0..4 {
            let viewport = Viewport {
                physical_position: uvec2(i % 2, i / 2) * quarter,
                physical_size: quarter,
                ..default()
            };
            let camera = match cameras.get(i as usize) {
                Some(&camera) => camera,
                None => world.spawn(VIEW.camera(ScreenSpaceFluid::default())).id(),
            };
            let mut camera = world.entity_mut(camera);
            let mut camera = camera.get_mut::<Camera>().unwrap();
            camera.viewport = Some(viewport);
            camera.order = i as isize;
        }
    });
    let ratio = bytes(&app) / one;
    assert!(ratio < 1.1, "{ratio}");
}

#[test]
fn textures_follow_a_surface_and_are_freed_with_it() {
    let mut app = show(&VIEW, ScreenSpaceFluid::default(), pool);
    let whole = bytes(&app);
    pour(&mut app, fluid(&[Vec3::NEG_Z * 3.0], 0.1, BULK));
    let small = bytes(&app);
    assert!(small < 0.05 * whole, "{small} of {whole}");
    let size = surface(&app).1.size();
    // Somewhat larger or smaller, it keeps them.
    pour(&mut app, fluid(&[Vec3::NEG_Z * 3.0], 0.095, BULK));
    assert_eq!(surface(&app).1.size(), size);
    pour(&mut app, fluid(&[Vec3::Z * 3.0], 0.1, BULK));
    assert_eq!(bytes(&app), 0.0);
    // Of all that a surface has, what it does not need is not there.
    pour(&mut app, fluid(&[Vec3::NEG_Z * 3.0], 0.1, SPRAY));
    let (_, layers) = surface(&app);
    assert!(Layers::bulk(layers).is_none() && layers.spray().is_some());
}

/// Those of the view as well: the scene's depth, resolved, and its colour before any surface.
#[test]
fn a_view_that_turns_away_keeps_no_textures() {
    let mut app = show(&VIEW, ScreenSpaceFluid::default(), |world| {
        pool(world);
        let milk = fluid(&[vec3(0.0, 0.0, -1.0)], 0.1, BULK);
        world.spawn(milk).insert(FluidMaterial::MILK);
    });
    look(&mut app, Msaa::Sample4);
    let seen = bytes(&app);
    look(
        &mut app,
        Transform::from_rotation(Quat::from_rotation_y(3.1)),
    );
    assert_eq!(bytes(&app), 0.0);
    look(&mut app, Transform::default());
    assert_eq!(bytes(&app), seen);
}
