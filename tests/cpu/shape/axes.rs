//! What the kernel's parameters do to centres and axes.

use super::*;

#[test]
fn the_volume_is_kept() {
    let positions = lattice(12, SPACING, 0.3);
    let splats = shape_with(&positions, R, &BULK);
    assert!(
        splats
            .splats
            .iter()
            .any(|s| semi_axes(s)[2] < 0.5 * s.scale)
    );
    for splat in &splats.splats {
        let volume = splat.matrix().determinant();
        assert!((volume / (1.24 * R).powi(3) - 1.0).abs() < 4.0 * F16);
    }
}

#[test]
fn the_center_moves_by_lambda_towards_the_mean() {
    let positions = lattice(8, SPACING, 0.3);
    for center_shift in [0.0, 0.5, 1.0] {
        let splats = shape_with(
            &positions,
            R,
            &SurfaceKernel {
                center_shift,
                surface_offset: 0.0,
                ..BULK
            },
        );
        for splat in splats.splats.iter().step_by(17) {
            let particle = splat.particle as usize;
            let (mean, _) = oracle::moments(&positions, particle, 4.0 * R);
            let shift = Vec3::from(mean.map(|axis| axis as f32)) * (4.0 * R * center_shift);
            let center = Vec3::from(splat.center);
            assert!(center.distance(positions[particle] + shift) < 1e-4 * R);
        }
    }
}

/// Along the mean, so many radii at the surface and none inside.
#[test]
fn splats_at_the_surface_move_outwards_by_the_offset() {
    let positions = lattice(8, SPACING, 0.1);
    let [sunken, moved] = [0.0, 1.15].map(|surface_offset| {
        let kernel = SurfaceKernel {
            surface_offset,
            ..BULK
        };
        shape_with(&positions, R, &kernel)
    });
    let mut counts = [0; 2];
    for (before, after) in sunken.splats.iter().zip(&moved.splats) {
        assert_eq!(before.particle, after.particle);
        let particle = after.particle as usize;
        let (mean, _) = oracle::moments(&positions, particle, 4.0 * R);
        let mean = Vec3::from(mean.map(|axis| axis as f32));
        let outwards = (Vec3::from(after.center) - Vec3::from(before.center)) / R;
        if mean.length() < 0.05 {
            assert!(outwards.length() < 1e-4, "{outwards} inside");
            counts[0] += 1;
        } else if mean.length() > 0.15 {
            let wanted = -1.15 * mean.normalize();
            assert!(outwards.distance(wanted) < 1e-3, "{outwards}, not {wanted}");
            counts[1] += 1;
        }
    }
    assert!(counts[0] > 100 && counts[1] > 200, "{counts:?}");
}

#[test]
fn the_ratio_is_limited() {
    let mut random = Random(4);
    let positions: Vec<_> = (0..3000)
        .map(|_| random.point() * Vec3::new(1.0, 0.01, 0.01))
        .collect();
    for max_ratio in [1.0, 2.0, 16.0] {
        // `check` holds every splat against it.
        let splats = shape_with(&positions, R, &SurfaceKernel { max_ratio, ..BULK });
        let ratios = splats
            .splats
            .iter()
            .map(|s| semi_axes(s)[0] / semi_axes(s)[2]);
        assert!(ratios.fold(0.0, f32::max) > 0.98 * max_ratio);
    }
}

#[test]
fn without_anisotropy_every_splat_is_the_particle() {
    let positions = lattice(12, SPACING, 0.2);
    let kernel = SurfaceKernel {
        anisotropic: false,
        ..SurfaceKernel::default()
    };
    let [spheres, ellipsoids] = [shape_with(&positions, R, &kernel), shape(&positions)];
    let classes = |s: &FluidSplats| [s.bulk, s.interior, s.spray];
    assert_eq!(classes(&spheres), classes(&ellipsoids));
    assert!(spheres.bulk > 0 && spheres.interior > 0);
    let whole = spheres.splats.len() - spheres.partial_spray as usize;
    for splat in &spheres.splats[spheres.partial_bulk as usize..whole] {
        let position = positions[splat.particle as usize];
        assert_eq!(*splat, Splat::sphere(position, R, splat.particle));
    }
}
