//! Light through bodies whose answer is known in closed form.

use std::f64::consts::{FRAC_PI_2, SQRT_2};

use crate::common::Random;
use fluid_reference::{
    Ray, Surface, angle, scene,
    surface::{Cuboid, HalfSpace, Sphere},
    tracer::{End, Object, Optics, Reflections, Sky, Tracer, World, checker, meet},
};
use glam::{DVec3, UVec2, dvec3};

const WHITE: &Sky = &|_| DVec3::ONE;
/// White from above, black from below.
const HALF: &Sky = &|direction| DVec3::splat(f64::from(u8::from(direction.y > 0.0)));
const INDEX: f64 = 1.33;

fn optics(refractive_index: f64) -> Optics {
    Optics {
        refractive_index,
        extinction: DVec3::ZERO,
    }
}

fn world(surface: &dyn Surface) -> World<'_> {
    World {
        surface,
        objects: &[],
        sky: WHITE,
    }
}

fn slab(thickness: f64) -> Cuboid {
    let far = dvec3(1e3, 0.5 * thickness, 1e3);
    Cuboid::between(-far, far)
}

const BALL: Sphere = Sphere {
    center: DVec3::ZERO,
    radius: 1.0,
};

/// Down on the origin at an angle to the vertical.
fn down(incident: f64, y: f64) -> Ray {
    let direction = dvec3(incident.sin(), -incident.cos(), 0.0);
    Ray::new(DVec3::Y * y - direction, direction)
}

fn fresnel(incident: f64, index: f64) -> f64 {
    let refracted = (incident.sin() / index).asin();
    if incident == 0.0 {
        return ((index - 1.0) / (index + 1.0)).powi(2);
    }
    let [minus, plus] = [incident - refracted, incident + refracted];
    0.5 * ((minus.sin() / plus.sin()).powi(2) + (minus.tan() / plus.tan()).powi(2))
}

#[test]
fn a_slab_shifts_rays_and_leaves_their_direction() {
    let body = slab(0.7);
    let tracer = Tracer::renderer(world(&body), optics(INDEX));
    for degrees in [0.0_f64, 10.0, 45.0, 80.0, 89.0] {
        let incident = degrees.to_radians();
        let refracted = (incident.sin() / INDEX).asin();
        let ray = down(incident, 0.35);
        let path = tracer.path(ray);
        assert_eq!((path.vertices.len(), path.end), (2, End::Sky));
        assert!(angle(path.exit.direction, ray.direction) < 1e-10);
        let shift = (path.exit.origin - ray.origin)
            .cross(ray.direction)
            .length();
        let expected = 0.7 * (incident - refracted).sin() / refracted.cos();
        assert!((shift - expected).abs() < 1e-10, "{shift}, not {expected}");
        let passes = 1.0 - fresnel(incident, INDEX);
        assert!((path.transmission.x - passes * passes).abs() < 1e-10);
    }
}

#[test]
fn a_sphere_turns_rays_twice_and_absorbs_along_the_chord() {
    let extinction = dvec3(0.1, 1.0, 3.0);
    let optics = Optics {
        refractive_index: INDEX,
        extinction,
    };
    let tracer = Tracer::renderer(world(&BALL), optics);
    for sine in [0.0_f64, 0.1, 0.5, 0.9, 0.99, 0.9999] {
        let [incident, refracted] = [sine.asin(), (sine / INDEX).asin()];
        let ray = Ray::new(dvec3(sine, 0.0, 5.0), DVec3::NEG_Z);
        let path = tracer.path(ray);
        let bent = angle(path.exit.direction, ray.direction);
        let expected = 2.0 * (incident - refracted).to_degrees();
        assert!((bent - expected).abs() < 1e-9, "{bent}, not {expected}");
        let passes = 1.0 - fresnel(incident, INDEX);
        let kept = (-extinction * 2.0 * refracted.cos()).exp() * passes * passes;
        assert!(path.transmission.distance(kept) < 1e-9);
    }
}

