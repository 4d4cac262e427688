//! A long run in which everything changes all the time: half a minute of it with every test run, ten
//! minutes with `cargo test --release --workspace --all-features --test soak -- --ignored soak`.

#[path = "../common/mod.rs"]
mod common;

mod driver;
mod memory;
mod script;

use std::time::{Duration, Instant};

use bevy::prelude::*;
use bevy_fluid::{FluidDebugView, ScreenSpaceFluid, prelude::*};
use common::*;
use fluid_stage::{capture, resize, step, validation_errors};

use memory::{MEBIBYTE, Memory};
use script::{CYCLE, Cast, RADIUS, SIZES, change, particles, start};

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

fn soak(duration: Duration) {
    let began = Instant::now();
    let mut app = start(SIZES[0]);
    let first_camera = only::<Camera3d>(&mut app);
    let mut cast = Cast::default();
    let mut samples = Vec::new();
    let mut cycles = 0;
    while began.elapsed() < duration || samples.len() < 4 {
        for frame in 0..CYCLE {
            change(&mut app, &mut cast, first_camera, frame);
            step(&mut app, 1);
        }
        assert_eq!(validation_errors(&app), [""; 0]);
        cycles += 1;
        // All pipelines are made in the first cycle; the second grows into its buffers.
        if cycles > 2 && began.elapsed() > duration / 10 {
            samples.push(Memory::of(&app));
        }
    }
    // Each sample is taken in the same state; single ones still tremble with the allocators.
    let part = samples.len().div_ceil(5);
    let [first, last] = [&samples[..part], &samples[samples.len() - part..]].map(Memory::mean);
    println!(
        "{} frames in {:.0} s; MiB after the first tenth and at the end:",
        cycles * CYCLE,
        began.elapsed().as_secs_f64()
    );
    for (whose, first, last) in first.beside(last) {
        let growth = 100.0 * (last / first - 1.0);
        println!(
            "{whose}: {:.2}, {:.2} ({growth:+.2} %)",
            first / MEBIBYTE,
            last / MEBIBYTE
        );
    }
    for (whose, first, last) in first.beside(last) {
        assert!(
            last < 1.01 * first,
            "{whose}: {first} grows to {last} bytes"
        );
    }

    for entity in cast.fluids.drain(..).chain(cast.second_camera) {
        app.world_mut().despawn(entity);
    }
    app.world_mut()
        .entity_mut(first_camera)
        .remove::<FluidDebugView>();
    let seen = last_frame(&mut app);
    assert!(
        seen == last_frame(&mut start(SIZES[0])),
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
