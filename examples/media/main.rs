//! Media inside fluids. Above: the seven combinations of scattering, absorption and emission in
//! balls without refraction. Below: water, ink, milk and honey, and smoke and fire from particles.
//! An opaque, banded post stands in or behind each.
//!
//! Turn the camera with the mouse; press N for night and day: scattering media darken, emitting
//! media do not. `--out FILE.png [--frames N]` writes a picture instead.

mod labels;
mod plumes;

use std::time::Duration;

use bevy::{light::Skybox, prelude::*};
use bevy_fluid::prelude::*;
use fluid_stage::{
    StagePlugins,
    scenery::{Scenery, Sky, orbit_camera},
};

use crate::{
    labels::label,
    plumes::{Plume, blow},
};

/// Width of a place on a shelf and height of a shelf, m.
const PLACE: Vec2 = vec2(1.15, 1.75);
/// Radius of the balls, and of the particles that they are made of, m.
const BALL: f32 = 0.42;
const RADIUS: f32 = 0.028;
const TO_SUN: Vec3 = vec3(0.35, 0.8, 0.6);
/// Luminance that is shown as white, the unit of the emissions below. Unit: cd/m².
const WHITE: f32 = 1000.0;

fn main() -> AppExit {
    let stage = StagePlugins {
        size: uvec2(1600, 800),
        // The state of a plume depends on the time alone.
        frames: 5,
        time_step: Duration::from_secs_f32(0.7),
        title: "media · bevy_fluid".into(),
        ..default()
    };
    App::new()
        .add_plugins((stage.with_args(), FluidPlugin::default()))
        .add_systems(Startup, setup)
        .add_systems(Update, night)
        .add_systems(PostUpdate, blow.in_set(FluidSystems::Simulate))
        .run()
}

/// The article's seven combinations.
fn combinations() -> [(&'static str, Medium); 7] {
    let scattering = Medium::scattering(LinearRgba::rgb(0.75, 0.78, 0.82), 0.25);
    let absorption = Medium::absorbing(LinearRgba::rgb(0.12, 0.35, 0.9), 0.6);
    let emission = Medium::emitting(LinearRgba::rgb(1.0, 0.22, 0.02) * WHITE, 0.6);
    [
        ("nothing", Medium::CLEAR),
        ("scattering", scattering),
        ("absorption", absorption),
        ("scattering + absorption", scattering + absorption),
        ("emission", emission),
        ("scattering + emission", scattering + emission),
        ("absorption + emission", absorption + emission),
    ]
}

const LIQUIDS: [(&str, FluidMaterial); 4] = [
    ("water", FluidMaterial::WATER),
    ("ink", FluidMaterial::INK),
    ("milk", FluidMaterial::MILK),
    ("honey", FluidMaterial::HONEY),
];

fn setup(mut scenery: Scenery) {
    let sky = scenery.sky(TO_SUN);
    scenery.sun(TO_SUN, 25.0, true);
    let upper = PLACE.y * Vec3::Y;
    shelf(&mut scenery, upper);
    shelf(&mut scenery, Vec3::ZERO);

    for (i, (name, medium)) in combinations().into_iter().enumerate() {
        let foot = upper + place(i, 7);
        post(&mut scenery, foot);
        label(&mut scenery, name, foot + vec3(0.0, -0.12, 0.56));
        let material = FluidMaterial {
            refractive_index: 1.0,
            medium,
            ..default()
        };
        ball(&mut scenery, foot, material);
    }
    for (i, (name, material)) in LIQUIDS.into_iter().enumerate() {
        let foot = place(i, 6);
        post(&mut scenery, foot + vec3(0.1, 0.0, -0.45));
        label(&mut scenery, name, foot + vec3(0.0, -0.12, 0.56));
        ball(&mut scenery, foot, material);
    }
    for (i, (name, plume)) in [("smoke", Plume::SMOKE), ("fire", Plume::FIRE)]
        .into_iter()
        .enumerate()
    {
        let foot = place(4 + i, 6);
        post(&mut scenery, foot + vec3(0.1, 0.0, -0.45));
        label(&mut scenery, name, foot + vec3(0.0, -0.12, 0.56));
        scenery
            .commands
            .spawn((plume.fluid(), plume, Transform::from_translation(foot)));
    }

    let eye = vec3(0.0, 2.6, 15.0);
    scenery.commands.spawn((
        orbit_camera(eye, vec3(0.0, 1.55, 0.0)),
        Projection::from(PerspectiveProjection {
            fov: 0.285,
            ..default()
        }),
        ScreenSpaceFluid::default(),
        sky.bundle(),
    ));
    scenery.commands.insert_resource(Day { sky, shines: true });
}

/// The foot of place `i` of `count` in a row.
fn place(i: usize, count: usize) -> Vec3 {
    (i as f32 - 0.5 * (count as f32 - 1.0)) * PLACE.x * Vec3::X
}

/// A board with a wall behind it.
fn shelf(scenery: &mut Scenery, at: Vec3) {
    let width = 7.4 * PLACE.x;
    let board = scenery.meshes.add(Cuboid::new(width, 0.2, 1.7));
    let wood = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.46, 0.44, 0.42),
        perceptual_roughness: 0.9,
        ..default()
    });
    scenery.commands.spawn((
        Mesh3d(board),
        MeshMaterial3d(wood),
        Transform::from_translation(at + vec3(0.0, -0.1, -0.3)),
    ));
    let wall = scenery.meshes.add(Cuboid::new(width, PLACE.y, 0.1));
    let paint = scenery.materials.add(StandardMaterial {
        base_color: Color::srgb(0.16, 0.18, 0.2),
        perceptual_roughness: 0.9,
        ..default()
    });
    scenery.commands.spawn((
        Mesh3d(wall),
        MeshMaterial3d(paint),
        Transform::from_translation(at + vec3(0.0, 0.5 * PLACE.y - 0.1, -1.15)),
    ));
}

