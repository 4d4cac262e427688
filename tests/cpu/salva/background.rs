//! Boundaries that move while nobody waits.

use std::{thread::sleep, time::Duration};

use bevy::prelude::*;
use bevy_fluid::prelude::*;

use super::pool::{STEP, app, mean, particles, pool};

#[test]
fn a_tank_takes_its_water_along_without_a_wait() {
    let mut app = app();
    app.world_mut().resource_mut::<SalvaSettings>().mode = SalvaMode::Background;
    let size = vec3(0.4, 2.0, 0.4);
    let (tank, water) = pool(&mut app, size, 0.4);
    let count = particles(&app, water).len();
    let update = |app: &mut App| {
        app.update();
        // About what a step of so few takes.
        sleep(Duration::from_millis(3));
    };
    let way = 0.5;
    for i in 1..=120 {
        let mut transform = app.world_mut().get_mut::<Transform>(tank).unwrap();
        // To there and to rest.
        transform.translation.x = way * (i as f32 / 120.0).min(1.0);
        update(&mut app);
    }
    for _ in 0..240 {
        update(&mut app);
    }
    let now = particles(&app, water);
    assert_eq!(now.len(), count, "none is lost");
    for place in now {
        let local = *place - vec3(way, 0.5 * size.y, 0.0);
        let is_inside = local.abs().cmple(0.5 * size + 1e-3).all();
        assert!(is_inside, "{place} after {} s", 360.0 * STEP);
    }
    let x = mean(now.iter().map(|p| p.x));
    assert!((x - way).abs() < 0.05, "{x}");
}
