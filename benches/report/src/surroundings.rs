//! What is around the liquid, for the renderer and for the tracer: a smooth sky, a chequered floor
//! and a chequered wall. All of it shines by itself, so that only the liquid's optics differ.

use bevy::{
    asset::RenderAssetUsages,
    camera::Exposure,
    image::{ImageAddressMode, ImageSampler, ImageSamplerDescriptor},
    light::{EnvironmentMapLight, Skybox},
    math::{DVec3, Vec3, dvec3},
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use fluid_reference::{
    metrics::{decode_srgb, encode_srgb},
    surface::Cuboid,
    tracer::{Object, checker},
};
use fluid_stage::scenery::sky_cubemap;

/// Texels along a face of the sky: smooth as it is, between them it is off by less than 1e-4.
const SKY_SIDE: usize = 256;
/// Side of a square, m.
pub(crate) const SQUARE: f64 = 0.35;
/// Colours of the squares in sRGB bytes.
pub(crate) const LIGHT: [u8; 3] = [226, 214, 190];
pub(crate) const DARK: [u8; 3] = [66, 84, 122];
/// How far floor and wall reach, m.
pub(crate) const REACH: f64 = 8.0;

/// Where floor and wall stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surroundings {
    /// Height of the floor, m.
    pub(crate) floor: f64,
    /// z of the wall, m.
    pub(crate) wall: f64,
}

impl Surroundings {
    pub(crate) fn objects(&self) -> Vec<Object> {
        let colors = [LIGHT, DARK].map(linear);
        let Self { floor, wall } = *self;
        let floor_box = Cuboid::between(
            dvec3(-REACH, floor - 1.0, wall),
            dvec3(REACH, floor, wall + 2.0 * REACH),
        );
        let wall_box = Cuboid::between(
            dvec3(-REACH, floor, wall - 1.0),
            dvec3(REACH, floor + REACH, wall),
        );
        vec![
            Object::new(floor_box, checker([DVec3::X, DVec3::Z], SQUARE, colors)),
            Object::new(wall_box, checker([DVec3::X, DVec3::Y], SQUARE, colors)),
        ]
    }

    /// The same things for the renderer.
    pub(crate) fn spawn(&self, world: &mut World) {
        let texture = world.resource_mut::<Assets<Image>>().add(squares());
        let material = world
            .resource_mut::<Assets<StandardMaterial>>()
            .add(StandardMaterial {
                base_color_texture: Some(texture),
                unlit: true,
                ..default()
            });
        let [floor, wall, reach] = [self.floor, self.wall, REACH].map(|x| x as f32);
        let corner = vec3(-reach, floor, wall);
        for (across, up) in [(Vec3::X, Vec3::Z), (Vec3::X, Vec3::Y)] {
            let size = if up == Vec3::Z { 2.0 * reach } else { reach };
            let mesh = quad(corner, across * 2.0 * reach, up * size, |at| {
                vec2(at.dot(across), at.dot(up)) / (2.0 * SQUARE as f32)
            });
            let mesh = world.resource_mut::<Assets<Mesh>>().add(mesh);
            world.spawn((Mesh3d(mesh), MeshMaterial3d(material.clone())));
        }
    }

    /// The sky for the renderer's camera.
    pub(crate) fn sky(world: &mut World) -> impl Bundle + use<> {
        lit_by(world, |direction| sky(direction.as_dvec3()).as_vec3())
    }

    /// A white furnace: radiance 1 from everywhere.
    pub(crate) fn furnace(world: &mut World) -> impl Bundle + use<> {
        lit_by(world, |_| Vec3::ONE)
    }
}

fn lit_by(world: &mut World, radiance: fn(Vec3) -> Vec3) -> impl Bundle + use<> {
    let image = world
        .resource_mut::<Assets<Image>>()
        .add(sky_cubemap(SKY_SIDE, radiance));
    // So that a texel of 1 is 1 on screen.
    let brightness = 1.0 / Exposure::default().exposure();
    (
        Skybox {
            image: Some(image.clone()),
            brightness,
            ..default()
        },
        EnvironmentMapLight {
            diffuse_map: image.clone(),
            specular_map: image,
            intensity: brightness,
            ..default()
        },
    )
}

