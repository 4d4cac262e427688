//! A long run in which everything changes all the time: half a minute of it with every test run, ten
//! minutes with `scripts/test --test memory -- --ignored soak`.

mod driver;
mod memory;
mod script;

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_fluid::prelude::*;
use fluid_stage::{capture, resize};

use crate::{common::*, heap};

use memory::{MEBIBYTE, Memory};
use script::{CYCLE, Play, RADIUS, SIZES, particles, start};

/// Sets a scene that is the same after any run, and shows it.
fn last_frame(app: &mut App) -> image::RgbaImage {
    resize(app, SIZES[0]).unwrap();
    look(
        app,
        (ScreenSpaceFluid::default(), Msaa::Off, Transform::IDENTITY),
    );
    let positions = particles(0, 500).collect();
    pour(
        app,
        (FluidParticles::new(positions, RADIUS), FluidMaterial::INK),
    );
    assert_sound(app);
    capture(app).unwrap()
}

/// Memory after the first tenth and at the end.
struct Grown {
    first: Memory,
    last: Memory,
    /// Cycles between the two.
    cycles: f64,
}

/// Plays for a while, at least ten cycles.
fn play(play: &mut Play, duration: Duration) -> Grown {
    let began = Instant::now();
    let mut samples = Vec::new();
    while began.elapsed() < duration || samples.len() < 8 {
        play.cycle();
        // All pipelines are made in the first cycle; the second grows into its buffers.
        if play.cycles > 2 && 10 * began.elapsed() > duration {
            samples.push(Memory::of(&play.app));
        }
    }
    // Each sample is taken in the same state; single ones still tremble with the allocators.
    let part = samples.len().div_ceil(5);
    let [first, last] = [&samples[..part], &samples[samples.len() - part..]].map(Memory::mean);
    let cycles = (samples.len() - part) as f64;
    Grown {
        first,
        last,
        cycles,
    }
}

fn soak(duration: Duration) {
    let _alone = heap::alone();
    // Bevy itself keeps some hundred bytes of a frame in which cameras come and sizes change.
    let bevy_alone = {
        let grown = play(&mut Play::new(false), duration / 5);
        (grown.last.heap - grown.first.heap) / grown.cycles
    };
    let mut ours = Play::new(true);
    let Grown {
        first,
        last,
        cycles,
    } = play(&mut ours, duration);
    let frames = ours.cycles * CYCLE;
    println!("{frames} frames; MiB after the first tenth and at the end:");
    for (whose, first, last) in first.beside(last) {
        println!("{whose}: {:.2}, {:.2}", first / MEBIBYTE, last / MEBIBYTE);
    }
    let by_bevy = bevy_alone * cycles;
    println!("grown by Bevy alone: {:.2}", by_bevy / MEBIBYTE);

    let grown = last.heap - first.heap - by_bevy;
    assert!(
        grown < 0.01 * first.heap,
        "Rust's heap: {first:?}, {last:?}"
    );
    assert!(last.gpu < 1.01 * first.gpu, "GPU: {first:?}, {last:?}");
    // The driver's memory is not ours; a shader that it compiles anew in every frame is megabytes.
    let by_frame = (last.process - first.process) / cycles / f64::from(CYCLE);
    assert!(by_frame < 16e3, "{by_frame} bytes a frame");

    assert!(
        last_frame(&mut ours.end()) == last_frame(&mut start(true)),
        "not as in a fresh app"
    );
}

#[test]
fn soak_for_half_a_minute() {
    soak(Duration::from_secs(30));
}

#[test]
#[ignore = "ten minutes"]
fn soak_for_ten_minutes() {
    soak(Duration::from_secs(600));
}
