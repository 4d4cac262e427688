//! Particles → splats: what the shape stage promises, through its public interface.

use bevy::math::{EulerRot, Mat3, Quat, Vec3};
use bevy_fluid::{
    prelude::Settings,
    shape::{FluidSplats, ShapeError, ShapeWorkspace, Splat, SurfaceKernel},
};
use proptest::prelude::*;

use crate::oracle::{self, Random, lattice};

mod axes;
mod classes;

/// Particle radius; particles at rest are two of them apart.
const R: f32 = 0.025;
const SPACING: f32 = 2.0 * R;
/// Rounding of the f16 axes, twice over.
const F16: f32 = 2e-3;

/// Every particle is bulk and an ellipsoid.
const BULK: SurfaceKernel = SurfaceKernel {
    neighbor_radius: 4.0,
    spray_threshold: 0,
    anisotropic: true,
    center_shift: 0.9,
    surface_offset: 1.15,
    max_ratio: 4.0,
    radius_scale: 1.24,
    sphere_neighbors: 0,
    full_neighbors: 1,
    skip_interior: false,
};

fn shape_with(positions: &[Vec3], radius: f32, kernel: &SurfaceKernel) -> FluidSplats {
    let mut splats = FluidSplats::default();
    ShapeWorkspace::default()
        .shape(positions, radius, kernel, &mut splats)
        .unwrap();
    check(&splats, positions, kernel);
    splats
}

fn shape(positions: &[Vec3]) -> FluidSplats {
    shape_with(positions, R, &SurfaceKernel::default())
}

/// What holds for every input.
fn check(splats: &FluidSplats, positions: &[Vec3], kernel: &SurfaceKernel) {
    let count = splats.bulk + splats.interior + splats.spray;
    let partial = splats.partial_bulk + splats.partial_spray;
    assert_eq!(splats.splats.len(), (count + partial) as usize);
    let finite = positions.iter().filter(|p| p.is_finite()).count();
    assert_eq!(count as usize, finite);
    assert_eq!(splats.dropped as usize, positions.len() - finite);
    let mut seen = vec![0; positions.len()];
    for splat in &splats.splats {
        let particle = splat.particle as usize;
        assert!(positions[particle].is_finite());
        seen[particle] += 1;
        let center = Vec3::from(splat.center);
        assert!(center.is_finite() && splat.scale > 0.0 && splat.scale.is_finite());
        let [long, middle, short] = semi_axes(splat);
        assert!(short > 0.0 && long >= middle && long <= splat.scale * (1.0 + F16));
        assert!(long / short <= kernel.max_ratio * (1.0 + 4.0 * F16));
        let half_size = extent(splat);
        assert!((center - half_size * (1.0 - F16)).cmpge(splats.min).all());
        assert!((center + half_size * (1.0 - F16)).cmple(splats.max).all());
    }
    assert!(
        seen.iter()
            .zip(positions)
            .all(|(&seen, p)| (1..=2).contains(&seen) == p.is_finite())
    );
    let twice = seen.iter().filter(|&&seen| seen == 2).count();
    assert_eq!(twice, partial as usize);
    for sphere in splats.by_class()[1..].iter().copied().flatten() {
        assert_eq!(
            Vec3::from(sphere.center),
            positions[sphere.particle as usize]
        );
        assert_eq!(sphere.matrix(), Mat3::IDENTITY * sphere.scale);
    }
}

/// Semi-axes in m, longest first.
fn semi_axes(splat: &Splat) -> [f32; 3] {
    let axes = splat.axes.map(|entry| f64::from(entry.to_f32()));
    oracle::eigenvalues(axes).map(|value| value as f32 * splat.scale)
}

/// Half of the ellipsoid's bounding box, in m.
fn extent(splat: &Splat) -> Vec3 {
    let rows = splat.matrix().transpose();
    Vec3::new(
        rows.x_axis.length(),
        rows.y_axis.length(),
        rows.z_axis.length(),
    )
}

/// The splat of full size of a particle, and its class: 0 bulk, 1 interior, 2 spray.
fn find(splats: &FluidSplats, particle: usize) -> (Splat, usize) {
    let is_it = |splat: &&Splat| splat.particle as usize == particle;
    let [bulk, interior, spray] = splats.by_class();
    let bulk = &bulk[splats.partial_bulk as usize..];
    let spray = &spray[..splats.spray as usize];
    let mut classes = [bulk, interior, spray].into_iter().enumerate();
    classes
        .find_map(|(class, splats)| Some((*splats.iter().find(is_it)?, class)))
        .unwrap()
}

