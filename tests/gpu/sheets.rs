//! Light through thin sheets of liquid, whose faces have each their own bumps.

use std::collections::HashMap;

use crate::common::*;
use bevy::prelude::*;
use bevy_fluid::{
    prelude::{ScreenSpaceFluid, SurfaceKernel},
    render::Layers,
};

const RADIUS: f32 = 0.05;
const PARALLEL: View = View::new(
    128,
    Lens::Orthographic {
        height: 2.0,
        near: 0.0,
        far: 10.0,
    },
);

/// Particles on a lattice of this size, each a tenth of the spacing off its place, 5 m away.
fn block(size: UVec3) -> Vec<Vec3> {
    let mut random = Random(5);
    let cells = (0..size.element_product())
        .map(|i| uvec3(i % size.x, i / size.x % size.y, i / size.x / size.y));
    cells
        .map(|cell| {
            let jitter = 0.1 * (2.0 * random.point() - 1.0);
            let place = cell.as_vec3() - 0.5 * (size.as_vec3() - 1.0) + jitter;
            Vec3::NEG_Z * 5.0 + 2.0 * RADIUS * place
        })
        .collect()
}

/// How far light through the liquid is bent, in degrees, by pixel.
fn bent(app: &mut App, positions: &[Vec3], spray_threshold: u32) -> Vec<(UVec2, f64)> {
    let kernel = SurfaceKernel {
        spray_threshold,
        ..SurfaceKernel::DEFAULT
    };
    pour(app, fluid(positions, RADIUS, kernel));
    let exits = read(app, Layers::exits);
    pixels(PARALLEL.size)
        .filter_map(|pixel| {
            let exit = Exit::at(&PARALLEL, &exits, pixel.x, pixel.y)?;
            let ray = PARALLEL.ray(View::center(pixel));
            Some((pixel, angle(exit.direction, ray.direction)))
        })
        .collect()
}

/// The part of them for which it is true.
fn part(of: impl ExactSizeIterator<Item = bool>) -> f64 {
    let all = of.len();
    of.filter(|&it| it).count() as f64 / all as f64
}

#[test]
fn sheets_are_looked_through_up_to_their_rims() {
    let mut app = show(&PARALLEL, ScreenSpaceFluid::DEFAULT, |_| {});
    for layers in 1..=2 {
        let bent = bent(&mut app, &block(uvec3(14, 14, layers)), 7);
        assert!(bent.len() > 6000, "{}", bent.len());
        let straight = part(bent.iter().map(|&(_, it)| it < 0.5));
        assert!(straight > 0.97, "{layers} particles: {straight}");
    }
}

#[test]
fn balls_of_a_few_particles_are_no_sheets() {
    let mut app = show(&PARALLEL, ScreenSpaceFluid::DEFAULT, |_| {});
    for radius in [5.0 * RADIUS, 9.0 * RADIUS] {
        let center = Vec3::NEG_Z * 5.0;
        let inside = |it: &Vec3| it.distance(center) < radius - 0.5 * RADIUS;
        let ball: Vec<_> = block(UVec3::splat(12)).into_iter().filter(inside).collect();
        // Where droplets are of the bulk, nothing is a sheet.
        let [as_it_is, plain] = [7, 0].map(|threshold| bent(&mut app, &ball, threshold));
        // A few small splats of either class lie at the silhouette.
        let plain: HashMap<_, _> = plain.into_iter().collect();
        let pairs = as_it_is
            .iter()
            .filter_map(|(pixel, it)| Some((*it, *plain.get(pixel)?)));
        let pairs: Vec<_> = pairs.collect();
        assert!(pairs.len() > 100, "{}", pairs.len());
        let bent = part(pairs.iter().map(|&(_, it)| it > 2.0));
        let same = part(pairs.iter().map(|&(a, b)| (a - b).abs() < 1.0));
        assert!(bent > 0.5 && same > 0.9, "{radius} m: {bent}, {same}");
    }
}
