//! A street with houses, a lamp, a car, a bus shelter and a fountain. Lengths in metres, light in
//! the units of real lamps.

use bevy::{
    asset::RenderAssetUsages,
    camera::{ClearColorConfig, Exposure},
    image::ImageSampler,
    light::{EnvironmentMapLight, NotShadowCaster, Skybox},
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};
use bevy_fluid::{prelude::*, rain::RainShelter};
use fluid_stage::scenery::Scenery;

/// The lamp's head.
const LAMP: Vec3 = vec3(-1.2, 4.2, -3.2);
/// Positions and direction of the car's headlights.
const HEADLIGHTS: [Vec3; 2] = [vec3(0.0, 0.65, -0.3), vec3(0.0, 0.65, 0.9)];
const AHEAD: Vec3 = vec3(1.0, -0.06, 0.0);
/// The fountain: centre of its floor, half of the sides of its water, particle radii of that and of
/// the jet.
const FOUNTAIN: Vec3 = vec3(1.6, 0.0, -2.3);
const BASIN: Vec3 = vec3(25.0 * RADIUS, 6.0 * RADIUS, 14.0 * RADIUS);
const RADIUS: f32 = 0.036;
const DROP: f32 = 0.016;
/// Texels along a face of the sky.
const SKY_SIDE: u32 = 32;

/// Spawns the lights and returns the components that the camera needs for them.
pub(crate) fn light(scenery: &mut Scenery, night: bool) -> impl Bundle + use<> {
    // At night, the glow of the town.
    let brightness = if night { 0.03 } else { 1400.0 };
    let sky = scenery.images.add(overcast());
    if night {
        lamps(scenery);
    }
    (
        Exposure {
            ev100: if night { 2.0 } else { 9.5 },
        },
        Skybox {
            image: Some(sky.clone()),
            brightness,
            ..default()
        },
        EnvironmentMapLight {
            diffuse_map: sky.clone(),
            specular_map: sky,
            intensity: brightness,
            ..default()
        },
        Camera {
            clear_color: ClearColorConfig::Custom(Color::BLACK),
            ..default()
        },
    )
}

/// The CIE's overcast sky, three times as bright above as at the horizon, over grey ground. It is
/// so smooth that it serves as its own blur.
fn overcast() -> Image {
    let mut texels = Vec::new();
    for face in 0..6 {
        for texel in 0..SKY_SIDE * SKY_SIDE {
            let at = |i: u32| 2.0 * (i as f32 + 0.5) / SKY_SIDE as f32 - 1.0;
            let (across, down) = (at(texel % SKY_SIDE), at(texel / SKY_SIDE));
            let up = match face {
                2 => 1.0,
                3 => -1.0,
                _ => -down,
            } / (1.0 + across * across + down * down).sqrt();
            let sky = (1.0 + 2.0 * up.max(0.0)) / 3.0;
            let gray = sky.lerp(0.12, ((0.1 - up) / 0.2).clamp(0.0, 1.0));
            for channel in [0.95, 0.98, 1.0, 1.0 / gray] {
                texels.extend(((gray * channel * 255.0).round() as u8).to_le_bytes());
            }
        }
    }
    let mut image = Image::new(
        Extent3d {
            width: SKY_SIDE,
            height: SKY_SIDE,
            depth_or_array_layers: 6,
        },
        TextureDimension::D2,
        texels,
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..default()
    });
    image.sampler = ImageSampler::linear();
    image
}