/// Every splat, and the one of the same class in other splats, where its particle is `other`.
fn pairs<'a>(
    splats: &'a FluidSplats,
    others: &'a FluidSplats,
    other: impl Fn(usize) -> usize,
) -> Vec<(Splat, Splat)> {
    let classes = splats.by_class().into_iter().zip(others.by_class());
    let pairs = classes.flat_map(|(class, others)| {
        let other = &other;
        class.iter().map(move |splat| {
            let particle = other(splat.particle as usize);
            let is_it = |other: &&Splat| other.particle as usize == particle;
            (*splat, *others.iter().find(is_it).unwrap())
        })
    });
    pairs.collect()
}

fn assert_sphere(splat: &Splat, center: Vec3, radius: f32) {
    assert!(Vec3::from(splat.center).distance(center) <= 1e-5 * radius);
    for axis in semi_axes(splat) {
        assert!((axis / radius - 1.0).abs() < F16, "{axis} for {radius}");
    }
}

#[test]
fn h01_h02_positions_that_are_not_finite_are_dropped_and_counted() {
    let good = lattice(6, SPACING, 0.2);
    let mut positions = good.clone();
    let bad = [
        Vec3::splat(f32::NAN),
        Vec3::new(0.0, f32::NAN, 0.0),
        Vec3::splat(f32::INFINITY),
        Vec3::new(0.0, 0.0, f32::NEG_INFINITY),
    ];
    positions.splice(50..50, bad);
    let splats = shape(&positions);
    assert_eq!(splats.dropped, 4);
    let without = shape(&good);
    assert_eq!(splats.splats.len(), without.splats.len());
    for (with, without) in splats.splats.iter().zip(&without.splats) {
        let moved = if without.particle < 50 { 0 } else { 4 };
        assert_eq!(with.particle, without.particle + moved);
        assert_eq!((with.center, with.axes), (without.center, without.axes));
    }
    assert_eq!(shape(&bad).splats, []);
}

#[test]
fn h03_a_radius_that_is_no_length_is_an_error() {
    for radius in [
        0.0,
        -0.0,
        -1.0,
        f32::NAN,
        f32::INFINITY,
        f32::MIN_POSITIVE,
        f32::MAX,
    ] {
        let mut splats = shape(&[Vec3::ZERO]);
        let result = ShapeWorkspace::default().shape(
            &[Vec3::ZERO],
            radius,
            &SurfaceKernel::default(),
            &mut splats,
        );
        let error = result.unwrap_err();
        assert!(matches!(error, ShapeError::Radius(r) if r.to_bits() == radius.to_bits()));
        assert!(error.to_string().contains("radius"), "{error}");
        assert_eq!((splats.splats.len(), splats.spray), (0, 0));
        // What is empty yet has none.
        let mut splats = shape(&[Vec3::ZERO]);
        ShapeWorkspace::default()
            .shape(&[], radius, &SurfaceKernel::default(), &mut splats)
            .unwrap();
        assert_eq!((splats.splats.len(), splats.spray), (0, 0));
    }
}

#[test]
fn settings_out_of_range_are_named() {
    let default = SurfaceKernel::default();
    assert_eq!(default.validate(), Ok(()));
    assert_eq!(BULK.validate(), Ok(()));
    let named = |kernel: SurfaceKernel, name: &str, value: &str| {
        let mut splats = FluidSplats::default();
        let result = ShapeWorkspace::default().shape(&[Vec3::ZERO], R, &kernel, &mut splats);
        let message = result.unwrap_err().to_string();
        assert!(
            message.contains(name) && message.contains(value),
            "{message}"
        );
    };
    for (value, text) in [(f32::NAN, "NaN"), (-1.0, "-1"), (1e9, "1000000000")] {
        named(
            SurfaceKernel {
                neighbor_radius: value,
                ..default
            },
            "neighbor_radius",
            text,
        );
        named(
            SurfaceKernel {
                center_shift: value,
                ..default
            },
            "center_shift",
            text,
        );
        named(
            SurfaceKernel {
                surface_offset: value,
                ..default
            },
            "surface_offset",
            text,
        );
        named(
            SurfaceKernel {
                max_ratio: value,
                ..default
            },
            "max_ratio",
            text,
        );
        named(
            SurfaceKernel {
                radius_scale: value,
                ..default
            },
            "radius_scale",
            text,
        );
    }
    named(
        SurfaceKernel {
            sphere_neighbors: 17,
            full_neighbors: 16,
            ..default
        },
        "sphere_neighbors",
        "17",
    );
}

#[test]
fn h04_no_particles_are_no_splats() {
    let splats = shape(&[]);
    assert_eq!(splats.splats, []);
    assert!(splats.min.cmpgt(splats.max).all() && splats.min.is_finite());
}

#[test]
fn h05_h06_one_and_two_particles_are_spray_spheres() {
    let positions = [Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.03, 3.0)];
    for positions in [&positions[..1], &positions[..]] {
        let splats = shape(positions);
        assert_eq!(splats.spray as usize, positions.len());
        for splat in &splats.splats {
            assert_eq!(
                *splat,
                Splat::sphere(positions[splat.particle as usize], R, splat.particle)
            );
        }
    }
}

