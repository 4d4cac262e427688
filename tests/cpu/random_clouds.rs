//! Random particles through the shape stage, held against the naive oracle in f64.

use bevy::math::Vec3;
use bevy_fluid::shape::{FluidSplats, ShapeWorkspace, Splat, SurfaceKernel};
use proptest::prelude::*;

use crate::oracle::{self, Random};

/// Of a cloud of scale 1.
const RADIUS: f32 = 0.025;

/// What the cloud is made of: lumps, lines, sheets, twins, droplets and what is no place.
fn parts() -> impl Strategy<Value = Vec<Vec3>> {
    let coordinate = || -0.3_f32..0.3;
    let point = || (coordinate(), coordinate(), coordinate()).prop_map(Vec3::from);
    let spread = (
        1_usize..80,
        any::<u64>(),
        point(),
        point(),
        point(),
        0..3_u8,
    );
    let spread = spread.prop_map(|(count, seed, at, along, across, dimensions)| {
        let mut random = Random(seed | 1);
        let mut place = || {
            let [a, b, c] = [(); 3].map(|()| random.next() - 0.5);
            match dimensions {
                0 => at + a * along,
                1 => at + a * along + b * across,
                _ => at + 0.3 * Vec3::new(a, b, c),
            }
        };
        (0..count).map(|_| place()).collect::<Vec<_>>()
    });
    let twins = (point(), 2_usize..30).prop_map(|(at, count)| vec![at; count]);
    let grid = (1_usize..5, point()).prop_map(|(size, at)| {
        let grid = oracle::lattice(size, 2.0 * RADIUS, 0.0);
        grid.iter().map(|p| at + p).collect()
    });
    let nowhere = prop_oneof![
        Just(Vec3::NAN),
        Just(Vec3::new(0.1, f32::NAN, 0.0)),
        Just(Vec3::INFINITY),
        Just(Vec3::new(0.0, 0.0, f32::NEG_INFINITY)),
        Just(Vec3::MAX),
    ];
    let far = prop_oneof![Just(1e4_f32), Just(-1e5), Just(1e12)];
    let far = far.prop_map(|far| vec![Vec3::new(far, 0.1, -far)]);
    let part = prop_oneof![
        5 => spread,
        1 => twins,
        2 => grid,
        1 => nowhere.prop_map(|nowhere| vec![nowhere]),
        1 => far,
    ];
    prop::collection::vec(part, 0..7).prop_map(|parts| parts.concat())
}

fn kernels() -> impl Strategy<Value = SurfaceKernel> {
    (
        (1.0_f32..8.0, 0_u32..14, 0.0_f32..1.0, 0.0_f32..2.0),
        (
            1.0_f32..16.0,
            0.5_f32..2.0,
            0_u32..10,
            0_u32..20,
            any::<bool>(),
        ),
    )
        .prop_map(
            |((neighbor_radius, spray_threshold, center_shift, surface_offset), rest)| {
                let (max_ratio, radius_scale, sphere_neighbors, more, skip_interior) = rest;
                SurfaceKernel {
                    neighbor_radius,
                    spray_threshold,
                    anisotropic: true,
                    center_shift,
                    surface_offset,
                    max_ratio,
                    radius_scale,
                    sphere_neighbors,
                    full_neighbors: sphere_neighbors + more,
                    skip_interior,
                }
            },
        )
}

fn shape(positions: &[Vec3], radius: f32, kernel: &SurfaceKernel) -> FluidSplats {
    let mut splats = FluidSplats::default();
    let result = ShapeWorkspace::default().shape(positions, radius, kernel, &mut splats);
    result.unwrap();
    splats
}

