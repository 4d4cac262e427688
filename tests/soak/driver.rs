//! What the driver keeps of every frame, whoever draws it: the evidence behind docs/stability.md.

use bevy::{core_pipeline::tonemapping::Tonemapping, prelude::*};
use bevy_fluid::{ScreenSpaceFluid, prelude::*};
use fluid_stage::{headless_app, set_time_step, settle, step};

use crate::{
    common::{Lens, RAW, View, spawn_box},
    memory::{MEBIBYTE, Memory},
    script::{RADIUS, particles},
};

const VIEW: View = View {
    size: uvec2(64, 48),
    lens: Lens::Perspective {
        fov: 0.7,
        near: 0.1,
    },
    pose: Transform::IDENTITY,
};

/// Megabytes a frame by which the process grows while nothing changes.
fn growth(name: &str, scene: impl FnOnce(&mut App)) -> f64 {
    let mut app = headless_app(VIEW.size, scene).unwrap();
    settle(&mut app).unwrap();
    set_time_step(&mut app, std::time::Duration::from_millis(16));
    step(&mut app, 20);
    let before = Memory::of(&app);
    let frames = 60;
    step(&mut app, frames);
    let after = Memory::of(&app);
    println!(
        "{name}: {:.3} {:.4}",
        (after.process - before.process) / MEBIBYTE / 60.0,
        (after.heap - before.heap) / MEBIBYTE / 60.0
    );
    0.0
}

fn lit_box(world: &mut World, at: Vec3) {
    let mesh = world.resource_mut::<Assets<Mesh>>().add(Cuboid::default());
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(StandardMaterial::default());
    world.spawn((
        Mesh3d(mesh),
        MeshMaterial3d(material),
        Transform::from_translation(at),
    ));
}

#[test]
#[ignore = "a measurement, for docs/stability.md"]
fn memory_that_the_driver_keeps() {
    if std::env::var_os("ALL").is_some() {
        growth("a camera", |app| {
            app.world_mut().spawn(VIEW.plain_camera());
        });
        growth("a camera with tonemapping", |app| {
            app.world_mut()
                .spawn(VIEW.plain_camera())
                .insert(Tonemapping::TonyMcMapface);
        });
        growth("an unlit box", |app| {
            app.world_mut().spawn(VIEW.plain_camera());
            spawn_box(
                app.world_mut(),
                Vec3::ONE,
                Transform::from_xyz(0.0, 0.0, -5.0),
            );
        });
        growth("a lit box, no light", |app| {
            app.world_mut().spawn(VIEW.plain_camera());
            lit_box(app.world_mut(), vec3(0.0, 0.0, -5.0));
        });
        growth("a lit box and the sun", |app| {
            app.world_mut().spawn(VIEW.plain_camera());
            lit_box(app.world_mut(), vec3(0.0, 0.0, -5.0));
            app.world_mut().spawn(DirectionalLight::default());
        });
        growth("eight lit boxes and the sun", |app| {
            app.world_mut().spawn(VIEW.plain_camera());
            for i in 0..8 {
                lit_box(app.world_mut(), vec3(i as f32 - 4.0, 0.0, -9.0));
            }
            app.world_mut().spawn(DirectionalLight::default());
        });
    }
    for i in 0..12 {
        growth(&format!("fluid {i}"), |app| {
            app.add_plugins(FluidPlugin::default());
            app.world_mut()
                .spawn(VIEW.camera(crate::script::settings(i)));
            app.world_mut().spawn((
                FluidParticles::new(particles(0, 500).collect(), RADIUS),
                [
                    FluidMaterial::WATER,
                    FluidMaterial::MILK,
                    FluidMaterial::SMOKE,
                    FluidMaterial::FIRE,
                    FluidMaterial::INK,
                ][i.saturating_sub(7) as usize],
            ));
        });
    }
    for method in [RainMethod::Streaks, RainMethod::PerDrop] {
        growth(&format!("rain, {method:?}"), |app| {
            app.add_plugins(RainPlugin {
                synchronous_bake: true,
            });
            app.world_mut().spawn(VIEW.plain_camera()).insert(Rain {
                method,
                ..Rain::HEAVY
            });
        });
    }
}
use bevy_fluid::rain::RainMethod;
