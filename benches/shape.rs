//! Cost of the shape stage per particle, and against splashsurf's neighbour search alone.
//!
//! `cargo bench --package fluid_benches --bench shape`, or with `-- --quick` for fewer and smaller runs. The two run
//! in turn on the same particles, so that a busy machine slows both; medians are shown.

use std::time::{Duration, Instant};

use bevy::math::Vec3;
use bevy_fluid::shape::{FluidSplats, ShapeTimes, ShapeWorkspace, SurfaceKernel};
use splashsurf_lib::{
    Aabb3d, nalgebra::Vector3,
    neighborhood_search::neighborhood_search_spatial_hashing_parallel as splashsurf_search,
};

const RADIUS: f32 = 0.025;
/// Largest displacement from the lattice, in spacings.
const JITTER: f32 = 0.3;
/// Particles a size is run with in all, so that small sizes get more runs.
const PARTICLES: usize = 5_000_000;

fn main() {
    // Cargo adds `--bench`; only `--quick` means something here.
    let quick = std::env::args().any(|argument| argument == "--quick");
    let sizes: &[usize] = if quick {
        &[10_000, 100_000]
    } else {
        &[10_000, 100_000, 1_000_000]
    };
    println!(
        "ns per particle on {} threads, medians",
        rayon::current_num_threads()
    );
    println!("particles  interior     grid  classify  anisotropy    total   splashsurf  ratio");
    let totals: Vec<f64> = sizes
        .iter()
        .map(|&size| {
            run(
                size,
                (PARTICLES / size).clamp(5, 50) / if quick { 5 } else { 1 },
            )
        })
        .collect();
    let growth = totals[totals.len() - 1] / totals[0];
    println!("per particle, the largest costs {growth:.2} times as much as the smallest");
}

/// Prints a line and returns the total per particle.
fn run(size: usize, runs: usize) -> f64 {
    let positions = shuffled_block(size);
    let vectors: Vec<_> = positions
        .iter()
        .map(|p| Vector3::from(p.to_array()))
        .collect();
    let domain = Aabb3d::par_from_points(&vectors);
    let kernel = SurfaceKernel::default();
    let reach = kernel.neighbor_radius * RADIUS;

    let mut workspace = ShapeWorkspace::default();
    let mut splats = FluidSplats::default();
    let mut lists = Vec::new();
    let mut times: Vec<ShapeTimes> = Vec::new();
    let mut searches = Vec::new();
    // The first run only fills the buffers.
    for warm in (0..=runs).map(|run| run > 0) {
        let start = Instant::now();
        splashsurf_search::<i64, f32>(&domain, &vectors, reach, &mut lists);
        let search = start.elapsed();
        if let Err(error) = workspace.shape(&positions, RADIUS, &kernel, &mut splats) {
            eprintln!("{error}");
            return f64::NAN;
        }
        if warm {
            searches.push(search);
            times.push(splats.times);
        }
    }

    let median = |mut durations: Vec<Duration>| {
        durations.sort();
        durations[durations.len() / 2].as_secs_f64() * 1e9 / size as f64
    };
    let stage = |stage: fn(&ShapeTimes) -> Duration| median(times.iter().map(stage).collect());
    let total = stage(|times| times.total);
    let search = median(searches);
    println!(
        "{size:9}  {:6.1} %  {:7.1}  {:8.1}  {:10.1}  {total:7.1}  {search:11.1}  {:5.3}",
        100.0 * f64::from(splats.interior) / size as f64,
        stage(|times| times.grid),
        stage(|times| times.classify),
        stage(|times| times.anisotropy),
        total / search,
    );
    total
}

/// A cube of jittered particles, in random order.
fn shuffled_block(size: usize) -> Vec<Vec3> {
    let edge = (size as f64).cbrt().ceil() as usize;
    let mut state = 1_u64;
    let mut random = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 40) as f32 / (1_u32 << 24) as f32
    };
    let mut positions: Vec<_> = (0..size)
        .map(|i| {
            let cell = [i % edge, i / edge % edge, i / edge / edge].map(|index| index as f32);
            let jitter = Vec3::new(random(), random(), random()) * 2.0 - Vec3::ONE;
            (Vec3::from(cell) + jitter * JITTER) * (2.0 * RADIUS)
        })
        .collect();
    positions.sort_by_cached_key(|_| (random() * 1e6) as u32);
    positions
}