fn smoothstep(start: f64, width: f64, value: f64) -> f64 {
    let t = ((value - start) / width).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Centre and semi-axes (m, longest first) of a particle of the bulk, as `SurfaceKernel` has them.
fn exact(
    positions: &[Vec3],
    of: usize,
    radius: f32,
    kernel: &SurfaceKernel,
) -> ([f64; 3], [f64; 3]) {
    let reach = kernel.neighbor_radius * radius;
    let count = oracle::crowd(positions, of, reach);
    let (mean, covariance) = oracle::moments(positions, of, reach);
    let values = oracle::eigenvalues(covariance);
    let width = (kernel.full_neighbors - kernel.sphere_neighbors).max(1);
    let blend = smoothstep(f64::from(kernel.sphere_neighbors), f64::from(width), count)
        * smoothstep(1e-4, 9e-4, values.iter().sum());

    let distance = mean.iter().map(|axis| axis * axis).sum::<f64>().sqrt();
    let flatness = oracle::flatness(covariance);
    let offset = f64::from(kernel.surface_offset * radius) * (1.0 - 0.43 * flatness);
    let outwards = offset * smoothstep(0.05, 0.1, distance);
    let inwards = f64::from(kernel.center_shift) * f64::from(reach);
    let shift = blend * (inwards - outwards / distance.max(1e-6));
    let position = positions[of].as_dvec3().to_array();
    let center = [0, 1, 2].map(|axis| position[axis] + mean[axis] * shift);

    let least = 1.0 / f64::from(kernel.max_ratio);
    let axes = values.map(|value| {
        let clamped = (value / values[0].max(f64::MIN_POSITIVE)).max(least);
        1.0 - blend + blend * clamped
    });
    let volume_radius = f64::from(radius) * (1.0 + blend * (f64::from(kernel.radius_scale) - 1.0));
    let long = volume_radius / axes.iter().product::<f64>().cbrt();
    // A sheet is as thick as its particles.
    let least = flatness * f64::from(radius).min(long);
    (center, axes.map(|axis| (axis * long).max(least)))
}

fn semi_axes(splat: &Splat) -> [f64; 3] {
    let axes = splat.axes.map(|entry| f64::from(entry.to_f32()));
    oracle::eigenvalues(axes).map(|value| value * f64::from(splat.scale))
}

fn distance(a: [f32; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (f64::from(*a) - b).powi(2));
    squares.sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, ..ProptestConfig::default() })]

    #[test]
    fn splats_equal_the_naive_oracle(cloud in parts(), kernel in kernels(), exponent in -6_i32..=6) {
        let scale = 10.0_f32.powi(exponent);
        let radius = RADIUS * scale;
        let positions: Vec<_> = cloud.iter().map(|&p| p * scale).collect();
        let splats = shape(&positions, radius, &kernel);

        let usable = |p: &Vec3| p.is_finite() && p.abs().max_element() <= 1e30;
        let kept = positions.iter().filter(|p| usable(p)).count();
        prop_assert_eq!(splats.dropped as usize, positions.len() - kept);
        let partial = splats.partial_bulk + splats.partial_spray;
        prop_assert_eq!(splats.splats.len(), kept + partial as usize);
        let reach = kernel.neighbor_radius * radius;
        let mut pieces = vec![0.0; positions.len()];
        let interior: Vec<_> = splats.by_class()[1].iter().map(|it| it.particle).collect();
        for (class, splats) in splats.by_class().into_iter().enumerate() {
            for splat in splats {
                let of = splat.particle as usize;
                prop_assert!(usable(&positions[of]));
                prop_assert!(Vec3::from(splat.center).is_finite());
                prop_assert!(splat.scale.is_finite() && splat.scale > 0.0);
                let count = oracle::crowd(&positions, of, reach);
                let weight = oracle::bulk_weight(count, kernel.spray_threshold);
                let of_class = if class == 2 { 1.0 - weight } else { weight };
                let part = (2.0 * of_class).min(1.0);
                let [long, middle, short] = semi_axes(splat);
                pieces[of] += part;
                // f16 rounds the axes, by up to 1/2048 of the longest.
                let rounding = long / 1000.0;
                let most = f64::from(kernel.max_ratio);
                prop_assert!(short > 0.0 && long <= most * (short + rounding));
                if class != 0 {
                    prop_assert_eq!(splat.center, positions[of].to_array());
                    prop_assert!(long - short <= rounding);
                    let off = (long / f64::from(radius) - part).abs();
                    prop_assert!(class == 1 || off < 1e-3, "a part of {part} is off by {off}");
                    continue;
                }
                let (center, axes) = exact(&positions, of, radius, &kernel);
                let size = positions[of].abs().max_element();
                let off = distance(splat.center, center);
                // The blend of a barely spread neighbourhood rises by 1.5 over 9e-4 of R², and the
                // covariance is within 2e-6 of that; so 0.4 % of the shift, and of the axes.
                let shift = distance(positions[of].to_array(), center);
                let allowed = 1e-4 * f64::from(reach) + 5e-3 * shift + 2e-7 * f64::from(size);
                prop_assert!(off <= allowed, "centre off by {off}, allowed {allowed}");
                for (got, wanted) in [long, middle, short].into_iter().zip(axes) {
                    let off = (got - part * wanted).abs();
                    prop_assert!(off <= 8e-3 * axes[0], "axis {got}, not {part} of {wanted}");
                }
                let scale = f64::from(kernel.radius_scale);
                let volume = (long * middle * short).cbrt() / f64::from(radius);
                let bounds = scale.min(1.0) * 0.995..=scale.max(1.0) * 1.005;
                // Discs of sheets overlap, and keep their thickness all the same.
                let is_sheet = oracle::flatness(oracle::moments(&positions, of, reach).1) > 0.0;
                let volume = volume / part.max(1e-9);
                let is_whole = part > 1e-2;
                let fits = bounds.contains(&volume) || is_sheet && volume >= *bounds.start();
                prop_assert!(!is_whole || fits, "volume radius {volume} r");
            }
        }
        for (of, position) in positions.iter().enumerate().filter(|(_, p)| usable(p)) {
            let weight = oracle::bulk_weight(oracle::crowd(&positions, of, reach), kernel.spray_threshold);
            let wanted = (2.0 * weight).min(1.0) + (2.0 - 2.0 * weight).min(1.0);
            let is_inside = interior.contains(&(of as u32));
            prop_assert!(is_inside || (pieces[of] - wanted).abs() < 2e-3, "{position}: {wanted}");
        }
    }

    #[test]
    fn the_order_of_the_particles_changes_nothing(
        (cloud, order) in parts().prop_flat_map(|cloud| {
            let order: Vec<_> = (0..cloud.len()).collect();
            (Just(cloud), Just(order).prop_shuffle())
        }),
        kernel in kernels(),
    ) {
        let permuted: Vec<_> = order.iter().map(|&particle| cloud[particle]).collect();
        let [original, permuted] = [&cloud, &permuted].map(|p| shape(p, RADIUS, &kernel));
        prop_assert_eq!(original.dropped, permuted.dropped);
        let mut by_particle = vec![[None; 3]; cloud.len()];
        for (class, splats) in original.by_class().into_iter().enumerate() {
            for splat in splats {
                by_particle[splat.particle as usize][class] = Some(splat);
            }
        }
        for (class, splats) in permuted.by_class().into_iter().enumerate() {
            for splat in splats {
                let others = by_particle[order[splat.particle as usize]];
                let Some(other) = others[class] else {
                    // Whether a neighbourhood is full may hang on a rounding, and whether a splat
                    // vanishes.
                    let is_inside = class < 2 && (others[0].is_some() || others[1].is_some());
                    prop_assert!(is_inside || splat.scale < 2e-3 * RADIUS);
                    continue;
                };
                let size = Vec3::from(splat.center).abs().max_element();
                let off = Vec3::from(splat.center).distance(Vec3::from(other.center));
                prop_assert!(off <= 5e-3 * RADIUS + 2e-7 * size);
                let error = splat.matrix() - other.matrix();
                let most = 8e-3 * splat.scale;
                prop_assert!(error.to_cols_array().iter().all(|d| d.abs() <= most));
            }
        }
    }
}