#[test]
fn h07_four_coplanar_particles_do_not_pop() {
    let flat = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y].map(|p| p * SPACING);
    let mut bent = flat;
    bent[3].z = 1e-4 * R;
    for kernel in [SurfaceKernel::default(), BULK] {
        let [flat, bent] = [flat, bent].map(|p| shape_with(&p, R, &kernel));
        for particle in 0..4 {
            let [(a, _), (b, _)] = [&flat, &bent].map(|splats| find(splats, particle));
            assert!(Vec3::from(a.center).distance(Vec3::from(b.center)) < 1e-3 * R);
            assert!(
                (a.matrix() - b.matrix())
                    .to_cols_array()
                    .iter()
                    .all(|d| d.abs() < 5e-3 * R)
            );
        }
    }
}

#[test]
fn h08_coincident_particles_are_spheres() {
    let at = Vec3::new(0.3, -0.2, 0.9);
    for count in [3, 40, 5000] {
        for kernel in [SurfaceKernel::default(), BULK] {
            for splat in &shape_with(&vec![at; count], R, &kernel).splats {
                assert_sphere(splat, at, R);
            }
        }
    }
}

#[test]
fn h09_collinear_particles_are_spindles() {
    let along = Vec3::new(2.0, -1.0, 0.5).normalize();
    let positions: Vec<_> = (0..41).map(|i| along * (i as f32 * 0.4 * R)).collect();
    let splats = shape_with(&positions, R, &BULK);
    let (middle, _) = find(&splats, 20);
    let [long, a, b] = semi_axes(&middle);
    assert!((long / a - 4.0).abs() < 0.02 && (a / b - 1.0).abs() < F16);
    assert!((middle.matrix() * along).distance(along * long) < 1e-2 * long);
}

#[test]
fn h10_a_sheet_is_tiled_by_discs() {
    let tilt = Quat::from_euler(EulerRot::XYZ, 0.3, 0.7, -0.4);
    let sheet = (0..900).map(|i| Vec3::new((i % 30) as f32, (i / 30) as f32, 0.0) * SPACING * 0.7);
    let positions: Vec<_> = sheet.map(|p| tilt * p).collect();
    let splats = shape(&positions);
    assert_eq!(splats.interior, 0);
    let (middle, class) = find(&splats, 15 * 30 + 15);
    let [a, b, short] = semi_axes(&middle);
    assert_eq!(class, 0);
    // As thick as its particles, and not flatter than the kernel allows.
    assert!((a / b - 1.0).abs() < 2.0 * F16 && a / short <= 4.02);
    assert!((short / R - 1.0).abs() < 2.0 * F16, "{short}");
    // As wide as the volume of (2r)³ makes a disc of the kernel's ratio.
    assert!((a / R - 1.24 * 4.0_f32.cbrt()).abs() < 0.02, "{a}");
    let normal = tilt * Vec3::Z;
    assert!((middle.matrix() * normal).distance(normal * short) < 1e-2 * short);
}

#[test]
fn h11_isotropic_neighborhoods_are_spheres() {
    let positions = lattice(7, SPACING, 0.0);
    let center = positions.len() / 2;
    let splats = shape_with(&positions, R, &BULK);
    assert_sphere(&find(&splats, center).0, positions[center], 1.24 * R);
}

#[test]
fn h12_far_from_the_origin_only_the_positions_round() {
    // Multiples of 1/16 m, which f32 still resolves 1e6 m away.
    let near: Vec<_> = lattice(8, 2.0, 0.3)
        .iter()
        .map(|p| (p * 16.0).round() / 16.0)
        .collect();
    let offset = Vec3::new(1e6, -1e6, 0.5e6);
    let far: Vec<_> = near.iter().map(|p| p + offset).collect();
    let [near, far] = [near, far].map(|p| shape_with(&p, 1.0, &SurfaceKernel::default()));
    assert_eq!([near.bulk, near.interior], [far.bulk, far.interior]);
    for (splat, other) in pairs(&near, &far, |particle| particle) {
        assert!(
            (splat.matrix() - other.matrix())
                .to_cols_array()
                .iter()
                .all(|d| d.abs() < 2e-3)
        );
        let moved = Vec3::from(other.center) - offset;
        assert!(moved.distance(Vec3::from(splat.center)) < 0.1);
    }
}