#[test]
fn reflectance_is_fresnels_from_both_sides() {
    for degrees in [0.0_f64, 20.0, 53.061, 70.0, 89.0] {
        let incident = degrees.to_radians();
        let ray = down(incident, 0.0);
        let outside = meet(ray.direction, DVec3::Y, 1.0 / INDEX);
        assert!((outside.reflectance - fresnel(incident, INDEX)).abs() < 1e-12);
        // Light that goes back is reflected as much.
        let inside = meet(-outside.refracted.unwrap(), DVec3::NEG_Y, INDEX);
        assert!((inside.reflectance - outside.reflectance).abs() < 1e-12);
        assert!(angle(inside.refracted.unwrap(), -ray.direction) < 1e-6);
    }
}

#[test]
fn the_critical_angle_has_no_gap() {
    let critical = (1.0 / INDEX).asin();
    for (offset, total) in [(-1e-6, false), (0.0, false), (1e-6, true)] {
        let at = meet(down(critical + offset, 0.0).direction, DVec3::Y, INDEX);
        assert!(at.reflectance.is_finite() && at.reflected.is_finite());
        assert!(offset == 0.0 || at.refracted.is_none() == total);
        assert!(at.reflectance > 0.98 && at.reflectance <= 1.0);
    }
    // And so has grazing, even by a normal that looks away.
    for normal in [DVec3::Y, dvec3(0.1, 1.0, 0.0).normalize()] {
        let at = meet(DVec3::X, normal, 1.0 / INDEX);
        assert!(at.reflectance > 0.999 && at.refracted.unwrap().is_finite());
    }
}

#[test]
fn nothing_is_lost_or_made_in_a_white_furnace() {
    let mut random = Random(1);
    for scene in scene::all(0.08) {
        for index in [1.0, 1.33, 1.5, 0.75] {
            let world = world(&*scene.surface);
            let tracers = [
                Tracer::truth(world, optics(index)),
                Tracer::renderer(world, optics(index)),
            ];
            for _ in 0..100 {
                let ray = random.ray();
                for tracer in tracers {
                    let light = tracer.radiance(ray);
                    assert!(
                        (light - 1.0).abs().max_element() < 1e-9,
                        "{}: {light}",
                        scene.name
                    );
                }
            }
        }
    }
}

#[test]
fn a_plate_reflects_back_and_forth() {
    let body = slab(1.0);
    for extinction in [0.0_f64, 0.3] {
        let optics = Optics {
            refractive_index: 2.0,
            extinction: DVec3::splat(extinction),
        };
        for degrees in [0.0_f64, 40.0, 75.0] {
            let incident = degrees.to_radians();
            let r = fresnel(incident, 2.0);
            let length = 1.0 / (incident.sin() / 2.0).asin().cos();
            let a = (-extinction * length).exp();
            let world = World {
                sky: HALF,
                ..world(&body)
            };
            let light = Tracer {
                interfaces: 40,
                faintest: 0.0,
                ..Tracer::truth(world, optics)
            }
            .radiance(down(incident, 0.5));
            // The geometric series of all that comes back out of the top.
            let expected = r + (1.0 - r).powi(2) * r * a * a / (1.0 - r * r * a * a);
            assert!(
                (light.x - expected).abs() < 1e-6,
                "{degrees}°: {}, not {expected}",
                light.x
            );
            // The renderer's model sees the sky at the bottom too, which is black there, or white
            // where that reflects upwards.
            let model = Tracer::renderer(world, optics).radiance(down(incident, 0.5));
            let expected = r + (1.0 - r) * a * r;
            assert!((model.x - expected).abs() < 1e-9);
        }
    }
}

