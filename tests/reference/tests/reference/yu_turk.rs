//! The implicit surface.

use std::f64::consts::PI;

use crate::common::{Random, crossings};
use fluid_reference::{
    Ray, Surface, angle,
    ellipsoids::Ellipsoid,
    layers,
    metrics::{depth_error, normal_error},
    scene,
    yu_turk::{AnisotropicKernel, ImplicitSurface, anisotropic},
};
use glam::{DMat3, DVec3, UVec2};

const RADIUS: f64 = 0.06;

fn implicit(particles: &[DVec3]) -> ImplicitSurface {
    let splats = anisotropic(particles, RADIUS, &AnisotropicKernel::default());
    ImplicitSurface::new(splats, RADIUS)
}

#[test]
fn one_particle_is_a_sphere_where_the_spline_is_half() {
    let surface = implicit(&[DVec3::ONE]);
    // 8/π · 8/27 · 2 (1 − q)³ = ½ has its root below ½ where the spline has its other form:
    // solved there, 1 − 6q² + 6q³ = 27π/128.
    let wanted = 27.0 * PI / 128.0;
    let (mut low, mut high) = (0.0, 0.5);
    for _ in 0..60 {
        let q: f64 = 0.5 * (low + high);
        if 1.0 - 6.0 * q * q * (1.0 - q) > wanted {
            low = q;
        } else {
            high = q;
        }
    }
    let radius = 3.0 * RADIUS * low;
    let mut random = Random(1);
    for _ in 0..100 {
        let from = DVec3::ONE + random.point().normalize() * 2.0;
        let aside = random.point() * 0.5 * radius;
        let ray = Ray::new(from, DVec3::ONE + aside - from);
        let exact = fluid_reference::surface::Sphere {
            center: DVec3::ONE,
            radius,
        };
        let [a, b] = [crossings(&surface, &ray), crossings(&exact, &ray)];
        assert_eq!((a.len(), b.len()), (2, 2));
        for (a, b) in a.iter().zip(b) {
            assert!((a.t - b.t).abs() < 1e-12 && a.entering == b.entering);
            assert!(angle(a.normal, b.normal) < 1e-9);
        }
    }
}

#[test]
fn the_field_is_even_inside_and_nothing_outside() {
    let surface = implicit(&lattice([15, 15, 15]));
    let mut random = Random(2);
    let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
    for _ in 0..1000 {
        let deep = random.point() * 4.0 * RADIUS;
        let value = surface.field(deep);
        (least, most) = (least.min(value), most.max(value));
        let outside = random.point().normalize() * 32.0 * RADIUS;
        assert_eq!(surface.field(outside), 0.0);
        assert!(surface.inside(deep).is_some() && surface.inside(outside).is_none());
    }
    println!("{least:.4} to {most:.4}");
    assert!(least > 0.98 && most < 1.02);
}

#[test]
fn marching_converges() {
    let scene = scene::two_spheres(RADIUS);
    let surface = implicit(&scene.particles);
    let camera = scene.camera(UVec2::splat(24));
    let mut met = 0;
    for y in 0..24 {
        for x in 0..24 {
            let marched = surface.march(&camera.pixel_ray(UVec2::new(x, y)));
            assert!(marched.change < 1e-3, "{x} {y}: {}", marched.change);
            met += usize::from(!marched.crossings.is_empty());
            let ray = camera.pixel_ray(UVec2::new(x, y));
            for (i, crossing) in marched.crossings.iter().enumerate() {
                assert_eq!(crossing.entering, i % 2 == 0);
                let at = ray.at(crossing.t);
                assert!((surface.field(at) - ImplicitSurface::ISO).abs() < 1e-9);
                // The normal is the field's own slope.
                let step = 1e-6 * RADIUS;
                let slope = DVec3::AXES
                    .map(|axis| surface.field(at + step * axis) - surface.field(at - step * axis));
                assert!(angle(-DVec3::from(slope), crossing.normal) < 1e-3);
            }
        }
    }
    assert!(met > 100, "{met}");
}

