//! Meshes of depth images against the surfaces that the images are of.

use crate::common::crossings;
use fluid_reference::{
    Camera, Image, Lens, Ray, Surface, angle, layers,
    mesh::{Layer, LayerMeshes, Sheet},
    scene,
    surface::{Cuboid, Sphere, Union},
    tracer::{End, Optics, Tracer, World},
};
use glam::{DQuat, DVec2, DVec3, UVec2, dvec3};

const LENSES: [Lens; 2] = [
    Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    Lens::Orthographic {
        height: 1.5,
        near: 0.0,
        far: 20.0,
    },
];

const BALL: Sphere = Sphere {
    center: DVec3::new(0.0, 0.0, -3.0),
    radius: 0.6,
};

fn plate() -> Cuboid {
    Cuboid {
        center: dvec3(0.0, 0.0, -4.0),
        half: dvec3(9.0, 9.0, 0.3),
        turn: DQuat::from_rotation_y(0.6) * DQuat::from_rotation_x(0.3),
    }
}

fn mesh_of(camera: &Camera, surface: &dyn Surface) -> LayerMeshes {
    LayerMeshes::new(camera, &[Layer::from_spans(&layers(camera, surface))], 0.3)
}

fn without_normals(mut layer: Layer) -> Layer {
    layer.front.normals = None;
    layer.back.normals = None;
    layer
}

#[test]
fn the_mesh_of_a_plane_is_the_plane() {
    for lens in LENSES {
        let camera = Camera::new(UVec2::new(40, 30), lens);
        let exact = Layer::from_spans(&layers(&camera, &plate()));
        for layer in [exact.clone(), without_normals(exact)] {
            let mesh = LayerMeshes::new(&camera, &[layer], 1.0);
            // Two triangles between four pixels, front and back.
            assert_eq!(mesh.triangles(), 39 * 29 * 4);
            for i in 0..400 {
                // Through the middles of pixels, where vertices are, and between them.
                let point =
                    DVec2::new(1.0 + 38.0 / 400.0 * f64::from(i), 1.0 + 0.07 * f64::from(i));
                for point in [point, point.floor() + 0.5] {
                    let ray = camera.ray(point);
                    let [a, b] = [crossings(&mesh, &ray), crossings(&plate(), &ray)];
                    assert_eq!((a.len(), b.len()), (2, 2), "{point}");
                    for (a, b) in a.iter().zip(b) {
                        assert!((a.t - b.t).abs() < 1e-9 && a.entering == b.entering);
                        assert!(angle(a.normal, b.normal) < 1e-5);
                    }
                }
            }
        }
    }
}

#[test]
fn the_mesh_of_a_sphere_nears_it_with_the_square_of_the_pixels() {
    for lens in LENSES {
        let errors = [32_u32, 64, 128].map(|side| {
            let camera = Camera::new(UVec2::splat(side), lens);
            let exact = Layer::from_spans(&layers(&camera, &BALL));
            let mesh = LayerMeshes::new(&camera, &[without_normals(exact)], 0.3);
            let mut worst = [0.0_f64; 2];
            for i in 0..500 {
                // Some way from the outline, on no grid.
                let turn = DVec2::from_angle(2.4 * f64::from(i)) * (f64::from(i) / 500.0).sqrt();
                let ray = camera.ray((turn * 0.2 + 0.5) * f64::from(side));
                let [a, b] = [crossings(&mesh, &ray), crossings(&BALL, &ray)];
                assert_eq!((a.len(), b.len()), (2, 2));
                for (a, b) in a.iter().zip(b) {
                    worst[0] = worst[0].max((a.t - b.t).abs());
                    worst[1] = worst[1].max(angle(a.normal, b.normal));
                }
            }
            worst
        });
        println!("{errors:?}");
        for pair in errors.windows(2) {
            let [coarse, fine] = [pair[0], pair[1]];
            assert!(
                fine[0] < 0.35 * coarse[0] && fine[1] < 0.35 * coarse[1],
                "{errors:?}"
            );
        }
    }
}

#[test]
fn light_goes_through_the_mesh_as_through_the_body() {
    for lens in LENSES {
        let camera = Camera::new(UVec2::splat(256), lens);
        let mesh = mesh_of(&camera, &BALL);
        let sky = |_: DVec3| DVec3::ONE;
        let trace = |surface: &dyn Surface, pixel: UVec2| {
            let world = World {
                surface,
                objects: &[],
                sky: &sky,
            };
            Tracer::renderer(world, Optics::WATER).path(camera.pixel_ray(pixel))
        };
        for i in 0..60 {
            let pixel = UVec2::new(128 + i, 128 + i / 3);
            let [a, b] = [trace(&mesh, pixel), trace(&BALL, pixel)];
            assert_eq!((a.vertices.len(), a.end), (b.vertices.len(), End::Sky));
            let off = angle(a.exit.direction, b.exit.direction);
            assert!(off < 0.05, "{pixel}: {off}°");
        }
    }
}

