//! Mesa's software driver (22.3) compiles a shader anew whenever it is bound, and never frees it, where
//! a branch depends on nothing but uniforms: megabytes a frame, and most of a small frame's time. No
//! shader of ours has such branches.

use bevy::prelude::*;
use bevy_fluid::{prelude::*, rain::RainMethod};
use fluid_stage::{headless_app, set_time_step, settle, step};

use super::{
    memory::{MEBIBYTE, Memory},
    script::{RADIUS, particles, settings},
};
use crate::{
    common::{Lens, View},
    heap::alone,
};

const VIEW: View = View {
    size: uvec2(64, 48),
    lens: Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    pose: Transform::IDENTITY,
};

/// By how much the process grows a frame while nothing changes. Unit: MiB.
fn growth(scene: impl FnOnce(&mut App)) -> f64 {
    let mut app = headless_app(VIEW.size, scene).unwrap();
    settle(&mut app).unwrap();
    set_time_step(&mut app, std::time::Duration::from_millis(16));
    step(&mut app, 10);
    let before = Memory::of(&app).process;
    let frames = 30;
    step(&mut app, frames);
    (Memory::of(&app).process - before) / MEBIBYTE / f64::from(frames)
}

fn assert_steady(name: &str, scene: impl FnOnce(&mut App)) {
    let growth = growth(scene);
    println!("{name}: {growth:.3} MiB a frame");
    // The smallest shader that was kept took one.
    assert!(growth < 0.2, "{name}: {growth} MiB a frame");
}

fn fluid(settings: impl Bundle, material: FluidMaterial) -> impl FnOnce(&mut App) {
    move |app| {
        app.add_plugins(FluidPlugin::default());
        let world = app.world_mut();
        world.spawn((VIEW.plain_camera(), settings));
        let positions = particles(0, 500).collect();
        world.spawn((FluidParticles::new(positions, RADIUS), material));
    }
}

#[test]
fn no_shader_is_compiled_anew_in_each_frame() {
    let _alone = alone();
    for i in 0..8 {
        assert_steady(
            &format!("fluid, settings {i}"),
            fluid(settings(i), FluidMaterial::WATER),
        );
    }
    for (name, material) in [
        ("milk", FluidMaterial::MILK),
        ("smoke", FluidMaterial::SMOKE),
        ("fire", FluidMaterial::FIRE),
    ] {
        assert_steady(name, fluid(settings(0), material));
    }
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        assert_steady(&format!("rain, {method:?}"), |app| {
            app.add_plugins(RainPlugin {
                synchronous_bake: true,
            });
            let rain = Rain {
                method,
                ..Rain::HEAVY
            };
            app.world_mut().spawn((VIEW.plain_camera(), rain));
        });
    }
}