#[test]
fn light_through_a_flat_top_never_leaves_by_a_wall() {
    let body = Cuboid::between(dvec3(-0.5, -100.0, -50.0), dvec3(0.5, 0.0, 50.0));
    let tracer = Tracer::renderer(world(&body), optics(INDEX));
    // n² − 1 = sin² of the last angle.
    let last = (INDEX * INDEX - 1.0).sqrt().asin();
    assert!((last.to_degrees() - 61.3).abs() < 0.05);
    for i in 1..100 {
        let incident = FRAC_PI_2 * f64::from(i) / 100.0;
        let path = tracer.path(down(incident, 0.0));
        let wall = path.vertices[1];
        assert!(wall.normal.x.abs() == 1.0);
        assert_eq!(
            wall.totally_reflected,
            incident < last,
            "{}°",
            incident.to_degrees()
        );
    }
    // All of the truth's light inside is still there.
    let light = Tracer::truth(world(&body), optics(INDEX)).radiance(down(0.8, 0.0));
    assert!((light - 1.0).abs().max_element() < 1e-9);
}

#[test]
fn total_reflection_without_end_stops_at_the_budget() {
    let body = Cuboid::between(DVec3::NEG_ONE, DVec3::ONE);
    for interfaces in [0, 1, 4, 50] {
        let tracer = Tracer {
            interfaces,
            ..Tracer::renderer(world(&body), optics(2.0))
        };
        // Along a square within a cube: 45° at each wall.
        let path = tracer.path(Ray::new(dvec3(-0.5, 0.1, 0.0), dvec3(1.0, 0.0, 1.0)));
        assert_eq!(
            (path.vertices.len() as u32, path.end),
            (interfaces, End::Budget)
        );
        assert!(path.vertices.iter().all(|vertex| vertex.totally_reflected));
        assert_eq!(path.transmission, DVec3::ONE);
    }
}

#[test]
fn index_one_bends_nothing_and_an_index_below_reflects_outside() {
    let ray = Ray::new(dvec3(0.8, 0.0, 5.0), DVec3::NEG_Z);
    let path = Tracer::renderer(world(&BALL), optics(1.0)).path(ray);
    assert!(angle(path.exit.direction, ray.direction) < 1e-6);
    assert!((path.transmission - 1.0).abs().max_element() < 1e-12);
    // A bubble: sine 0.8 is beyond the critical 0.75.
    let path = Tracer::renderer(world(&BALL), optics(0.75)).path(ray);
    assert_eq!(path.vertices.len(), 1);
    assert!(path.vertices[0].totally_reflected && path.end == End::Sky);
    assert!(path.exit.direction.z > -1.0);
}

#[test]
fn rays_that_start_inside_only_leave() {
    let path = Tracer::renderer(world(&BALL), optics(INDEX)).path(Ray::new(DVec3::ZERO, DVec3::X));
    assert_eq!(path.vertices.len(), 1);
    assert!(!path.vertices[0].entering);
}

#[test]
fn opaque_things_hide_what_is_behind_them() {
    let red = |z: f64| {
        let body = Sphere {
            center: DVec3::Z * z,
            radius: 0.2,
        };
        [Object::new(body, |_| DVec3::X)]
    };
    let optics = Optics {
        refractive_index: INDEX,
        extinction: DVec3::ONE,
    };
    let passes = 1.0 - fresnel(0.0, INDEX);
    let reflected = DVec3::splat(1.0 - passes);
    let cases = [
        // Before, inside, and behind the ball.
        (2.0, 0, DVec3::X),
        (0.0, 1, reflected + DVec3::X * passes * (-0.8_f64).exp()),
        (-2.0, 2, {
            let inner = passes * (-2.0_f64).exp();
            reflected + inner * (reflected + DVec3::X * passes)
        }),
    ];
    for (z, interfaces, expected) in cases {
        let objects = red(z);
        let world = World {
            objects: &objects,
            ..world(&BALL)
        };
        let tracer = Tracer::renderer(world, optics);
        let ray = Ray::new(DVec3::Z * 5.0, DVec3::NEG_Z);
        let path = tracer.path(ray);
        assert_eq!((path.vertices.len(), path.end), (interfaces, End::Opaque));
        assert!((path.exit.origin.z - (z + 0.2)).abs() < 1e-12);
        let light = tracer.radiance(ray);
        assert!(light.distance(expected) < 1e-12, "{light}, not {expected}");
    }
}