#[test]
fn h13_h14_a_scaled_scene_has_scaled_splats() {
    let positions = lattice(9, SPACING, 0.3);
    let original = shape(&positions);
    for scale in [1e-4, 1e4, 2.0_f32.powi(-13), 2.0_f32.powi(13)] {
        let scaled: Vec<_> = positions.iter().map(|p| p * scale).collect();
        let scaled = shape_with(&scaled, R * scale, &SurfaceKernel::default());
        assert_eq!([scaled.bulk, scaled.spray], [original.bulk, original.spray]);
        for (splat, other) in pairs(&scaled, &original, |particle| particle) {
            assert!((splat.scale / scale - other.scale).abs() < 1e-5 * R);
            let error = splat.matrix() * scale.recip() - other.matrix();
            assert!(error.to_cols_array().iter().all(|d| d.abs() < F16 * R));
            let center = Vec3::from(splat.center) / scale;
            assert!(center.distance(Vec3::from(other.center)) < 1e-4 * R);
        }
    }
}

#[test]
fn h35_a_crowded_cell_is_bounded() {
    let mut random = Random(2);
    let mut positions: Vec<_> = (0..100_000).map(|_| random.point() * R).collect();
    positions.extend(vec![Vec3::splat(0.5 * R); 1000]);
    let splats = shape(&positions);
    assert_eq!(splats.bulk, 101_000);
}

#[test]
fn h36_clusters_far_apart_do_not_see_each_other() {
    let cluster = lattice(8, SPACING, 0.2);
    let alone = shape(&cluster);
    let near_and_far = cluster.iter().flat_map(|&p| [p, p + Vec3::X * 1e5]);
    let both = shape(&near_and_far.collect::<Vec<_>>());
    for (splat, other) in pairs(&alone, &both, |particle| 2 * particle) {
        assert_eq!(splat.center, other.center);
        assert_eq!(splat.axes, other.axes);
    }
}

#[test]
fn h38_permuted_particles_make_the_same_splats() {
    let positions = lattice(10, SPACING, 0.35);
    let mut order: Vec<usize> = (0..positions.len()).collect();
    let mut random = Random(9);
    order.sort_by_cached_key(|_| (random.next() * 1e6) as u32);
    let permuted: Vec<_> = order.iter().map(|&particle| positions[particle]).collect();
    let [original, permuted] = [&positions, &permuted].map(|p| shape(p));
    assert_eq!(original.interior, permuted.interior);
    for (splat, other) in pairs(&permuted, &original, |particle| order[particle]) {
        assert!(Vec3::from(splat.center).distance(Vec3::from(other.center)) < 1e-5 * R);
        let error = splat.matrix() - other.matrix();
        assert!(error.to_cols_array().iter().all(|d| d.abs() < F16 * R));
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let positions = [lattice(20, SPACING, 0.4), vec![Vec3::ZERO; 3000]].concat();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| shape(&positions))
    };
    let [one, three] = [1, 3].map(on);
    assert_eq!(one.splats, three.splats);
    assert_eq!(
        (one.min, one.max, one.bulk),
        (three.min, three.max, three.bulk)
    );
}

/// Clusters, droplets and broken values.
fn clouds() -> impl Strategy<Value = Vec<Vec3>> {
    let coordinate = || -0.3_f32..0.3;
    let point = (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from);
    let cluster = (point.clone(), 1_usize..60, 0.0_f32..0.1, any::<u64>());
    let cluster = cluster.prop_map(|(center, count, size, seed)| {
        let mut random = Random(seed | 1);
        (0..count)
            .map(|_| center + random.point() * size)
            .collect::<Vec<_>>()
    });
    let broken = prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(-1e29), Just(1e5)];
    let broken = broken.prop_map(|value| vec![Vec3::new(0.1, value, 0.0)]);
    let droplet = point.prop_map(|point| vec![point; 2]);
    let parts = prop_oneof![4 => cluster, 2 => droplet, 1 => broken];
    prop::collection::vec(parts, 0..8).prop_map(|parts| parts.concat())
}

proptest! {
    #[test]
    fn any_cloud_has_one_finite_splat_per_finite_particle(
        positions in clouds(),
        neighbor_radius in 1.0_f32..10.0,
        spray_threshold in 0_u32..20,
        max_ratio in 1.0_f32..16.0,
    ) {
        let kernel = SurfaceKernel { neighbor_radius, spray_threshold, max_ratio, ..SurfaceKernel::default() };
        let splats = shape_with(&positions, R, &kernel);
        let again = shape_with(&positions, R, &kernel);
        prop_assert_eq!(&splats.splats, &again.splats);
        let reach = neighbor_radius * R;
        for particle in (0..positions.len()).filter(|&of| positions[of].is_finite()) {
            let count = oracle::crowd(&positions, particle, reach);
            let weight = oracle::bulk_weight(count, spray_threshold);
            let (_, class) = find(&splats, particle);
            prop_assert!((class == 2) == (weight < 0.5) || (weight - 0.5).abs() < 1e-4);
        }
    }
}