#[test]
fn the_surface_follows_the_body() {
    let scene = scene::sphere(RADIUS);
    let surface = implicit(&scene.particles);
    let camera = scene.camera(UVec2::splat(40));
    let [exact, found] = [layers(&camera, &*scene.surface), layers(&camera, &surface)];
    let [truth, measured] =
        [&exact, &found].map(|image| image.map(|span| span.map(|span| span.front.view_depth)));
    let depth = depth_error(&measured, &truth, None, RADIUS).unwrap();
    let [truth, measured] =
        [&exact, &found].map(|image| image.map(|span| span.map(|span| span.front.normal)));
    let normal = normal_error(&measured, &truth, None).unwrap();
    println!(
        "offset {:.3} r, roughness {:.3} r, normals {normal:?}",
        depth.offset, depth.roughness
    );
    // The field swells a little beyond the ellipsoids, which end where the particles do.
    assert!((-0.6..-0.2).contains(&depth.offset), "{depth:?}");
    assert!(normal.p50 < 6.0, "{normal:?}");
}

fn semi_axes(of: &Ellipsoid) -> [f64; 3] {
    // The matrix is symmetric, and in these cases diagonal.
    let m = of.matrix;
    let off = [m.y_axis.x, m.z_axis.x, m.z_axis.y];
    assert!(off.iter().all(|entry| entry.abs() < 1e-12), "{m}");
    [m.x_axis.x, m.y_axis.y, m.z_axis.z]
}

/// A lattice of so many particles along each axis, two radii apart, around the origin.
fn lattice(counts: [i32; 3]) -> Vec<DVec3> {
    let mut out = vec![];
    for x in 0..counts[0] {
        for y in 0..counts[1] {
            for z in 0..counts[2] {
                let middle = DVec3::from(counts.map(|count| 0.5 * f64::from(count - 1)));
                let place = DVec3::from([x, y, z].map(f64::from));
                out.push((place - middle) * 2.0 * RADIUS);
            }
        }
    }
    out
}

#[test]
fn ellipsoids_follow_their_neighbourhood() {
    let kernel = AnisotropicKernel::default();
    let of_middle = |counts| {
        let particles = lattice(counts);
        let middle = particles.iter().position(|p| p.length() < 1e-12).unwrap();
        anisotropic(&particles, RADIUS, &kernel)[middle]
    };
    let near = |found: [f64; 3], expected: [f64; 3]| {
        let mut pairs = found.into_iter().zip(expected);
        assert!(
            pairs.all(|(a, b)| (a - b * RADIUS).abs() < 1e-9),
            "{found:?}"
        );
    };
    // Alone, and with too few others: a sphere of its own radius.
    near(semi_axes(&of_middle([1, 1, 1])), [1.0; 3]);
    near(semi_axes(&of_middle([3, 1, 1])), [1.0; 3]);
    // In the middle of a body: a sphere with the volume of a particle at rest.
    near(semi_axes(&of_middle([7, 7, 7])), [1.24; 3]);
    // In a sheet with more neighbours than the blend needs: a disc, its ratio at the limit.
    let dense = AnisotropicKernel {
        full_neighbors: 8.0,
        ..kernel
    };
    let sheet = lattice([9, 9, 1]);
    let disc = anisotropic(&sheet, RADIUS, &dense)[40];
    let long = 1.24 * 4.0_f64.cbrt();
    near(semi_axes(&disc), [long, long, long / 4.0]);
    assert!((disc.matrix.determinant() - (1.24 * RADIUS).powi(3)).abs() < 1e-12);
}

#[test]
fn coinciding_particles_stay_spheres() {
    let kernel = AnisotropicKernel::default();
    for splat in anisotropic(&[DVec3::ONE; 40], RADIUS, &kernel) {
        assert_eq!(splat.center, DVec3::ONE);
        assert!(
            splat
                .matrix
                .abs_diff_eq(DMat3::from_diagonal(DVec3::splat(RADIUS)), 1e-12)
        );
    }
    assert!(anisotropic(&[], RADIUS, &kernel).is_empty());
    assert!(crossings(&implicit(&[]), &Ray::new(DVec3::ZERO, DVec3::X)).is_empty());
}
