//! Tests below the public interface: neighbours, moments, eigenvalues, memory.

use bevy::math::Vec3;
use wide::f32x8;

use super::{
    FluidSplats, ShapeWorkspace, SurfaceKernel,
    candidates::{self, MAX_CANDIDATES},
    classify::{bulk_weight, scales},
    eigen::eigen,
    grid::Grid,
    neighborhood::Neighborhood,
    oracle::{self, Random, lattice},
};

fn measure(positions: &[Vec3], reach: f32) -> (Grid, Vec<Neighborhood>) {
    let mut grid = Grid::default();
    let mut out = Vec::new();
    grid.build(positions, reach);
    candidates::measure(&grid, reach, &mut out);
    (grid, out)
}

/// Compares every particle with the oracle: counts exactly, moments within f32's rounding.
fn check(positions: &[Vec3], reach: f32) {
    let (grid, neighborhoods) = measure(positions, reach);
    assert_eq!(grid.len(), positions.len());
    let mut seen = vec![false; positions.len()];
    for (&particle, neighborhood) in grid.order.iter().zip(&neighborhoods) {
        let particle = particle as usize;
        assert!(!std::mem::replace(&mut seen[particle], true));
        let count = oracle::count(positions, particle, reach);
        let error = (f64::from(neighborhood.count) - count).abs();
        assert!(error < 1e-5 * (1.0 + count), "particle {particle}: {error}");
        // Flatness divides differences of the covariance, which f32 rounds.
        let error =
            (f64::from(neighborhood.crowd()) - oracle::crowd(positions, particle, reach)).abs();
        assert!(error < 2e-2, "particle {particle}: {error}");
        let (mean, covariance) = oracle::moments(positions, particle, reach);
        for (value, exact) in neighborhood.mean.into_iter().zip(mean) {
            assert!((f64::from(value) - exact).abs() < 2e-6, "{value} {exact}");
        }
        for (value, exact) in neighborhood.covariance.into_iter().zip(covariance) {
            assert!((f64::from(value) - exact).abs() < 2e-6, "{value} {exact}");
        }
    }
}

/// A block, sparse droplets and a dense knot.
fn cloud(scale: f32) -> Vec<Vec3> {
    let mut random = Random(7);
    let block = lattice(8, 0.05, 0.3);
    let droplets: Vec<_> = (0..300).map(|_| random.point() * 2.0).collect();
    let knot: Vec<_> = (0..200)
        .map(|_| random.point() * 0.03 + Vec3::ONE)
        .collect();
    [block, droplets, knot]
        .concat()
        .iter()
        .map(|&p| p * scale)
        .collect()
}

#[test]
fn neighborhoods_equal_the_oracle() {
    check(&cloud(1.0), 0.1);
    check(&lattice(9, 0.05, 0.5), 0.1);
}

#[test]
fn h13_h14_neighborhoods_do_not_depend_on_the_scale() {
    check(&cloud(1e-4), 1e-5);
    check(&cloud(1e4), 1e3);
}

#[test]
fn neighbors_count_in_part_near_the_reach() {
    for (distance, counted) in [
        (0.5, 1.0),
        (0.9, 1.0),
        (0.925, 0.75),
        (0.99, 0.1),
        (1.0, 0.0),
    ] {
        let (_, neighborhoods) = measure(&[Vec3::ZERO, Vec3::X * distance], 1.0);
        for Neighborhood { count, .. } in neighborhoods {
            assert!((count - counted).abs() < 1e-5, "{distance}: {count}");
        }
    }
}

#[test]
fn a_distance_of_exactly_the_reach_adds_nothing() {
    let positions = lattice(5, 1.0, 0.0);
    let (grid, neighborhoods) = measure(&positions, 2.0);
    let count = |at: Vec3| {
        let sorted = (0..grid.len()).find(|&sorted| grid.position(sorted) == at);
        neighborhoods[sorted.unwrap()].count
    };
    // 6 + 12 + 8 inside; the outer shell is cut off elsewhere.
    assert_eq!(count(Vec3::splat(2.0)), 26.0);
    assert_eq!(count(Vec3::new(2.0, 2.0, 0.0)), 17.0);
    assert_eq!(count(Vec3::new(2.0, 0.0, 0.0)), 11.0);
    assert_eq!(count(Vec3::ZERO), 7.0);
    check(&positions, 2.0);
}

#[test]
fn h37_particles_on_cell_boundaries_count_once() {
    // Cells are wider than the reach by 1e-5: on, just below and just above their sides.
    for side in [1.0, 1.0 + 1e-5, 1.0 - 6e-8] {
        let mut positions = lattice(6, side, 0.0);
        positions.extend(lattice(6, side, 0.0).iter().map(|&p| p * 0.5 - Vec3::ONE));
        check(&positions, 1.0);
    }
}