/// An opaque post of coloured bands, with its foot at `foot`.
fn post(scenery: &mut Scenery, foot: Vec3) {
    let band = scenery.meshes.add(Cylinder::new(0.09, 0.14));
    for i in 0..8 {
        let color = match i % 4 {
            0 => Color::srgb(0.85, 0.2, 0.15),
            2 => Color::srgb(0.2, 0.55, 0.25),
            _ => Color::srgb(0.9, 0.88, 0.82),
        };
        let paint = scenery.materials.add(StandardMaterial {
            base_color: color,
            perceptual_roughness: 0.7,
            ..default()
        });
        scenery.commands.spawn((
            Mesh3d(band.clone()),
            MeshMaterial3d(paint),
            Transform::from_translation(foot + (0.07 + 0.14 * i as f32) * Vec3::Y),
        ));
    }
}

/// A ball that rests on `foot`.
fn ball(scenery: &mut Scenery, foot: Vec3, material: FluidMaterial) {
    scenery.commands.spawn((
        FluidParticles::new(fluid_stage::ball(BALL, RADIUS), RADIUS),
        material,
        Transform::from_translation(foot + (BALL + 0.06) * Vec3::Y),
    ));
}

#[derive(Resource)]
struct Day {
    sky: Sky,
    shines: bool,
}

/// Turns the sun and the sky off or on.
fn night(
    keys: Res<ButtonInput<KeyCode>>,
    mut day: ResMut<Day>,
    mut suns: Query<&mut Visibility, With<DirectionalLight>>,
    mut skies: Query<(&mut Skybox, &mut EnvironmentMapLight)>,
) {
    if !keys.just_pressed(KeyCode::KeyN) {
        return;
    }
    day.shines = !day.shines;
    for mut sun in &mut suns {
        *sun = if day.shines {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        };
    }
    let brightness = if day.shines { 1.0 } else { 0.02 } * day.sky.brightness;
    for (mut skybox, mut light) in &mut skies {
        skybox.brightness = brightness;
        light.intensity = brightness;
    }
}
