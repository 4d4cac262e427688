//! Bulk, interior and spray.

use bevy::math::{EulerRot, Quat, Vec3};
use bevy_fluid::shape::{FluidSplats, Splat, SurfaceKernel};

use super::{BULK, R, SPACING, assert_sphere, find, lattice, oracle, shape, shape_with};

#[test]
fn from_the_spray_threshold_on_particles_are_bulk() {
    let size = 7;
    let positions = lattice(size, 1.0, 0.0);
    let index = |x: usize, y: usize, z: usize| x + size * (y + size * z);
    // Two radii apart: neighbours are 1, √2 and √3 spacings away; two spacings are the reach.
    let known = [
        (index(0, 0, 0), 7),
        (index(3, 0, 0), 11),
        (index(3, 3, 0), 17),
        (index(3, 3, 3), 26),
    ];
    for (particle, neighbors) in known {
        // Scales of its splats: bulk and spray.
        for (more, scales) in [
            (0, [1.0, 0.0]),
            (1, [1.0, 2.0 / 3.0]),
            (2, [2.0 / 3.0, 1.0]),
            (3, [0.0, 1.0]),
        ] {
            let spray_threshold = neighbors + more;
            let kernel = SurfaceKernel {
                spray_threshold,
                skip_interior: false,
                ..BULK
            };
            let splats = shape_with(&positions, 0.5, &kernel);
            let whole = shape_with(&positions, 0.5, &BULK);
            let whole = find(&whole, particle).0.scale;
            let [bulk, _, spray] = splats.by_class();
            let found = [(bulk, whole), (spray, 0.5)].map(|(class, whole)| {
                let splat = class.iter().find(|it| it.particle as usize == particle);
                splat.map_or(0.0, |it| it.scale / whole)
            });
            let near = found.iter().zip(scales).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near, "{particle}, {spray_threshold}: {found:?}");
        }
    }
}

#[test]
fn a_particle_at_the_spray_threshold_is_the_sphere_of_its_radius() {
    // Neighbours on one side only.
    let corners = (0..8).map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32));
    let mut positions: Vec<_> = corners
        .map(|p| (p + Vec3::new(0.6, 0.0, 0.0)) * R)
        .collect();
    positions.push(Vec3::ZERO);
    for (neighbors, class) in [(7, 0), (6, 0), (5, 2), (4, 2)] {
        let positions = &positions[8 - neighbors..];
        let (whole, found) = find(&shape(positions), neighbors);
        assert_eq!(found, class, "{neighbors}");
        assert_sphere(&whole, Vec3::ZERO, R);
    }
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

#[test]
fn a_sheet_of_one_particle_holds_together_up_to_its_rim() {
    let size = 20;
    for jitter in [0.0, 0.1] {
        let sheet = &lattice(size, SPACING, jitter)[..size * size];
        let splats = shape(sheet);
        assert!(
            splats.bulk as usize >= sheet.len() - 4,
            "{} bulk",
            splats.bulk
        );
        for splat in splats.by_class()[0] {
            let along = (splat.matrix() * Vec3::Z).length();
            assert!((0.9..1.4).contains(&(along / R)), "{} r thick", along / R);
        }
    }
    let three = [Vec3::ZERO, Vec3::X * SPACING, Vec3::Y * SPACING];
    assert_eq!(shape(&three).spray, 3);
    // A thread with six neighbours, which a sheet's would be enough to be bulk.
    let thread: Vec<_> = (0..20).map(|i| Vec3::Y * (i as f32 * R)).collect();
    let kernel = SurfaceKernel {
        spray_threshold: 12,
        ..SurfaceKernel::DEFAULT
    };
    assert_eq!(shape_with(&thread, R, &kernel).spray, 20);
}

/// The drawn splats of every particle: bulk and spray. What is not drawn has no size.
fn drawn(splats: &FluidSplats, count: usize) -> Vec<[Splat; 2]> {
    let [bulk, _, spray] = splats.by_class();
    let mut drawn = vec![[Splat::sphere(Vec3::ZERO, 0.0, 0); 2]; count];
    for (class, splats) in [bulk, spray].into_iter().enumerate() {
        for splat in splats {
            drawn[splat.particle as usize][class] = *splat;
        }
    }
    drawn
}

/// The liquid never shrinks on the way: one splat of the two always has its full size.
#[test]
fn a_droplet_that_approaches_a_pool_does_not_pop() {
    // Slightly irregular, so that neighbours come in one by one.
    let pool = lattice(7, SPACING, 0.1);
    let above = Vec3::new(3.1, 3.2, 6.0) * SPACING;
    let frames = (0..=600).map(|step| {
        let height = (6.0 - 0.01 * step as f32) * R;
        let positions = [pool.clone(), vec![above + Vec3::Z * height]].concat();
        // Interior particles are seen by no one, and turn into it at once.
        let kernel = SurfaceKernel {
            skip_interior: false,
            ..SurfaceKernel::default()
        };
        let splats = drawn(&shape_with(&positions, R, &kernel), positions.len());
        (positions, splats)
    });
    let frames: Vec<_> = frames.collect();
    let droplet = pool.len();
    let weights = frames.iter().map(|(positions, _)| {
        let count = oracle::crowd(positions, droplet, 4.0 * R);
        oracle::bulk_weight(count, 7)
    });
    let weights: Vec<_> = weights.collect();
    assert!(weights[0] == 0.0 && *weights.last().unwrap() == 1.0);
    let between = weights.iter().filter(|&&w| w > 0.0 && w < 1.0).count();
    assert!(between > 20, "{between} steps");

    let mut most = [0.0_f32; 3];
    for pair in frames.windows(2) {
        for (before, after) in pair[0].1.iter().zip(&pair[1].1) {
            let largest = after.map(|splat| splat.scale);
            assert!(largest[0].max(largest[1]) > 0.95 * R, "{largest:?}");
            for (a, b) in before.iter().zip(after) {
                let grown = (a.scale - b.scale).abs() / R;
                let axes = (a.matrix() - b.matrix()).to_cols_array();
                let turned = axes.iter().fold(0.0_f32, |most, d| most.max(d.abs())) / R;
                let is_drawn = a.scale > 0.0 && b.scale > 0.0;
                let moved = Vec3::from(a.center).distance(Vec3::from(b.center)) / R;
                let moved = if is_drawn { moved } else { 0.0 };
                for (most, change) in most.iter_mut().zip([grown, turned, moved]) {
                    *most = most.max(change);
                }
            }
        }
    }
    println!("scale, axes, centre: {most:?} r");
    assert!(most.iter().all(|&change| change < 0.1), "{most:?} r");
}