/// Radiance of the sky along a unit direction: pale at the horizon, a glow on the right.
pub(crate) fn sky(direction: DVec3) -> DVec3 {
    let up = direction.y;
    let above = 0.5 + 0.5 * (3.0 * up).tanh();
    let zenith = dvec3(0.22, 0.42, 0.78);
    let horizon = dvec3(0.78, 0.86, 0.92);
    let ground = dvec3(0.34, 0.31, 0.27);
    let pale = (-4.0 * up * up).exp();
    let glow = direction.dot(dvec3(0.6, 0.64, 0.48).normalize()).max(0.0);
    ground.lerp(zenith, above).lerp(horizon, 0.8 * pale) + dvec3(0.5, 0.42, 0.25) * glow.powi(24)
}

/// From sRGB bytes.
pub(crate) fn linear(bytes: [u8; 3]) -> DVec3 {
    decode_srgb(DVec3::from(bytes.map(f64::from)) / 255.0)
}

/// Two by two squares, to be repeated, with their means for pixels that hold more than a texel: the
/// surroundings have no stairs of their own.
fn squares() -> Image {
    let levels = SQUARES_SIDE.ilog2() + 1;
    let data: Vec<u8> = (0..levels)
        .flat_map(|level| squares_level(SQUARES_SIDE >> level))
        .flat_map(|[r, g, b]| [r, g, b, 255])
        .collect();
    let mut image = Image {
        data: Some(data),
        asset_usage: RenderAssetUsages::RENDER_WORLD,
        ..default()
    };
    image.texture_descriptor.size = Extent3d {
        width: SQUARES_SIDE,
        height: SQUARES_SIDE,
        depth_or_array_layers: 1,
    };
    image.texture_descriptor.dimension = TextureDimension::D2;
    image.texture_descriptor.format = TextureFormat::Rgba8UnormSrgb;
    image.texture_descriptor.mip_level_count = levels;
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        anisotropy_clamp: 8,
        ..ImageSamplerDescriptor::linear()
    });
    image
}

/// So many texels along two squares: of less than a millimetre, smaller than any scene's pixel.
const SQUARES_SIDE: u32 = 1024;

/// Texels of a mip level, row by row.
fn squares_level(side: u32) -> Vec<[u8; 3]> {
    if side == 1 {
        let mean = encode_srgb(0.5 * (linear(LIGHT) + linear(DARK)));
        return vec![mean.to_array().map(|c| (255.0 * c).round() as u8)];
    }
    let is_second = |x: u32| 2 * x >= side;
    let texel = |x, y| {
        if is_second(x) == is_second(y) {
            LIGHT
        } else {
            DARK
        }
    };
    (0..side)
        .flat_map(|y| (0..side).map(move |x| texel(x, y)))
        .collect()
}

/// A parallelogram, seen from both sides by its order of corners.
fn quad(corner: Vec3, a: Vec3, b: Vec3, uv: impl Fn(Vec3) -> Vec2) -> Mesh {
    let corners = [corner, corner + a, corner + a + b, corner + b];
    let normal = if b.z > 0.0 { Vec3::Y } else { Vec3::Z };
    let facing = a.cross(b).dot(normal) > 0.0;
    let indices = if facing {
        [0, 1, 2, 0, 2, 3]
    } else {
        [0, 2, 1, 0, 3, 2]
    };
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_POSITION,
        corners.map(|c| c.to_array()).to_vec(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, vec![normal.to_array(); 4])
    .with_inserted_attribute(
        Mesh::ATTRIBUTE_UV_0,
        corners.map(|c| uv(c).to_array()).to_vec(),
    )
    .with_inserted_indices(Indices::U32(indices.to_vec()))
}
