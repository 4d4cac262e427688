//! What must not change the layers.

use bevy::prelude::*;
use bevy_fluid::{
    particles::ShapedFluid,
    prelude::*,
    render::{LayerBlending, Layers},
};

use crate::common::*;

use super::{PERSPECTIVE, scattered};

/// Distance between two floats of one sign in representable steps.
fn steps_apart(a: f32, b: f32) -> u32 {
    a.to_bits().abs_diff(b.to_bits())
}

#[test]
fn both_ways_of_blending_give_the_same_layers() {
    let view = View::new(96, PERSPECTIVE);
    let pool = scattered(200, vec3(0.0, 0.0, -6.0), 1.2);
    let [blended, drawn] = [LayerBlending::MaxBlend, LayerBlending::DepthDraws].map(|blending| {
        let plugin = FluidPlugin {
            layer_blending: blending,
            ..default()
        };
        let app = show_with(plugin, &view, RAW, |world| {
            world.spawn(fluid(&pool, 0.3, BULK));
            world.spawn(fluid(
                &[vec3(1.0, 1.0, -4.0), vec3(0.0, 0.0, -4.5)],
                0.2,
                SPRAY,
            ));
        });
        [read(&app, Layers::bulk), read(&app, Layers::spray)]
    });
    for (blended, drawn) in blended.iter().zip(&drawn) {
        for pixel in pixels(view.size) {
            let [a, b] = [blended, drawn].map(|layers| layers.f32x2(pixel.x, pixel.y));
            // Two pipelines may round the same formula differently.
            let same = steps_apart(a[0], b[0]) <= 2 && steps_apart(a[1], b[1]) <= 2;
            assert!(same, "{pixel}: {a:?} {b:?}");
        }
    }
}

#[test]
fn multisampling_changes_no_layer() {
    let view = View::new(64, PERSPECTIVE);
    let mut app = show(&view, RAW, |world| {
        world.spawn(fluid(&scattered(60, vec3(0.0, 0.0, -6.0), 1.2), 0.3, BULK));
        world.spawn(fluid(&[vec3(0.5, 0.5, -4.0)], 0.2, SPRAY));
    });
    let layers = |app: &App| [read(app, Layers::bulk), read(app, Layers::spray)];
    let single = layers(&app);
    look(&mut app, Msaa::Sample4);
    assert_eq!(single, layers(&app));
}

#[test]
fn interior_particles_are_not_missed_from_any_side() {
    let radius = 0.05;
    // As dense as a liquid is. From a fifth of the spacing on, single pores are so deep that a
    // ray ends at an interior particle (2 of 4000 pixels; at 0.3 it is 25).
    let block = lattice(16, 2.0 * radius, 0.15);
    let middle = Vec3::splat(7.5 * 2.0 * radius);
    let kernel = |skip_interior| SurfaceKernel {
        skip_interior,
        ..default()
    };
    let mut view = View::new(128, PERSPECTIVE);
    let mut app = show(&view, RAW, |_| {});
    for from in [
        Vec3::Z,
        Vec3::NEG_X,
        vec3(1.0, 2.0, 3.0),
        vec3(-3.0, -1.0, 0.5),
    ] {
        view.pose = Transform::from_translation(middle + 3.5 * from.normalize())
            .looking_at(middle, vec3(0.1, 1.0, 0.2));
        look(&mut app, view.pose);
        let [with, without] = [false, true].map(|skip| {
            pour(&mut app, fluid(&block, radius, kernel(skip)));
            let shaped = only::<FluidParticles>(&mut app);
            let shaped = app.world().get::<ShapedFluid>(shaped).unwrap();
            assert_eq!(shaped.interior() > 500, skip, "{}", shaped.interior());
            read(&app, Layers::bulk)
        });
        assert!(with == without, "seen from {from}");
    }
}