fn lamps(scenery: &mut Scenery) {
    let warm = Color::srgb(1.0, 0.78, 0.5);
    // Bevy's spot lights are as bright as a point light of this luminous power.
    scenery.commands.spawn((
        SpotLight {
            color: warm,
            intensity: 12_000.0,
            range: 25.0,
            inner_angle: 0.5,
            outer_angle: 1.2,
            shadow_maps_enabled: true,
            ..default()
        },
        Transform::from_translation(LAMP - 0.1 * Vec3::Y).looking_to(Vec3::NEG_Y, Vec3::X),
    ));
    for place in HEADLIGHTS {
        scenery.commands.spawn((
            SpotLight {
                color: Color::srgb(0.9, 0.95, 1.0),
                intensity: 60_000.0,
                range: 40.0,
                inner_angle: 0.1,
                outer_angle: 0.35,
                shadow_maps_enabled: true,
                ..default()
            },
            Transform::from_translation(place + 0.05 * AHEAD).looking_to(AHEAD, Vec3::Y),
        ));
    }
    let bulb = scenery.materials.add(StandardMaterial {
        base_color: Color::BLACK,
        emissive: LinearRgba::rgb(1.0, 0.85, 0.6) * 2000.0,
        ..default()
    });
    let bulbs = [(LAMP, 0.12), (HEADLIGHTS[0], 0.08), (HEADLIGHTS[1], 0.08)];
    for (place, radius) in bulbs {
        scenery.commands.spawn((
            Mesh3d(scenery.meshes.add(Sphere::new(radius))),
            MeshMaterial3d(bulb.clone()),
            Transform::from_translation(place),
            NotShadowCaster,
        ));
    }
}

pub(crate) fn build(scenery: &mut Scenery, night: bool) {
    let asphalt = Color::srgb(0.16, 0.16, 0.17);
    let paving = Color::srgb(0.34, 0.33, 0.31);
    block(
        scenery,
        vec3(0.0, -0.05, 0.0),
        vec3(60.0, 0.1, 60.0),
        asphalt,
    );
    block(scenery, vec3(0.0, 0.0, -4.0), vec3(60.0, 0.12, 4.4), paving);
    // Houses along the pavement, of three colours.
    for house in 0..7_u8 {
        let x = 5.0 * f32::from(house) - 15.0;
        let height = 5.0 + f32::from(house * 3 % 5);
        let wall = [
            Color::srgb(0.45, 0.36, 0.3),
            Color::srgb(0.38, 0.4, 0.42),
            Color::srgb(0.5, 0.46, 0.36),
        ][usize::from(house) % 3];
        block(
            scenery,
            vec3(x, 0.5 * height, -8.4),
            vec3(4.8, height, 4.0),
            wall,
        );
        for (storey, y) in [1.7, 4.1].into_iter().enumerate() {
            for (side, window) in [-1.2, 1.2].into_iter().enumerate() {
                let at = vec3(x + window, y, -6.4);
                // At night some windows are lit.
                let lit = night && (usize::from(house) + 2 * storey + 3 * side) % 5 == 0;
                let glass = Color::srgb(0.08, 0.09, 0.11);
                let entity = block(scenery, at, vec3(1.0, 1.4, 0.06), glass);
                if lit {
                    let light = LinearRgba::rgb(1.0, 0.6, 0.25) * 0.5;
                    glow(scenery, entity, light);
                }
            }
        }
    }
    // The lamp's post, the bus shelter.
    let metal = Color::srgb(0.12, 0.13, 0.14);
    block(
        scenery,
        vec3(LAMP.x, 2.1, LAMP.z - 0.4),
        vec3(0.09, 4.2, 0.09),
        metal,
    );
    block(
        scenery,
        LAMP + vec3(0.0, 0.14, -0.2),
        vec3(0.3, 0.06, 0.7),
        metal,
    );
    car(scenery);
    let roof = vec3(3.0, 2.5, -4.6);
    let size = vec3(2.8, 0.1, 1.8);
    let entity = block(scenery, roof, size, Color::srgb(0.25, 0.3, 0.3));
    scenery.commands.entity(entity).insert(RainShelter {
        half_size: 0.5 * size,
    });
    for x in [1.7, 4.3] {
        block(scenery, vec3(x, 1.25, -5.4), vec3(0.08, 2.5, 0.08), metal);
    }
    fountain(scenery);
}

