//! Simulates the two scenes of the thesis and keeps one frame of each for the measurements:
//! "wave" (about 100,000 particles) and "step" (about 50,000), in the thesis's sizes.
//!
//! ```text
//! cargo run --release --features simulation --example bake -- wave --out assets/wave.xyz
//! ```
//! Takes a quarter of an hour on two cores. Draw the result with the viewer, `--radius 0.025`.

mod simulation;

use std::{fs, path::PathBuf, process::ExitCode};

use bevy::prelude::*;
use clap::{Parser, ValueEnum};
use fluid_stage::{dam, lattice, parse_args};

use simulation::Simulation;

/// Particle radius, m.
const RADIUS: f32 = 0.025;

#[derive(Parser)]
struct Args {
    /// Which scene
    scene: Scene,
    /// Frames of 1/60 s to simulate
    #[arg(long, default_value = "75")]
    frames: u32,
    /// Where to write the last frame: little-endian f32 triples
    #[arg(long)]
    out: PathBuf,
}

#[derive(ValueEnum, Clone, Copy)]
enum Scene {
    /// A dam breaks in a long tank and rolls up the far wall
    Wave,
    /// A dam breaks over a step in the floor
    Step,
}

impl Scene {
    fn start(self) -> Simulation {
        match self {
            Self::Wave => {
                let tank = vec3(6.0, 3.0, 1.6);
                let water = dam(tank, vec2(3.2, 2.45), RADIUS);
                Simulation::new(tank, RADIUS, water, Vec::new())
            }
            Self::Step => {
                let tank = vec3(5.0, 2.5, 1.2);
                let water = dam(tank, vec2(2.6, 2.0), RADIUS);
                let low = vec3(0.8, RADIUS, -0.6);
                let high = vec3(2.5, 0.5, 0.6) - RADIUS;
                // Two layers of its top and of the side that the water runs against.
                let spacing = 2.0 * RADIUS;
                let top = lattice(low.with_y(high.y - spacing), high, spacing);
                let side = lattice(low, high.with_x(low.x + spacing), spacing);
                Simulation::new(tank, RADIUS, water, [top, side].concat())
            }
        }
    }
}

fn main() -> ExitCode {
    let args: Args = parse_args();
    let mut simulation = args.scene.start();
    println!("{} particles", simulation.positions().len());
    for frame in 1..=args.frames {
        simulation.step(1.0 / 60.0);
        if frame % 10 == 0 {
            println!("frame {frame} of {}", args.frames);
        }
    }
    let bytes: Vec<u8> = simulation
        .positions()
        .into_iter()
        .flat_map(<[f32; 3]>::from)
        .flat_map(f32::to_le_bytes)
        .collect();
    match fs::write(&args.out, bytes) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("cannot write {}: {error}", args.out.display());
            ExitCode::from(2)
        }
    }
}
