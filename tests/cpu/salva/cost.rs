//! A measurement.

use bevy::prelude::*;

use super::pool::{RADIUS, app, pool, run, status};

/// Prints what steps cost.
#[test]
#[ignore = "a measurement"]
fn cost() {
    println!("| particles | ms per step |\n|---|---|");
    for side in [10, 15, 20, 30] {
        let mut app = app();
        let width = side as f32 * 2.0 * RADIUS;
        pool(&mut app, vec3(2.0 * width, 2.0 * width, width), width);
        run(&mut app, 0.3);
        let mut times = Vec::new();
        for _ in 0..20 {
            app.update();
            times.push(status(&app).step_time.as_secs_f32() * 1e3);
        }
        times.sort_by(f32::total_cmp);
        println!("| {} | {:.1} |", status(&app).particles, times[10]);
    }
}
