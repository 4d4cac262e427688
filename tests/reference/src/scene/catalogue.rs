//! The scenes.

use std::f64::consts::{PI, TAU};

use glam::{DQuat, DVec2, DVec3, dvec3};

use super::{Scene, fill_cuboid, fill_pool, fill_sphere};
use crate::{
    Surface,
    surface::{Cuboid, RippledPool, Sphere, Union, Wave},
};

/// Height of the step in [`depth_step`], in particle radii.
pub const DEPTH_STEP: f64 = 10.0;

/// Every scene once, with particles of `radius` (m).
pub fn all(radius: f64) -> Vec<Scene> {
    vec![
        slab(radius, 30.0),
        tilted_plane(radius, 60.0),
        sphere(radius),
        rippled_pool(radius),
        half_filled_box(radius),
        two_spheres(radius),
        pool_and_droplets(radius),
        thin_sheet(radius),
        depth_step(radius),
    ]
}

/// A plate of 2 × 2 × 0.4 m, upright, and turned about the vertical by `degrees`: rays leave it
/// as they came, only shifted.
pub fn slab(radius: f64, degrees: f64) -> Scene {
    let body = Cuboid {
        center: DVec3::ZERO,
        half: dvec3(1.0, 1.0, 0.2),
        turn: DQuat::from_rotation_y(degrees.to_radians()),
    };
    of_cuboid("slab", body, radius, dvec3(0.0, 0.0, 2.0))
}

/// A plane whose normal is tilted upwards by `degrees` (0 to 85) from the line of sight: the top
/// of a plate of 2 × 4 m, eight radii thick.
pub fn tilted_plane(radius: f64, degrees: f64) -> Scene {
    tilted_plate(radius, degrees, DVec2::new(1.0, 2.0))
}

/// [`tilted_plane`] as the top of a plate of half so many metres, across and along the tilt.
pub fn tilted_plate(radius: f64, degrees: f64, half: DVec2) -> Scene {
    let turn = DQuat::from_rotation_x(-degrees.to_radians());
    let half = half.extend(4.0 * radius);
    let body = Cuboid {
        // The plane itself goes through the origin.
        center: turn * DVec3::NEG_Z * half.z,
        half,
        turn,
    };
    of_cuboid("tilted plane", body, radius, dvec3(0.0, 0.0, 3.0))
}

/// A ball of 0.5 m.
pub fn sphere(radius: f64) -> Scene {
    let body = Sphere {
        center: DVec3::ZERO,
        radius: 0.5,
    };
    Scene {
        name: "sphere",
        particles: fill_sphere(&body, radius, 1),
        surface: Box::new(body),
        radius,
        eye: dvec3(0.0, 0.0, 2.0),
        target: DVec3::ZERO,
    }
}

/// A pool of 2 × 0.5 × 2 m with two waves crossing, seen whole from above its rim.
pub fn rippled_pool(radius: f64) -> Scene {
    let body = pool();
    Scene {
        name: "rippled pool",
        particles: fill_pool(&body, radius, 1),
        surface: Box::new(body),
        radius,
        eye: dvec3(0.3, 1.8, 4.0),
        target: dvec3(0.0, -0.1, 0.0),
    }
}

/// A box of 1 m that is filled to a half: all light that enters the top is totally reflected by
/// the walls.
pub fn half_filled_box(radius: f64) -> Scene {
    let body = Cuboid::between(dvec3(-0.5, -0.5, -0.5), dvec3(0.5, 0.0, 0.5));
    of_cuboid("half-filled box", body, radius, dvec3(0.7, 1.0, 1.6))
}

/// A ball before another one, which shows half beside the first.
pub fn two_spheres(radius: f64) -> Scene {
    let balls = [(dvec3(-0.15, 0.0, 0.0), 0.4), (dvec3(0.25, 0.1, -1.2), 0.5)]
        .map(|(center, radius)| Sphere { center, radius });
    Scene {
        name: "two spheres",
        particles: balls
            .iter()
            .flat_map(|ball| fill_sphere(ball, radius, 1))
            .collect(),
        surface: union(balls),
        radius,
        eye: dvec3(0.0, 0.0, 2.0),
        target: DVec3::ZERO,
    }
}

