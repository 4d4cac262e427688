//! Liquids among the other things of a Bevy app: glass, fog, lights, cameras, transparent targets.

mod background;
mod behind;
mod cameras;
mod changes;
mod depth;
mod fog;
mod lights;

use bevy::{camera::visibility::RenderLayers, prelude::*};
use bevy_fluid::prelude::*;
use fluid_stage::{ball, capture, headless_app, headless_app_in_background, settle};

const SIZE: UVec2 = uvec2(160, 120);
const MIDDLE: UVec2 = uvec2(80, 60);

/// A ball of particles.
fn drop_of(material: FluidMaterial, at: Vec3) -> impl Bundle {
    let particles = FluidParticles::new(ball(0.5, 0.035), 0.035);
    (particles, material, Transform::from_translation(at))
}

/// An app with a ball of a material 3 m before a camera, over a colour.
fn scene(clear: Color, material: FluidMaterial, more: impl FnOnce(&mut World, Entity)) -> App {
    let mut app = headless_app(SIZE, |app| fill(app, clear, material, more)).unwrap();
    settle(&mut app).unwrap();
    app
}

fn fill(
    app: &mut App,
    clear: Color,
    material: FluidMaterial,
    more: impl FnOnce(&mut World, Entity),
) {
    app.add_plugins((
        FluidPlugin::default(),
        RainPlugin {
            synchronous_bake: true,
        },
    ))
    .insert_resource(ClearColor(clear));
    let world = app.world_mut();
    let camera = (Camera3d::default(), ScreenSpaceFluid::default());
    let camera = world.spawn(camera).id();
    world.spawn(drop_of(material, Vec3::NEG_Z * 3.0));
    more(world, camera);
}

fn pixel(app: &mut App, at: UVec2) -> [u8; 4] {
    capture(app).unwrap().get_pixel(at.x, at.y).0
}

fn differ(a: [u8; 4], b: [u8; 4]) -> u8 {
    (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap()
}

/// A box.
fn paint(world: &mut World, size: Vec3, material: impl Into<StandardMaterial>, at: Vec3) -> Entity {
    let mesh = world
        .resource_mut::<Assets<Mesh>>()
        .add(Cuboid::from_size(size));
    let material = world
        .resource_mut::<Assets<StandardMaterial>>()
        .add(material.into());
    let at = Transform::from_translation(at);
    world
        .spawn((Mesh3d(mesh), MeshMaterial3d(material), at))
        .id()
}

fn unlit(color: Color) -> StandardMaterial {
    StandardMaterial {
        unlit: true,
        ..color.into()
    }
}

fn blended(color: Color) -> StandardMaterial {
    StandardMaterial {
        alpha_mode: AlphaMode::Blend,
        ..unlit(color)
    }
}

/// For a camera: rain that glows white.
fn bright_rain(rate: f32) -> impl Bundle {
    let rain = Rain {
        rate,
        brightness: 30.0,
        ..Rain::HEAVY
    };
    let ambient = AmbientLight {
        brightness: 3000.0,
        ..default()
    };
    (rain, ambient)
}

/// Glass that bends nothing.
fn glass() -> StandardMaterial {
    StandardMaterial {
        specular_transmission: 1.0,
        ior: 1.0,
        reflectance: 0.0,
        ..default()
    }
}