#[test]
fn a_checker_lies_on_a_floor() {
    let floor = HalfSpace {
        point: DVec3::NEG_Y * 3.0,
        normal: DVec3::Y,
    };
    let colors = [DVec3::X, DVec3::Z];
    let objects = [Object::new(
        floor,
        checker([DVec3::X, DVec3::Z], 0.5, colors),
    )];
    let nothing = Sphere {
        center: DVec3::X * 100.0,
        radius: 1.0,
    };
    let world = World {
        objects: &objects,
        ..world(&nothing)
    };
    let tracer = Tracer::truth(world, Optics::WATER);
    for (x, z, color) in [
        (0.2, 0.3, 0),
        (0.7, 0.3, 1),
        (-0.2, 0.3, 1),
        (-0.2, -0.3, 0),
    ] {
        let seen = tracer.radiance(Ray::new(dvec3(x, 1.0, z), DVec3::NEG_Y));
        assert_eq!(seen, colors[color]);
    }
    assert_eq!(tracer.radiance(Ray::new(DVec3::ZERO, DVec3::Y)), DVec3::ONE);
}

/// A sky with detail everywhere.
fn stripes(direction: DVec3) -> DVec3 {
    (direction * dvec3(9.0, 7.0, 5.0)).map(f64::sin) * 0.5 + 0.5
}

#[test]
fn a_picture_knows_its_error() {
    let scene = scene::two_spheres(0.1);
    let world = World {
        sky: &stripes,
        ..world(&*scene.surface)
    };
    let tracer = Tracer::renderer(world, Optics::WATER);
    let camera = scene.camera(UVec2::splat(32));
    let finest = tracer.render(&camera, 64);
    let mut last = f64::INFINITY;
    for judged in [1.0, 0.3, 0.1] {
        let picture = tracer.render_converged(&camera, judged, 32);
        assert!(
            picture.error <= 0.1 * judged,
            "{} with {}²",
            picture.error,
            picture.side
        );
        let pairs = picture.image.pixels().iter().zip(finest.pixels());
        let squared: f64 = pairs.map(|(a, b)| a.distance_squared(*b)).sum();
        let error = (squared / (3.0 * 32.0 * 32.0)).sqrt();
        println!(
            "judged {judged}: {}² samples, claimed {:.5}, true {error:.5}",
            picture.side, picture.error
        );
        assert!(error <= 1.1 * picture.error && picture.error < last);
        last = picture.error;
    }
    // What cannot converge says so.
    let picture = tracer.render_converged(&camera, 0.0, 4);
    assert!(picture.side == 4 && picture.error > 0.0);
}

#[test]
fn the_modes_differ_by_what_reflections_see() {
    let scene = scene::half_filled_box(0.1);
    let objects = [Object::new(
        HalfSpace {
            point: DVec3::NEG_Y * 0.5,
            normal: DVec3::Y,
        },
        |_| DVec3::X,
    )];
    let world = World {
        surface: &*scene.surface,
        objects: &objects,
        sky: WHITE,
    };
    let truth = Tracer::truth(world, Optics::WATER);
    let model = Tracer::renderer(world, Optics::WATER);
    assert_eq!(
        (truth.reflections, model.reflections),
        (Reflections::Traced, Reflections::Sky)
    );
    // Through the top against a wall, which reflects it to the red floor: the same path, and all
    // that differs is the light that the top reflects, which is the sky in both.
    let ray = Ray::new(dvec3(-0.6, 1.0, 0.0), dvec3(0.9, -1.0, 0.0));
    assert!(truth.radiance(ray).distance(model.radiance(ray)) < 1e-5);
    // From below the level into a wall and out of the top: there the truth sees red as well.
    let ray = Ray::new(dvec3(-2.0, -0.6, 0.0), dvec3(1.0, 0.25 / SQRT_2, 0.0));
    assert!(truth.path(ray).end != End::Budget);
    let [seen, modelled] = [truth.radiance(ray), model.radiance(ray)];
    assert!(modelled.distance(DVec3::ONE) < 1e-9 && (seen.x - 1.0).abs() < 1e-5);
    assert!(seen.y < 1.0 - 1e-4 && seen.y == seen.z, "{seen}");
}
