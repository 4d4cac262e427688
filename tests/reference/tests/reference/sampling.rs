//! Particles that fill the scenes.

use std::{collections::HashMap, f64::consts::PI};

use crate::common::{Random, crossings};
use fluid_reference::{Ray, scene, surface::Sphere};
use glam::{DVec3, I64Vec3};

const RADIUS: f64 = 0.03;

/// Distance of every particle from the nearest other one, in radii.
fn spacings(particles: &[DVec3], radius: f64) -> Vec<f64> {
    let cell = |p: DVec3| (p / (4.0 * radius)).floor().as_i64vec3();
    let mut cells: HashMap<I64Vec3, Vec<DVec3>> = HashMap::new();
    for &p in particles {
        cells.entry(cell(p)).or_default().push(p);
    }
    let nearest = |&p: &DVec3| {
        let near = (0..27).filter_map(|i| {
            cells.get(&(cell(p) + I64Vec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)))
        });
        let others = near.flatten().map(|q| p.distance(*q)).filter(|d| *d > 0.0);
        others.fold(f64::INFINITY, f64::min) / radius
    };
    particles.iter().map(nearest).collect()
}

#[test]
fn particles_are_about_two_radii_apart() {
    for scene in scene::all(RADIUS) {
        // Droplets have no neighbours.
        let spacings: Vec<_> = spacings(&scene.particles, RADIUS)
            .into_iter()
            .filter(|spacing| spacing.is_finite())
            .collect();
        let least = spacings.iter().copied().fold(f64::INFINITY, f64::min);
        let mean = spacings.iter().sum::<f64>() / spacings.len() as f64;
        println!(
            "{}: {} particles, {least:.2}, {mean:.2}",
            scene.name,
            scene.particles.len()
        );
        assert!(least > 1.35, "{}: {least}", scene.name);
        assert!((1.7..2.0).contains(&mean), "{}: {mean}", scene.name);
    }
}

#[test]
fn particles_stay_inside_and_reach_the_surface() {
    let mut random = Random(1);
    for scene in scene::all(RADIUS) {
        // Distances from the surface in many directions: the nearest is at least the radius.
        let directions: Vec<_> = (0..60).map(|_| random.point().normalize()).collect();
        let mut outermost = 0;
        for &p in scene.particles.iter().step_by(7) {
            assert!(scene.surface.inside(p).is_some(), "{}: {p}", scene.name);
            let distance = |&direction: &DVec3| {
                let all = crossings(&*scene.surface, &Ray::new(p, direction));
                all.iter()
                    .find(|c| c.t > 0.0)
                    .map_or(f64::INFINITY, |c| c.t)
            };
            let nearest = directions
                .iter()
                .map(distance)
                .fold(f64::INFINITY, f64::min);
            assert!(
                nearest > RADIUS * (1.0 - 1e-9),
                "{}: {p} {nearest}",
                scene.name
            );
            outermost += usize::from(nearest < 1.1 * RADIUS);
        }
        assert!(outermost > 10, "{}: {outermost}", scene.name);
    }
}

#[test]
fn the_top_of_a_pool_touches_its_waves() {
    let scene = scene::rippled_pool(RADIUS);
    let top = |p: &&DVec3| p.y > -0.1;
    let mut touching = 0;
    for &p in scene.particles.iter().filter(top).step_by(5) {
        // Shrinks towards the nearest point of the surface.
        let mut nearest = (f64::INFINITY, DVec3::Y);
        let mut random = Random(1);
        for i in 0..2000 {
            let direction = nearest.1 + random.point() * 0.995_f64.powi(i);
            let ray = Ray::new(p, direction);
            let all = crossings(&*scene.surface, &ray);
            if let Some(c) = all.iter().find(|c| c.t > 0.0 && c.t < nearest.0) {
                nearest = (c.t, ray.direction);
            }
        }
        if nearest.0 < 1.5 * RADIUS {
            touching += 1;
            assert!(
                (nearest.0 / RADIUS - 1.0).abs() < 1e-4,
                "{p}: {}",
                nearest.0 / RADIUS
            );
        }
    }
    assert!(touching > 50, "{touching}");
}

#[test]
fn a_particle_fills_a_cube_of_two_radii() {
    let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
    let volumes = [
        ("slab", 2.0 * 2.0 * 0.4),
        ("tilted plane", 2.0 * 4.0 * 8.0 * RADIUS),
        ("sphere", ball(0.5)),
        // The waves have as many crests as troughs, nearly.
        ("rippled pool", 2.0 * 2.0 * 0.5),
        ("half-filled box", 0.5),
        ("two spheres", ball(0.4) + ball(0.5)),
        ("pool and droplets", 2.0 * 2.0 * 0.5),
        ("thin sheet", 2.0 * RADIUS),
        (
            "depth step",
            1.2 * 1.2 * 8.0 * RADIUS + 0.6 * 1.2 * 10.0 * RADIUS,
        ),
    ];
    for scene in scene::all(RADIUS) {
        let (_, volume) = volumes
            .iter()
            .find(|(name, _)| *name == scene.name)
            .unwrap();
        let filled = scene.particles.len() as f64 * (2.0 * RADIUS).powi(3) / volume;
        println!("{}: {filled:.3}", scene.name);
        assert!((0.9..1.1).contains(&filled), "{}: {filled}", scene.name);
    }
}

#[test]
fn a_scene_is_the_same_every_time() {
    for (a, b) in scene::all(0.06).iter().zip(scene::all(0.06)) {
        assert_eq!(a.particles, b.particles);
        assert_eq!(a.positions().len(), b.particles.len());
    }
}

#[test]
fn tiny_balls_have_a_particle_in_their_middle() {
    for size in [1.0, 1.4] {
        let ball = Sphere {
            center: DVec3::ONE,
            radius: size * RADIUS,
        };
        assert_eq!(scene::fill_sphere(&ball, RADIUS, 1), [DVec3::ONE]);
    }
    let sheet = scene::thin_sheet(RADIUS);
    let turned = Ray::new(sheet.particles[0], DVec3::Z);
    assert!(sheet.surface.inside(turned.origin).is_some());
}
