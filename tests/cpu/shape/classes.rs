//! Bulk, interior and spray.

use bevy::math::{EulerRot, Quat, Vec3};
use bevy_fluid::shape::SurfaceKernel;

use super::{BULK, R, SPACING, assert_sphere, find, lattice, shape, shape_with};

#[test]
fn the_spray_threshold_counts_neighbors() {
    let size = 7;
    let positions = lattice(size, 1.0, 0.0);
    let index = |x: usize, y: usize, z: usize| x + size * (y + size * z);
    // Two radii apart: neighbours are 1, √2, √3 and exactly 2 spacings away.
    let known = [
        (index(0, 0, 0), 10),
        (index(3, 0, 0), 15),
        (index(3, 3, 0), 22),
        (index(3, 3, 1), 31),
        (index(3, 3, 3), 32),
    ];
    for (particle, neighbors) in known {
        for (spray_threshold, class) in [(neighbors, 0), (neighbors + 1, 2)] {
            let kernel = SurfaceKernel {
                spray_threshold,
                skip_interior: false,
                ..BULK
            };
            let splats = shape_with(&positions, 0.5, &kernel);
            assert_eq!(find(&splats, particle).1, class, "{particle}");
        }
    }
}

#[test]
fn a_particle_at_the_spray_threshold_is_the_sphere_of_its_radius() {
    // Eight neighbours on one side only.
    let corners = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32));
    let mut positions: Vec<_> = corners
        .map(|p| (p + Vec3::new(0.6, 0.0, 0.0)) * R)
        .collect();
    positions.push(Vec3::ZERO);
    let (bulk, class) = find(&shape(&positions), 8);
    assert_eq!(class, 0);
    assert_sphere(&bulk, Vec3::ZERO, R);
    let (spray, class) = find(&shape(&positions[1..]), 7);
    assert_eq!(class, 2);
    assert_sphere(&spray, Vec3::ZERO, R);
}

#[test]
fn a_shell_of_two_spacings_is_left_around_the_interior() {
    let size = 16;
    for jitter in [0.0, 0.1, 0.2, 0.3, 0.35] {
        let splats = shape(&lattice(size, SPACING, jitter));
        let [_, interior, _] = splats.by_class();
        for splat in interior {
            let i = splat.particle as usize;
            let cell = [i % size, i / size % size, i / size / size];
            let depth = cell.map(|k| k.min(size - 1 - k)).into_iter().min();
            assert!(depth >= Some(2), "jitter {jitter}: {cell:?}");
        }
        // The three outermost layers may all stay; little more should.
        assert!(interior.len() >= 700, "jitter {jitter}: {}", interior.len());
    }
}

#[test]
fn a_ball_keeps_its_shell_in_any_orientation() {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.5, -0.8, 0.3);
    let center = Vec3::splat(10.0 * SPACING);
    for radius in [2.5, 6.5, 9.0] {
        let ball = lattice(21, SPACING, 0.15)
            .into_iter()
            .map(|p| turn * (p - center));
        let ball: Vec<_> = ball.filter(|p| p.length() < radius * SPACING).collect();
        let splats = shape(&ball);
        for splat in splats.by_class()[1] {
            let depth = radius - Vec3::from(splat.center).length() / SPACING;
            assert!(depth > 2.0, "{depth} spacings deep in a ball of {radius}");
        }
        assert_eq!(splats.interior > 0, radius > 2.5);
    }
}

#[test]
fn thin_sheets_and_cracks_have_no_interior() {
    let size = 20;
    for jitter in [0.0, 0.1, 0.2] {
        let block = lattice(size, SPACING, jitter);
        let layer = |particle: usize| particle / size / size;
        for layers in 1..=4 {
            let sheet: Vec<_> = block[..layers * size * size].to_vec();
            assert_eq!(
                shape(&sheet).interior,
                0,
                "{layers} layers, jitter {jitter}"
            );
        }
        // A crack: layer 10 is missing.
        let kept: Vec<_> = (0..block.len())
            .filter(|&particle| layer(particle) != 10)
            .collect();
        let cracked: Vec<_> = kept.iter().map(|&particle| block[particle]).collect();
        let splats = shape(&cracked);
        assert!(splats.interior > 500);
        for splat in splats.by_class()[1] {
            let layer = layer(kept[splat.particle as usize]);
            assert!(layer.abs_diff(10) > 2, "layer {layer}, jitter {jitter}");
        }
    }
}
