//! Scenes with many edges: liquid from afar, droplets, strands behind strands, rows of a lattice.

use std::f64::consts::TAU;

use bevy::math::{DAffine3, DVec2, DVec3, Vec3, dvec3};
use fluid_reference::{
    Camera, Lens, ellipsoids::Ellipsoids, random::Random, scene, surface::Cuboid,
};

use super::{Measures, RADIUS, Scene, size};
use crate::{Options, surroundings::Surroundings};

/// From how far scenes are seen whose particles are so many pixels, as in a game of 1080 lines that
/// are 35° high.
const LINES: f64 = 1080.0;
const FOV: f64 = 35.0;

/// The same scene from the same side, so far off that a particle's radius is so many pixels: a part
/// of a large picture, as large as the liquid.
pub(super) fn from_afar(near: Scene, pixels: f64) -> Scene {
    let at_one_metre = 2.0 * (0.5 * FOV.to_radians()).tan() / LINES;
    let distance = near.radius / (pixels * at_one_metre);
    let points = near.positions.iter().map(|p| p.as_dvec3());
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let middle = 0.5 * (low + high);
    let back = near.camera.world_from_view.transform_vector3(DVec3::Z);
    let lens = |height: f64| Lens::Perspective {
        fov: 2.0 * (0.5 * height * at_one_metre).atan(),
        near: 0.1,
    };
    let camera = |size: DVec2| {
        Camera::new(size.as_uvec2(), lens(size.y)).looking_at(middle + back * distance, middle)
    };
    let whole = camera(DVec2::splat(2.0 * LINES));
    let center = 0.5 * whole.size.as_dvec2();
    let half = near.positions.iter().fold(DVec2::ZERO, |half, p| {
        let on_screen = whole.project(p.as_dvec3());
        on_screen.map_or(half, |(at, _)| half.max((at - center).abs()))
    });
    let border = 8.0 + 2.0 * pixels;
    Scene {
        camera: camera(
            (2.0 * (half + border))
                .ceil()
                .clamp(DVec2::splat(32.0), DVec2::splat(1440.0)),
        ),
        ..near
    }
}

fn of(
    options: &Options,
    name: &'static str,
    positions: Vec<Vec3>,
    (eye, target): (DVec3, DVec3),
    around: Surroundings,
) -> Scene {
    let lens = Lens::Perspective {
        fov: FOV.to_radians(),
        near: 0.1,
    };
    Scene {
        name,
        positions,
        radius: RADIUS,
        camera: Camera::new(size(options), lens).looking_at(eye, target),
        around,
        exact: None,
        exact_bulk: None,
        measures: Measures::Edges,
    }
}

const LOW: Surroundings = Surroundings {
    floor: -1.25,
    wall: -3.0,
};

/// A pool with waves, whole.
pub(super) fn pool(options: &Options, name: &'static str) -> Scene {
    let pool = scene::rippled_pool(RADIUS);
    let (positions, view) = (pool.positions(), (pool.eye, pool.target));
    Scene {
        exact: Some(pool.surface),
        ..of(options, name, positions, view, LOW)
    }
}

/// Droplets that are spheres of the particles' radius.
fn droplets(
    options: &Options,
    name: &'static str,
    centers: Vec<DVec3>,
    view: (DVec3, DVec3),
    around: Surroundings,
) -> Scene {
    let positions = centers.iter().map(|p| p.as_vec3()).collect();
    Scene {
        exact: Some(Box::new(Ellipsoids::spheres(&centers, RADIUS))),
        ..of(options, name, positions, view, around)
    }
}

/// Droplets in a ball of 1 m: about one on each line of sight.
pub(super) fn cloud(options: &Options, name: &'static str) -> Scene {
    let mut random = Random::new(3);
    let in_ball = std::iter::repeat_with(|| random.point()).filter(|p| p.length() < 1.0);
    let view = (dvec3(0.3, 0.6, 4.2), DVec3::ZERO);
    droplets(options, name, in_ball.take(1500).collect(), view, LOW)
}

/// A sheet of droplets before a wall, larger than the picture.
pub(super) fn sprayed_wall(options: &Options, name: &'static str) -> Scene {
    let mut random = Random::new(4);
    // Few enough for none to be near eight others, which would be bulk.
    let half = dvec3(2.0, 1.5, 0.6);
    let centers = (0..8000).map(|_| random.point() * half).collect();
    let view = (dvec3(0.5, 0.4, 4.5), DVec3::ZERO);
    let around = Surroundings {
        floor: -2.0,
        wall: -1.0,
    };
    droplets(options, name, centers, view, around)
}

/// A tube along a torus knot: strands behind strands.
pub(super) fn knot(options: &Options, name: &'static str) -> Scene {
    /// Turns about the torus's axis and through its hole.
    const TURNS: [f64; 2] = [3.0, 7.0];
    const SLICES: u32 = 420;
    let on_knot = |t: f64| {
        let [around, through] = TURNS.map(|turns| turns * t * TAU);
        let out = 0.75 + 0.32 * through.cos();
        dvec3(out * around.cos(), out * around.sin(), 0.32 * through.sin())
    };
    let mut random = Random::new(5);
    let mut positions = Vec::new();
    for slice in 0..SLICES {
        let t = f64::from(slice) / f64::from(SLICES);
        let center = on_knot(t);
        let along = (on_knot(t + 1e-4) - center).normalize();
        let (side, up) = along.any_orthonormal_pair();
        for i in 0..7 {
            let (sin, cos) = (f64::from(i) / 6.0 * TAU).sin_cos();
            let out = if i == 6 { 0.0 } else { 2.0 * RADIUS };
            let moved = random.point() * 0.2 * RADIUS;
            positions.push((center + (side * cos + up * sin) * out + moved).as_vec3());
        }
    }
    let view = (dvec3(0.4, 0.7, 4.3), DVec3::ZERO);
    of(options, name, positions, view, LOW)
}

/// A cube of a lattice without disorder, whose top is seen at 8°.
pub(super) fn cube_top(options: &Options, name: &'static str) -> Scene {
    let body = Cuboid::between(dvec3(-0.75, -0.5, -0.75), dvec3(0.75, 0.0, 0.75));
    let steps = |low: f64, count: u32| (0..count).map(move |i| low + RADIUS * f64::from(2 * i + 1));
    let mut positions = Vec::new();
    for x in steps(-0.75, 30) {
        for y in steps(-0.5, 10) {
            for z in steps(-0.75, 30) {
                positions.push(dvec3(x, y, z).as_vec3());
            }
        }
    }
    let turn = DAffine3::from_rotation_y(0.4);
    let view = (
        turn.transform_point3(dvec3(0.0, 0.4, 2.8)),
        dvec3(0.0, -0.1, 0.0),
    );
    Scene {
        exact: Some(Box::new(body)),
        ..of(options, name, positions, view, LOW)
    }
}
