//! A fountain: a jet rises from a ball and falls back over it, six more meet above it from the
//! basin's rim. The falling water splashes on the ball and on the water in the basin.
//!
//! Turn the camera with the mouse; press Space to turn the water off and on, Enter for a burst.
//! `--out FILE.png [--frames N]` writes a picture instead. Try a `FluidMaterial::INK`.

use std::{f32::consts::TAU, time::Duration};

use bevy::prelude::*;
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins,
    scenery::{Scenery, orbit_camera},
};

/// Particle radius of the column, of the jets and of the water in the basin, m.
const COLUMN: f32 = 0.014;
const DROP: f32 = 0.0105;
const POOL: f32 = 0.022;
/// The basin's radius and the depth of its water, m.
const BASIN: f32 = 1.15;
const DEPTH: f32 = 0.14;
/// The ball: its radius and the height of its centre, m.
const BALL: (f32, f32) = (0.24, 0.62);
const JETS: u32 = 6;
const TO_SUN: Vec3 = vec3(-0.6, 0.75, 0.35);

fn main() -> AppExit {
    let stage = StagePlugins {
        frames: 60,
        time_step: Duration::from_secs_f32(1.0 / 30.0),
        title: "fountain · bevy_fluid".into(),
        ..default()
    };
    App::new()
        .add_plugins((stage.with_args(), FluidPlugin::default()))
        .add_systems(Startup, (scene, water))
        .add_systems(Update, play)
        .run()
}

/// The emitters, and the water in the basin.
fn water(mut commands: Commands) {
    let (radius, height) = BALL;
    commands.spawn((
        ParticleEmitter {
            particle_radius: COLUMN,
            nozzle_radius: 0.03,
            cone_half_angle: 0.05,
            jitter: 0.2,
            lifetime: 1.5,
            ..ParticleEmitter::fountain(16_000.0, 4.0)
        },
        Transform::from_xyz(0.0, height + radius + 0.02, 0.0),
    ));
    let jet = ParticleEmitter {
        particle_radius: DROP,
        nozzle_radius: 0.016,
        cone_half_angle: 0.01,
        lifetime: 1.0,
        ..ParticleEmitter::jet(4000.0, 3.7)
    };
    for i in 0..JETS {
        let place = around(i, JETS, BASIN - 0.08).with_y(0.25);
        let aim = Transform::from_translation(place).looking_at(Vec3::Y * 2.2, Vec3::Y);
        commands.spawn((
            ParticleEmitter {
                seed: 1 + u64::from(i),
                ..jet
            },
            aim,
        ));
    }
    // Drops that fall onto the water in the basin splash up.
    commands.spawn((
        ParticleCollider {
            restitution: 0.35,
            friction: 0.3,
            ..ParticleCollider::ground()
        },
        Transform::from_xyz(0.0, DEPTH, 0.0),
    ));
    // With a material of its own, this is a separate body, drawn behind the jets.
    let deep = FluidMaterial {
        medium: Medium::absorbing(LinearRgba::rgb(0.25, 0.7, 0.75), 0.6),
        ..FluidMaterial::WATER
    };
    commands.spawn((FluidParticles::new(pool().collect(), POOL), deep));
}

/// Still water, evenly spread in layers.
fn pool() -> impl Iterator<Item = Vec3> {
    let layers = (DEPTH / (2.0 * POOL)) as u32;
    let count = (BASIN / (2.0 * POOL)).powi(2) * std::f32::consts::PI;
    (0..layers).flat_map(move |layer| {
        let height = (2 * layer + 1) as f32 * POOL;
        (0..count as u32).map(move |i| {
            let out = BASIN * ((i as f32 + 0.5) / count).sqrt();
            let place = Vec2::from_angle(2.399963 * i as f32 + layer as f32) * out;
            vec3(place.x, height, place.y)
        })
    })
}

/// Place `i` of `count` on a circle.
fn around(i: u32, count: u32, radius: f32) -> Vec3 {
    let place = Vec2::from_angle(TAU * (i as f32 + 0.5) / count as f32) * radius;
    vec3(place.x, 0.0, place.y)
}

/// The scenery and its colliders.
fn scene(mut scenery: Scenery) {
    scenery.checker_floor(Vec3::ZERO, 6.0, 24);
    scenery.sun(TO_SUN, 12.0, true);
    let sky = scenery.sky(TO_SUN);
    let stone = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.62, 0.58, 0.52),
        perceptual_roughness: 0.85,
        ..default()
    });
    let bronze = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.72, 0.45, 0.2),
        metallic: 1.0,
        perceptual_roughness: 0.3,
        ..default()
    });
    let tiles = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.24, 0.34, 0.36),
        perceptual_roughness: 0.6,
        ..default()
    });

    let hedge = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.16, 0.27, 0.09),
        perceptual_roughness: 1.0,
        ..default()
    });

    let (radius, height) = BALL;
    let mut put = |mesh: Handle<Mesh>, material: &Handle<StandardMaterial>, at: Vec3| {
        let material = MeshMaterial3d(material.clone());
        scenery
            .commands
            .spawn((Mesh3d(mesh), material, Transform::from_translation(at)))
            .id()
    };
    let ball = Sphere::new(radius);
    let foot = Capsule3d::new(0.09, height);
    let rim = Torus::new(BASIN, BASIN + 0.16);
    let ball_there = put(
        scenery.meshes.add(ball.mesh().ico(12).unwrap()),
        &bronze,
        Vec3::Y * height,
    );
    let foot_there = put(scenery.meshes.add(foot), &bronze, Vec3::Y * 0.5 * height);
    put(scenery.meshes.add(rim), &stone, Vec3::Y * 0.14);
    put(
        scenery.meshes.add(Cylinder::new(BASIN + 0.02, 0.02)),
        &tiles,
        Vec3::Y * 0.005,
    );
    for i in 0..16 {
        let size = 0.62 + 0.1 * (5.0 * i as f32).sin();
        let place = vec3(
            0.62 * i as f32 - 4.6,
            0.8 * size,
            -2.7 - 0.15 * (i % 2) as f32,
        );
        put(scenery.meshes.add(Sphere::new(size)), &hedge, place);
    }
    for (entity, solid) in [
        (ball_there, ball.into()),
        (foot_there, ParticleCollider::from(foot)),
    ] {
        scenery.commands.entity(entity).insert(solid);
    }

    scenery.commands.spawn((
        orbit_camera(vec3(0.5, 1.35, 3.3), vec3(0.0, 0.85, 0.0)),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
}

fn play(mut emitters: Query<&mut ParticleEmitter>, keys: Res<ButtonInput<KeyCode>>) {
    for mut emitter in &mut emitters {
        if keys.just_pressed(KeyCode::Space) {
            emitter.enabled = !emitter.enabled;
        }
        if keys.just_pressed(KeyCode::Enter) {
            emitter.burst(1000);
        }
    }
}
