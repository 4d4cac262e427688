//! The union of ellipsoids.

use crate::common::{Random, crossings};
use fluid_reference::{
    Camera, Lens, Ray, Surface, angle,
    ellipsoids::{Ellipsoid, Ellipsoids},
    layers, scene,
    surface::{Sphere, Union},
};
use glam::{DMat3, DQuat, DVec3, UVec2, dvec3};

const LENSES: [Lens; 2] = [
    Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    Lens::Orthographic {
        height: 2.0,
        near: 0.0,
        far: 1e5,
    },
];

#[test]
fn one_sphere_is_the_analytic_sphere() {
    for distance in [3.0, 1e4] {
        let center = dvec3(0.1, 0.2, -distance);
        let exact = Sphere {
            center,
            radius: 0.7,
        };
        let splat = Ellipsoids::spheres(&[center], 0.7);
        for lens in LENSES {
            let camera = Camera::new(UVec2::splat(64), lens);
            let [a, b] = [layers(&camera, &exact), layers(&camera, &splat)];
            for (a, b) in a.pixels().iter().zip(b.pixels()) {
                assert_eq!(a.is_some(), b.is_some());
                let (Some(a), Some(b)) = (a, b) else { continue };
                for (a, b) in [(a.front, b.front), (a.back, b.back)] {
                    // Near the outline a rounding of 1e-16 · distance grows to its root.
                    assert!((a.t - b.t).abs() < 1e-11 * distance, "{} {}", a.t, b.t);
                    assert!(angle(a.normal, b.normal) < 1e-9 * distance);
                }
            }
        }
    }
}

#[test]
fn many_spheres_are_their_union() {
    let mut random = Random(1);
    let centers: Vec<_> = (0..60).map(|_| random.point()).collect();
    let splats = Ellipsoids::spheres(&centers, 0.2);
    let spheres = centers.iter().map(|&center| {
        let radius = 0.2;
        Box::new(Sphere { center, radius }) as Box<dyn Surface>
    });
    let union = Union(spheres.collect());
    for _ in 0..2000 {
        let ray = random.ray();
        let [a, b] = [crossings(&splats, &ray), crossings(&union, &ray)];
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            assert!((a.t - b.t).abs() < 1e-9 && a.entering == b.entering);
        }
        let point = random.point();
        assert_eq!(splats.inside(point), union.inside(point));
    }
}

#[test]
fn an_ellipsoid_is_a_sphere_under_a_map() {
    let turn = DMat3::from_quat(DQuat::from_axis_angle(dvec3(0.6, 0.0, 0.8), 1.0));
    let axes = dvec3(1.0, 0.5, 0.25);
    let matrix = turn * DMat3::from_diagonal(axes) * turn.transpose();
    let center = dvec3(0.3, -0.1, 0.2);
    let splat = Ellipsoids::new([Ellipsoid { center, matrix }]);
    let mut random = Random(2);
    let mut met = 0;
    for _ in 0..2000 {
        let ray = random.ray();
        for crossing in crossings(&splat, &ray) {
            met += 1;
            let unit = matrix.inverse() * (ray.at(crossing.t) - center);
            assert!((unit.length() - 1.0).abs() < 1e-9);
            // The normal is square to both tangents.
            for tangent in [
                unit.any_orthonormal_vector(),
                unit.cross(unit.any_orthonormal_vector()),
            ] {
                assert!((matrix * tangent).dot(crossing.normal).abs() < 1e-9);
            }
            assert!(crossing.normal.dot(matrix * unit) > 0.0);
        }
    }
    assert!(met > 100);
}

#[test]
fn a_splat_is_read_as_the_renderer_means_it() {
    let splat = Ellipsoid::from_splat([1.0, 2.0, 3.0], 2.0, [1.0, 0.1, 0.2, 0.5, 0.3, 0.25]);
    let rows = [[2.0, 0.2, 0.4], [0.2, 1.0, 0.6], [0.4, 0.6, 0.5]];
    for (i, row) in rows.into_iter().enumerate() {
        for (j, value) in row.into_iter().enumerate() {
            assert!((splat.matrix.col(j)[i] - value).abs() < 1e-7);
        }
    }
    assert_eq!(splat.center, dvec3(1.0, 2.0, 3.0));
}

#[test]
fn flat_ones_and_none_are_nothing() {
    let flat = Ellipsoid {
        center: DVec3::ZERO,
        matrix: DMat3::from_diagonal(dvec3(1.0, 1.0, 0.0)),
    };
    for splats in [Ellipsoids::new([flat]), Ellipsoids::new([])] {
        let ray = Ray::new(DVec3::Z, DVec3::NEG_Z);
        assert!(crossings(&splats, &ray).is_empty());
        assert_eq!(splats.inside(DVec3::ZERO), None);
    }
}

#[test]
fn particles_of_a_scene_come_near_its_surface_from_inside() {
    let scene = scene::sphere(0.05);
    let splats = Ellipsoids::spheres(&scene.particles, scene.radius);
    let camera = scene.camera(UVec2::splat(48));
    let [exact, rough] = [layers(&camera, &*scene.surface), layers(&camera, &splats)];
    let mut compared = 0;
    for (exact, rough) in exact.pixels().iter().zip(rough.pixels()) {
        let Some(rough) = rough else { continue };
        let exact = exact.unwrap();
        assert!(rough.front.t > exact.front.t - 1e-12 && rough.back.t < exact.back.t + 1e-12);
        compared += 1;
    }
    assert!(compared > 400, "{compared}");
}
