//! Rays through every scene's exact surface.

use crate::common::{Random, crossings};
use fluid_reference::{
    Camera, Lens, Ray, Surface, layers, scene,
    surface::{Cuboid, Figure, HalfSpace, RippledPool, Sphere, Union, Wave},
};
use glam::{DVec2, DVec3, UVec2, dvec3};

#[test]
fn crossings_take_turns_and_part_inside_from_outside() {
    let mut random = Random(1);
    for scene in scene::all(0.05) {
        let surface = &*scene.surface;
        let mut met = 0;
        for _ in 0..3000 {
            let ray = random.ray();
            let crossings = crossings(surface, &ray);
            met += usize::from(!crossings.is_empty());
            assert!(crossings.len().is_multiple_of(2), "{}", scene.name);
            for (i, crossing) in crossings.iter().enumerate() {
                assert_eq!(crossing.entering, i % 2 == 0, "{}", scene.name);
                assert!((crossing.normal.length() - 1.0).abs() < 1e-12);
                assert_eq!(crossing.entering, crossing.normal.dot(ray.direction) < 0.0);
                // Out along the normal, in against it.
                let at = ray.at(crossing.t);
                let step = 1e-9 * crossing.normal;
                assert_eq!(surface.inside(at + step), None, "{}", scene.name);
                assert_eq!(surface.inside(at - step), Some(0), "{}", scene.name);
            }
            for pair in crossings.windows(2) {
                assert!(pair[0].t < pair[1].t);
                let middle = ray.at(0.5 * (pair[0].t + pair[1].t));
                assert_eq!(
                    surface.inside(middle).is_some(),
                    pair[0].entering,
                    "{}",
                    scene.name
                );
            }
        }
        assert!(met > 300, "{}: {met}", scene.name);
    }
}

#[test]
fn normals_of_waves_are_square_to_them() {
    let mut random = Random(2);
    let pool = waves();
    let at = |p: DVec2| dvec3(p.x, pool.height(p), p.y);
    for _ in 0..1000 {
        let p = DVec2::new(random.next(), random.next());
        for along in [DVec2::X, DVec2::Y] {
            let tangent = at(p + 1e-5 * along) - at(p - 1e-5 * along);
            assert!(tangent.normalize().dot(pool.normal(p)).abs() < 1e-8);
        }
    }
}

/// Short, steep waves: rays can meet them many times.
fn waves() -> RippledPool {
    let wave = |amplitude, x, y, phase| Wave {
        amplitude,
        wave_vector: DVec2::new(x, y),
        phase,
    };
    RippledPool {
        min: DVec3::NEG_ONE,
        max: dvec3(1.0, 0.0, 1.0),
        waves: vec![wave(0.1, 20.0, 3.0, 0.3), wave(0.05, -7.0, 31.0, 1.0)],
    }
}

#[test]
fn grazing_rays_meet_every_wave() {
    let mut random = Random(3);
    let pool = waves();
    let mut most = 0;
    for _ in 0..300 {
        let from = dvec3(-2.0, 0.1 * random.next(), random.next());
        let ray = Ray::new(from, dvec3(2.0, 0.1 * random.next(), random.next()) - from);
        let found = crossings(&pool, &ray);
        most = most.max(found.len());
        // Every change of side in a fine march is one crossing, and there are no others.
        let end = ray.origin.length() + 4.0;
        let steps = 20_000;
        let place = |i| end * f64::from(i) / f64::from(steps);
        let mut inside = pool.inside(ray.at(0.0)).is_some();
        let mut marched = Vec::new();
        for i in 1..=steps {
            let now = pool.inside(ray.at(place(i))).is_some();
            if now != inside {
                marched.push(place(i));
            }
            inside = now;
        }
        // Only touching a crest is too short for the march.
        let long: Vec<_> = found
            .chunks(2)
            .filter(|pair| pair[1].t - pair[0].t > 2.0 * place(1))
            .collect();
        assert!(found.len() >= marched.len() && 2 * long.len() <= marched.len());
        for crossing in long.into_iter().flatten() {
            assert!(marched.iter().any(|t| (t - crossing.t).abs() <= place(1)));
        }
        for crossing in &found {
            let at = ray.at(crossing.t);
            let on_wave = (at.y - pool.height(DVec2::new(at.x, at.z))).abs() < 1e-14;
            let on_side = [at.x, at.y, at.z]
                .iter()
                .any(|c| (c.abs() - 1.0).abs() < 1e-14);
            assert!(on_wave || on_side, "{at}");
        }
    }
    assert!(most >= 8, "{most}");
}

