//! Fifty hard cases, each a test named with its number: docs/stability.md lists them. Each asserts
//! the right value or picture; that all is finite and valid is asserted throughout besides.

mod crowds;
mod depths;
mod eyes;
mod liquids;
mod medium;
mod opaque;
mod particles;
mod paths;
mod projections;
mod scales;
mod views;

use crate::common::*;
use bevy::{prelude::*, render::render_resource::Texture};
use bevy_fluid::{
    prelude::*,
    render::Layers,
    shape::{FluidSplats, ShapeWorkspace, Splat},
};
use fluid_stage::{capture, log};
use image::RgbaImage;

const PERSPECTIVE: Lens = Lens::Perspective {
    fov: 0.7,
    near: 0.1,
};
const PARALLEL: Lens = Lens::Orthographic {
    height: 4.0,
    near: 0.0,
    far: 12.0,
};

/// Every particle is bulk and an ellipsoid; none is left out.
const STRETCHED: SurfaceKernel = SurfaceKernel {
    spray_threshold: 0,
    sphere_neighbors: 0,
    full_neighbors: 1,
    skip_interior: false,
    ..SurfaceKernel::DEFAULT
};

/// One of a body's textures.
type LayerOf = fn(&Layers) -> Option<&Texture>;

#[track_caller]
fn picture(app: &mut App) -> RgbaImage {
    assert_sound(app);
    capture(app).unwrap()
}

/// How many pixels differ by more than `tolerance` of 255.
fn differing(a: &RgbaImage, b: &RgbaImage, tolerance: u8) -> usize {
    assert_eq!(a.dimensions(), b.dimensions());
    let apart = |(a, b): (&image::Rgba<u8>, &image::Rgba<u8>)| {
        a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > tolerance)
    };
    a.pixels()
        .zip(b.pixels())
        .filter(|&pair| apart(pair))
        .count()
}

/// Something to see through a liquid: two walls, some metres behind one another.
fn walls(world: &mut World) {
    for (size, at) in [
        (vec3(3.0, 1.0, 0.1), vec3(0.0, 0.5, -8.0)),
        (vec3(1.0, 6.0, 0.1), vec3(-0.6, 0.0, -9.0)),
    ] {
        spawn_box(world, size, Transform::from_translation(at));
    }
}

fn shaped(positions: &[Vec3], radius: f32, kernel: &SurfaceKernel) -> FluidSplats {
    let mut splats = FluidSplats::default();
    ShapeWorkspace::default()
        .shape(positions, radius, kernel, &mut splats)
        .unwrap();
    splats
}

fn ellipsoids(view: &View, place: &Transform, splats: &[Splat]) -> Vec<Ellipsoid> {
    let ellipsoid = |splat| Ellipsoid::of_splat(view, place, splat);
    splats.iter().map(ellipsoid).collect()
}

/// Pours particles and holds both classes' layers against their ellipsoids in f64. `tolerance` is
/// in particle radii. Returns how many pixels are covered.
#[track_caller]
fn assert_drawn(
    view: &View,
    app: &mut App,
    (positions, radius, kernel): (&[Vec3], f32, SurfaceKernel),
    tolerance: f64,
) -> usize {
    pour(app, fluid(positions, radius, kernel));
    assert_sound(app);
    let splats = shaped(positions, radius, &kernel);
    let [bulk, _, spray] = splats.by_class();
    let mut covered = 0;
    for (splats, layers) in [(bulk, Layers::bulk as LayerOf), (spray, Layers::spray)] {
        if !splats.is_empty() {
            let bodies = ellipsoids(view, &Transform::IDENTITY, splats);
            let tolerance = tolerance * f64::from(radius);
            covered += compare_layers(view, &read(app, layers), &bodies, tolerance);
        }
    }
    covered
}

/// What the shape stage says of the only fluid.
fn report(app: &mut App) -> &bevy_fluid::particles::ShapedFluid {
    let fluid = only::<FluidParticles>(app);
    app.world().get(fluid).unwrap()
}

/// The cases' tests are where this file says they are.
#[test]
fn every_case_has_a_test_and_a_line_in_the_docs() {
    let sources = [
        include_str!("particles.rs"),
        include_str!("scales.rs"),
        include_str!("eyes.rs"),
        include_str!("depths.rs"),
        include_str!("paths.rs"),
        include_str!("crowds.rs"),
        include_str!("views.rs"),
        include_str!("projections.rs"),
        include_str!("liquids.rs"),
        include_str!("opaque.rs"),
        include_str!("medium.rs"),
    ]
    .concat();
    let docs = include_str!("../../../docs/stability.md");
    for case in 1..=50 {
        let name = format!("fn h{case:02}_");
        assert!(sources.contains(&name), "no test {name}");
        assert!(
            docs.contains(&format!("| h{case:02} |")),
            "h{case:02} is not in the docs"
        );
    }
}