#[test]
fn steps_in_depth_are_not_bridged() {
    let scene = scene::depth_step(0.05);
    let camera = scene.camera(UVec2::splat(64));
    let exact = layers(&camera, &*scene.surface);
    let mesh = LayerMeshes::new(&camera, &[Layer::from_spans(&exact)], 0.1);
    let bridged = LayerMeshes::new(&camera, &[Layer::from_spans(&exact)], 1.0);
    assert!(mesh.triangles() < bridged.triangles());
    // Across the step, just right of the middle of the picture, a front is as deep as one of the
    // two sides.
    for x in 0..64 {
        let ray = camera.ray(DVec2::new(31.0 + f64::from(x) / 32.0, 31.7));
        for crossing in crossings(&mesh, &ray).iter().filter(|c| c.entering) {
            let z = ray.at(crossing.t).z;
            assert!(z.abs() < 1e-6 || (z - 0.5).abs() < 1e-6, "{z}");
        }
    }
}

#[test]
fn bodies_are_told_apart_and_entered_once() {
    let camera = Camera::new(UVec2::splat(64), LENSES[0]);
    let small = Sphere {
        center: dvec3(0.0, 0.0, -5.0),
        radius: 0.4,
    };
    let bodies: [&dyn Surface; 2] = [&BALL, &small];
    let spans = bodies.map(|body| Layer::from_spans(&layers(&camera, body)));
    let mesh = LayerMeshes::new(&camera, &spans, 0.3);
    let sky = |_: DVec3| DVec3::ONE;
    let world = World {
        surface: &mesh,
        objects: &[],
        sky: &sky,
    };
    let tracer = Tracer::renderer(world, Optics::WATER);
    let ray = camera.ray(DVec2::splat(32.2));
    let path = tracer.path(ray);
    let met: Vec<_> = path.vertices.iter().map(|v| (v.body, v.entering)).collect();
    assert_eq!(met, [(0, true), (0, false), (1, true), (1, false)]);
    // Both balls' layers as one: the second ball's front is hidden by the first.
    let union = Union(vec![Box::new(BALL), Box::new(small)]);
    let merged = mesh_of(&camera, &union);
    let all = crossings(&merged, &ray);
    assert_eq!(all.len(), 2);
    assert!((ray.at(all[1].t).z + 5.4).abs() < 0.01);
}

#[test]
fn a_body_is_not_entered_again_if_one_asks() {
    let behind = Sphere {
        center: dvec3(0.0, 0.0, -6.0),
        ..BALL
    };
    let union = Union(vec![Box::new(BALL), Box::new(behind)]);
    let sky = |_: DVec3| DVec3::ONE;
    let world = World {
        surface: &union,
        objects: &[],
        sky: &sky,
    };
    for (each_body_once, count) in [(false, 4), (true, 2)] {
        let tracer = Tracer {
            each_body_once,
            ..Tracer::renderer(world, Optics::WATER)
        };
        let path = tracer.path(Ray::new(DVec3::ZERO, DVec3::NEG_Z));
        assert_eq!(path.vertices.len(), count);
    }
}

#[test]
fn inside_is_between_front_and_back() {
    let camera = Camera::new(UVec2::splat(64), LENSES[0]);
    let mesh = mesh_of(&camera, &BALL);
    for (point, inside) in [
        (BALL.center, Some(0)),
        (BALL.center + DVec3::Z * 0.59, Some(0)),
        (BALL.center + DVec3::Z * 0.61, None),
        (BALL.center - DVec3::Z * 0.61, None),
        (DVec3::Z, None),
        (DVec3::X * 100.0 + DVec3::NEG_Z, None),
    ] {
        assert_eq!(mesh.inside(point), inside, "{point}");
    }
    // A camera inside sees the near plane as its front, and starts in the liquid.
    let around = Sphere {
        center: DVec3::ZERO,
        radius: 2.0,
    };
    let mesh = mesh_of(&camera, &around);
    for x in 1..63 {
        assert_eq!(
            mesh.inside(camera.pixel_ray(UVec2::new(x, 20)).origin),
            Some(0)
        );
    }
}

#[test]
fn holes_and_single_pixels_have_no_triangles() {
    let camera = Camera::new(UVec2::splat(3), LENSES[0]);
    let sheet = |there: fn(UVec2) -> bool| Sheet {
        depth: Image::from_fn(UVec2::splat(3), |pixel| there(pixel).then_some(0.05)),
        normals: None,
    };
    let count = |there| {
        let layer = Layer {
            front: sheet(there),
            back: sheet(|_| false),
        };
        LayerMeshes::new(&camera, &[layer], 0.1).triangles()
    };
    assert_eq!(count(|_| false), 0);
    assert_eq!(count(|pixel| pixel == UVec2::ONE), 0);
    assert_eq!(count(|_| true), 8);
    // Each of the four squares has lost a corner.
    assert_eq!(count(|pixel| pixel != UVec2::ONE), 4);
}