#[test]
fn a_union_keeps_the_outermost() {
    let ball = |x, radius| -> Box<dyn Surface> {
        Box::new(Sphere {
            center: dvec3(x, 0.0, 0.0),
            radius,
        })
    };
    let bodies = [
        ball(0.0, 1.0),
        ball(0.2, 0.3),
        ball(1.5, 1.0),
        ball(4.0, 1.0),
    ];
    let union = Union(bodies.into());
    let ray = Ray::new(dvec3(-3.0, 0.0, 0.0), DVec3::X);
    let expected = [2.0, 5.5, 6.0, 8.0];
    let found: Vec<_> = crossings(&union, &ray).iter().map(|c| c.t).collect();
    assert_eq!(found, expected);
    // From inside, with what lies behind.
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    let found: Vec<_> = crossings(&union, &ray).iter().map(|c| c.t).collect();
    assert_eq!(found, expected.map(|t| t - 3.0));
}

#[test]
fn boxes_that_touch_are_one() {
    let left = Cuboid::between(DVec3::NEG_ONE, dvec3(0.0, 1.0, 1.0));
    let right = Cuboid::between(dvec3(0.0, -1.0, -1.0), DVec3::ONE);
    let union = Union(vec![Box::new(left), Box::new(right)]);
    let ray = Ray::new(dvec3(-3.0, 0.2, 0.1), DVec3::X);
    assert_eq!(crossings(&union, &ray).len(), 2);
}

#[test]
fn layers_hold_the_nearest_front_and_the_farthest_back() {
    for lens in [
        Lens::Perspective {
            fov: 0.7,
            near: 0.1,
        },
        Lens::Orthographic {
            height: 1.5,
            near: 0.0,
            far: 10.0,
        },
    ] {
        let scene = scene::two_spheres(0.1);
        let camera = Camera::new(UVec2::splat(65), lens).looking_at(scene.eye, scene.target);
        let image = layers(&camera, &*scene.surface);
        // Through both spheres.
        let pixel = UVec2::splat(32);
        let all = crossings(&*scene.surface, &camera.pixel_ray(pixel));
        assert_eq!(all.len(), 4);
        let span = image.get(pixel).unwrap();
        assert_eq!([span.front.t, span.back.t], [all[0].t, all[3].t]);
        let near = camera.view_depth(camera.pixel_ray(pixel).at(all[0].t));
        assert!((span.front.view_depth - near).abs() < 1e-12);
        assert!((span.front.device_depth - camera.device_depth(near)).abs() < 1e-12);
        assert!(image.get(UVec2::ZERO).is_none());
    }
}

#[test]
fn inside_a_body_the_front_is_the_near_plane() {
    let ball = Sphere {
        center: DVec3::ZERO,
        radius: 1.0,
    };
    let lens = Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    };
    let camera = Camera::new(UVec2::splat(9), lens);
    let span = layers(&camera, &ball).get(UVec2::splat(4)).unwrap();
    assert!((span.front.device_depth - 1.0).abs() < 1e-12);
    assert!((span.back.view_depth - 1.0).abs() < 1e-12);
}

#[test]
fn a_plane_is_met_from_both_sides() {
    let floor = HalfSpace {
        point: DVec3::ZERO,
        normal: DVec3::Y,
    };
    let down = crossings(&floor, &Ray::new(dvec3(0.3, 2.0, 0.0), DVec3::NEG_Y));
    assert!(down[0].entering && down[0].t == 2.0);
    let up = crossings(&floor, &Ray::new(dvec3(0.3, -2.0, 0.0), DVec3::Y));
    assert!(!up[0].entering && up[0].t == 2.0);
    assert!(crossings(&floor, &Ray::new(DVec3::Y, DVec3::X)).is_empty());
}

#[test]
fn scenes_are_rebuilt_from_their_figures() {
    for scene in scene::all(0.05) {
        let figures = scene.surface.figures();
        let rebuilt = Union(
            figures
                .iter()
                .map(|figure| match figure.clone() {
                    Figure::Sphere(ball) => Box::new(ball) as Box<dyn Surface>,
                    Figure::Cuboid(cuboid) => Box::new(cuboid),
                    Figure::Pool(pool) => Box::new(pool),
                })
                .collect(),
        );
        // Of its seven droplets one is in the pool.
        let wanted = match scene.name {
            "pool and droplets" => 7,
            "two spheres" | "depth step" => 2,
            _ => 1,
        };
        assert_eq!(figures.len(), wanted, "{}", scene.name);
        let mut random = Random(4);
        for _ in 0..300 {
            let ray = random.ray();
            assert_eq!(
                crossings(&*scene.surface, &ray),
                crossings(&rebuilt, &ray),
                "{}",
                scene.name
            );
        }
    }
}