#[test]
fn rounding_hides_no_neighbor_two_cells_away() {
    // 0.125 + 1e-10 is 0.125 in f32, and so within reach, but spans three cells of that side.
    let mut positions = vec![Vec3::X * -1e-10, Vec3::X * 0.125];
    // Enough for a grid in which those cells are not neighbours the other way around.
    positions.extend([Vec3::NEG_X; 60]);
    check(&positions, 0.125);
    assert_eq!(oracle::neighbors(&positions, 0, 0.125), [1]);
}

#[test]
fn folded_space_wraps_around() {
    // So few cells that knots meet its ends, wherever they are.
    for seed in 1..200 {
        let mut random = Random(seed);
        let knots = (0..6).map(|_| random.point() * 1e3).collect::<Vec<_>>();
        let positions = knots.iter().flat_map(|&knot| [(); 5].map(|()| knot));
        let positions: Vec<_> = positions.map(|p| p + random.point() * 3.0).collect();
        check(&positions, 1.0);
    }
}

#[test]
fn h12_neighborhoods_far_from_the_origin() {
    let far = |p: &Vec3| *p * 16.0 + Vec3::new(1e6, -1e6, 3e6);
    check(&cloud(1.0).iter().map(far).collect::<Vec<_>>(), 1.6);
}

#[test]
fn h36_memory_follows_the_particles() {
    let mut far_apart = lattice(6, 0.05, 0.2);
    far_apart.extend(lattice(6, 0.05, 0.2).iter().map(|&p| p + Vec3::splat(1e5)));
    let positions = [far_apart, cloud(1.0)].concat();
    check(&positions, 0.1);
    let (grid, _) = measure(&positions, 0.1);
    assert!(grid.cells() <= 4 * positions.len() + 64);
}

#[test]
fn sparse_droplets_do_not_fold_onto_few_cells() {
    for spacing in [6.4, 12.8, 25.6] {
        let positions = lattice(20, spacing, 0.0);
        let (grid, neighborhoods) = measure(&positions, 0.1);
        assert!(grid.cells() <= 4 * positions.len());
        let groups = grid.groups(0..grid.len());
        let most = groups.map(|group| group.particles.len()).max();
        assert!(most.unwrap() <= 8, "{spacing}: {most:?}");
        assert!(neighborhoods.iter().all(|n| n.count == 0.0));
    }
}

#[test]
fn extreme_positions_stay_finite() {
    let mut positions = lattice(4, 0.05, 0.2);
    for extreme in [1e30, -1e30, 9e29, 1e18, -1e-38, f32::MIN_POSITIVE] {
        positions.push(Vec3::splat(extreme));
        positions.push(Vec3::new(extreme, -extreme, 0.0));
    }
    check(&positions, 0.1);
}

#[test]
fn h35_a_crowded_cell_is_sampled() {
    let mut random = Random(3);
    let mut positions: Vec<_> = (0..20_000).map(|_| random.point() * 0.1).collect();
    positions.push(Vec3::new(0.0, 0.0, -0.099));
    let (grid, neighborhoods) = measure(&positions, 0.2);
    assert!(grid.len() > MAX_CANDIDATES);
    for (&particle, neighborhood) in grid.order.iter().zip(&neighborhoods) {
        let all_in_reach = particle < 20_000;
        if all_in_reach {
            // All of them, up to what the sample's stride cannot resolve.
            assert!((neighborhood.count - 20_000.0).abs() < 400.0);
            assert!(neighborhood.trace() > 0.0 && neighborhood.trace() < 0.5);
        }
    }
}

#[test]
fn the_weight_of_the_bulk_equals_the_oracle() {
    for threshold in [0, 1, 2, 3, 7, 30, u32::MAX] {
        for step in 0..400 {
            let count = step as f32 * 0.1;
            let weight = f64::from(bulk_weight(count, threshold));
            let exact = oracle::bulk_weight(f64::from(count), threshold);
            assert!((weight - exact).abs() < 1e-5, "{count} of {threshold}");
            let [bulk, spray] = scales(weight as f32);
            assert!(bulk.max(spray) == 1.0 && bulk.min(spray) >= 0.0);
        }
    }
}

/// Largest relative errors of eigenvalues and of A·v = λ·v and |v| = 1, for each lane.
fn check_eigen(matrices: &[[f32; 6]]) {
    for batch in matrices.chunks(8) {
        let lane = |lane: usize| batch[lane.min(batch.len() - 1)];
        let entries = [0, 1, 2, 3, 4, 5]
            .map(|entry| f32x8::new([0, 1, 2, 3, 4, 5, 6, 7].map(|l| lane(l)[entry])));
        let result = eigen(entries);
        let values = result.values.map(f32x8::to_array);
        let vectors = result.vectors.map(|vector| vector.map(f32x8::to_array));
        for (lane, matrix) in batch.iter().enumerate() {
            let a = matrix.map(f64::from);
            let exact = oracle::eigenvalues(a);
            let size = exact[0]
                .abs()
                .max(exact[2].abs())
                .max(f64::from(f32::MIN_POSITIVE));
            let mut found = values.map(|value| f64::from(value[lane]));
            for k in 0..3 {
                let v = vectors[k].map(|axis| f64::from(axis[lane]));
                let rows = [[a[0], a[1], a[2]], [a[1], a[3], a[4]], [a[2], a[4], a[5]]];
                for (row, component) in rows.iter().zip(v) {
                    let product: f64 = row.iter().zip(v).map(|(a, v)| a * v).sum();
                    let error = (product - found[k] * component).abs() / size;
                    assert!(error < 2e-6, "{matrix:?}: A v - λ v = {error}");
                }
                let length: f64 = v.iter().map(|v| v * v).sum();
                assert!((length - 1.0).abs() < 4e-6, "{matrix:?}: |v|² = {length}");
            }
            found.sort_by(|left, right| right.total_cmp(left));
            for (found, exact) in found.into_iter().zip(exact) {
                let error = (found - exact).abs() / size;
                assert!(error < 2e-6, "{matrix:?}: {found} for {exact}");
            }
        }
    }
}