/// A car with headlights at [`HEADLIGHTS`].
fn car(scenery: &mut Scenery) {
    let paint = Color::srgb(0.35, 0.05, 0.06);
    let glass = Color::srgb(0.03, 0.035, 0.04);
    let rubber = Color::srgb(0.03, 0.03, 0.03);
    for (at, size, color) in [
        (vec3(-2.1, 0.56, 0.3), vec3(4.1, 0.5, 1.64), paint),
        (vec3(-2.25, 0.83, 0.3), vec3(3.6, 0.14, 1.56), paint),
        (vec3(-2.6, 1.08, 0.3), vec3(1.9, 0.4, 1.42), glass),
        (vec3(-2.65, 1.31, 0.3), vec3(1.7, 0.07, 1.38), paint),
        (vec3(-0.03, 0.42, 0.3), vec3(0.14, 0.16, 1.7), rubber),
    ] {
        block(scenery, at, size, color);
    }
    // The pillars between its windows.
    for x in [-1.72, -2.62, -3.48] {
        block(scenery, vec3(x, 1.09, 0.3), vec3(0.07, 0.42, 1.44), paint);
    }
    let tyre = scenery.meshes.add(Cylinder::new(0.33, 0.22));
    let material = scenery.materials.add(StandardMaterial {
        base_color: rubber,
        perceptual_roughness: 0.8,
        ..default()
    });
    for (x, z) in [(-0.8, -0.48), (-0.8, 1.08), (-3.4, -0.48), (-3.4, 1.08)] {
        scenery.commands.spawn((
            Mesh3d(tyre.clone()),
            MeshMaterial3d(material.clone()),
            Transform::from_xyz(x, 0.33, z)
                .with_rotation(Quat::from_rotation_x(core::f32::consts::FRAC_PI_2)),
        ));
    }
}

fn glow(scenery: &mut Scenery, entity: Entity, emissive: LinearRgba) {
    let material = scenery.materials.add(StandardMaterial {
        base_color: Color::BLACK,
        emissive,
        ..default()
    });
    scenery
        .commands
        .entity(entity)
        .insert(MeshMaterial3d(material));
}

fn block(scenery: &mut Scenery, at: Vec3, size: Vec3, color: Color) -> Entity {
    let mesh = scenery.meshes.add(Cuboid::from_size(size));
    let material = scenery.materials.add(StandardMaterial {
        base_color: color,
        // Wet.
        perceptual_roughness: 0.45,
        ..default()
    });
    scenery
        .commands
        .spawn((
            Mesh3d(mesh),
            MeshMaterial3d(material),
            Transform::from_translation(at),
        ))
        .id()
}

/// A basin full of water, and a jet that falls back into it.
fn fountain(scenery: &mut Scenery) {
    let stone = Color::srgb(0.5, 0.48, 0.44);
    let wall = 0.12;
    let height = 2.0 * BASIN.y + 0.06;
    for side in [-1.0, 1.0] {
        let long = vec3(0.0, 0.5 * height, side * (BASIN.z + 0.5 * wall));
        let short = vec3(side * (BASIN.x + 0.5 * wall), 0.5 * height, 0.0);
        let length = 2.0 * (BASIN.x + wall);
        block(scenery, FOUNTAIN + long, vec3(length, height, wall), stone);
        block(
            scenery,
            FOUNTAIN + short,
            vec3(wall, height, 2.0 * BASIN.z),
            stone,
        );
    }
    let count = (BASIN / RADIUS).round().as_ivec3();
    let first = FOUNTAIN - vec3(BASIN.x, 0.0, BASIN.z) + Vec3::splat(RADIUS);
    let water = (0..count.y).flat_map(|y| {
        (0..count.x * count.z)
            .map(move |i| first + ivec3(i % count.x, y, i / count.x).as_vec3() * (2.0 * RADIUS))
    });
    scenery.commands.spawn((
        FluidParticles::new(water.collect(), RADIUS),
        FluidMaterial::WATER,
    ));
    scenery.commands.spawn((
        ParticleEmitter {
            particle_radius: DROP,
            nozzle_radius: 0.02,
            cone_half_angle: 0.09,
            jitter: 0.25,
            lifetime: 0.7,
            ..ParticleEmitter::fountain(5000.0, 3.4)
        },
        Transform::from_translation(FOUNTAIN + 2.0 * BASIN.y * Vec3::Y),
    ));
}