/// [`rippled_pool`] with droplets of one particle each: three in front of it, one inside and
/// three behind, which are seen through the pool.
pub fn pool_and_droplets(radius: f64) -> Scene {
    let scene = rippled_pool(radius);
    let inside = dvec3(0.3, -0.2, 0.3);
    let droplets = [
        dvec3(-0.2, 0.3, 1.2),
        dvec3(0.15, 0.2, 1.3),
        dvec3(0.4, 0.4, 0.9),
        inside,
        dvec3(-0.3, -0.25, -1.2),
        dvec3(0.1, -0.3, -1.3),
        dvec3(0.45, -0.35, -1.2),
    ];
    let around = |p: &DVec3| p.distance(inside) > 1.6 * radius;
    let mut particles: Vec<_> = scene.particles.into_iter().filter(around).collect();
    particles.extend(droplets);
    let mut bodies: Vec<Box<dyn Surface>> = vec![scene.surface];
    bodies.extend(droplets.map(|center| Box::new(Sphere { center, radius }) as _));
    Scene {
        name: "pool and droplets",
        surface: Box::new(Union(bodies)),
        particles,
        ..scene
    }
}

/// A sheet of one layer of particles, 1 × 1 m, a little turned.
pub fn thin_sheet(radius: f64) -> Scene {
    let body = Cuboid {
        center: DVec3::ZERO,
        half: dvec3(0.5, 0.5, radius),
        turn: DQuat::from_rotation_y(PI / 6.0),
    };
    of_cuboid("thin sheet", body, radius, dvec3(0.0, 0.2, 2.0))
}

/// A wall of which the left half stands [`DEPTH_STEP`] radii nearer.
pub fn depth_step(radius: f64) -> Scene {
    let wall = Cuboid::between(dvec3(-0.6, -0.6, -8.0 * radius), dvec3(0.6, 0.6, 0.0));
    let step = Cuboid::between(dvec3(-0.6, -0.6, 0.0), dvec3(0.0, 0.6, DEPTH_STEP * radius));
    let mut particles = fill_cuboid(&wall, radius, 1);
    particles.extend(fill_cuboid(&step, radius, 2));
    // The exact step reaches into the wall: bodies that only touch would keep a skin between.
    let step = Cuboid {
        center: step.center - DVec3::Z * 0.5 * radius,
        half: step.half + DVec3::Z * 0.5 * radius,
        ..step
    };
    Scene {
        name: "depth step",
        surface: union([wall, step]),
        particles,
        radius,
        eye: dvec3(0.0, 0.0, 2.0),
        target: DVec3::ZERO,
    }
}

fn of_cuboid(name: &'static str, body: Cuboid, radius: f64, eye: DVec3) -> Scene {
    Scene {
        name,
        particles: fill_cuboid(&body, radius, 1),
        surface: Box::new(body),
        radius,
        eye,
        target: DVec3::ZERO,
    }
}

fn pool() -> RippledPool {
    let wave = |amplitude: f64, length: f64, degrees: f64, phase: f64| Wave {
        amplitude,
        wave_vector: DVec2::from_angle(degrees.to_radians()) * TAU / length,
        phase,
    };
    RippledPool {
        min: dvec3(-1.0, -0.5, -1.0),
        max: dvec3(1.0, 0.0, 1.0),
        waves: vec![wave(0.04, 0.9, 20.0, 0.0), wave(0.025, 0.55, 110.0, 1.0)],
    }
}

fn union<S: Surface + 'static>(bodies: impl IntoIterator<Item = S>) -> Box<dyn Surface> {
    let boxed = |body| Box::new(body) as Box<dyn Surface>;
    Box::new(Union(bodies.into_iter().map(boxed).collect()))
}