fn outer(v: Vec3, factor: f32) -> [f32; 6] {
    [
        v.x * v.x,
        v.x * v.y,
        v.x * v.z,
        v.y * v.y,
        v.y * v.z,
        v.z * v.z,
    ]
    .map(|a| a * factor)
}

/// Random symmetric matrices with the given eigenvalues.
fn with_eigenvalues(values: [f32; 3], count: usize) -> Vec<[f32; 6]> {
    let mut random = Random(11);
    let mut matrices = Vec::new();
    for _ in 0..count {
        let x = (random.point() - Vec3::splat(0.5)).normalize();
        let y = x.any_orthonormal_vector();
        let terms = [x, y, x.cross(y)].map(|v| v);
        let terms = [0, 1, 2].map(|k| outer(terms[k], values[k]));
        matrices.push([0, 1, 2, 3, 4, 5].map(|e| terms[0][e] + terms[1][e] + terms[2][e]));
    }
    matrices
}

#[test]
fn eigen_of_random_matrices() {
    let mut random = Random(5);
    let matrices: Vec<[f32; 6]> = (0..20_000)
        .map(|_| [(); 6].map(|()| random.next() * 2.0 - 1.0))
        .collect();
    check_eigen(&matrices);
}

#[test]
fn eigen_of_special_matrices() {
    let spectra = [
        [1.0, 1.0, 0.2],
        [1.0, 0.2, 0.2],
        [1.0, 1.0 - 1e-6, 0.3],
        [1.0, 1.0 + 3e-4, 1.0 - 3e-4],
        [0.15, 0.15, 0.15],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 1e-4, 1e-8],
        [1.0, -1.0, 0.0],
    ];
    for spectrum in spectra {
        check_eigen(&with_eigenvalues(spectrum, 1000));
    }
    check_eigen(&[
        [0.0; 6],
        [1.0, 0.0, 0.0, 1.0, 0.0, 1.0],
        [0.0, 1.0, 0.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 1.0, 0.0, 1.0, 0.0],
        [1.0; 6],
        [1.0, 1e-13, 0.0, 1.0, 1e-20, 1.0],
        [1.0, 1e-30, 1e-38, 1e-20, 1e-25, 1e-38],
    ]);
}

#[test]
fn eigen_at_extreme_scales() {
    for scale in [1e-37, 1e-30, 2e-5, 1e10, 1e30, 1e37] {
        let mut matrices = with_eigenvalues([1.0, 0.5, 0.01], 100);
        matrices.extend(with_eigenvalues([1.0, 1.0, 0.0], 100));
        for matrix in &mut matrices {
            *matrix = matrix.map(|entry| entry * scale);
        }
        check_eigen(&matrices);
    }
}

#[test]
fn a_steady_frame_keeps_its_buffers() {
    let mut workspace = ShapeWorkspace::default();
    let mut splats = FluidSplats::default();
    let kernel = SurfaceKernel::default();
    let frame = cloud(1.0);
    workspace
        .shape(&frame, 0.025, &kernel, &mut splats)
        .unwrap();
    let buffers = |workspace: &ShapeWorkspace, splats: &FluidSplats| {
        let mut buffers = workspace.grid.buffers();
        buffers.extend(workspace.classes.buffers());
        let neighborhoods = &workspace.neighborhoods;
        buffers.push((neighborhoods.as_ptr().addr(), neighborhoods.capacity()));
        buffers.push((splats.splats.as_ptr().addr(), splats.splats.capacity()));
        buffers
    };
    let before = buffers(&workspace, &splats);
    let mut most = 0;
    for (count, spray_threshold) in [(frame.len(), 20), (10, 7), (0, 7), (frame.len(), 27)] {
        // Many have two splats.
        let kernel = SurfaceKernel {
            spray_threshold,
            ..kernel
        };
        workspace
            .shape(&frame[..count], 0.025, &kernel, &mut splats)
            .unwrap();
        assert_eq!(buffers(&workspace, &splats), before);
        most = most.max(splats.splats.len());
    }
    assert!(most > frame.len() + 50, "{most} splats");
}
