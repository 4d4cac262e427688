//! A chequered floor: straight lines and a regular pattern show every bend of a refraction.

use bevy::{
    asset::RenderAssetUsages,
    image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    math::Affine2,
    prelude::*,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};

use super::Scenery;

const LIGHT: Color = Color::srgb(0.86, 0.83, 0.78);
const DARK: Color = Color::srgb(0.36, 0.38, 0.42);
/// Texels along a tile. As many as this keep its edges crisp from close by.
const TILE: u32 = 128;

impl Scenery<'_, '_> {
    /// A square floor around `center` with sides of `2 * half_size`, `tiles` tiles along each.
    pub fn checker_floor(&mut self, center: Vec3, half_size: f32, tiles: u32) -> Entity {
        let texture = self.images.add(checker());
        let material = self.materials.add(StandardMaterial {
            base_color_texture: Some(texture),
            // The texture holds two tiles in each direction.
            uv_transform: Affine2::from_scale(Vec2::splat(tiles as f32 / 2.0)),
            perceptual_roughness: 0.75,
            reflectance: 0.3,
            ..default()
        });
        let plane = Plane3d::new(Vec3::Y, Vec2::splat(half_size));
        self.commands
            .spawn((
                Name::new("floor"),
                Mesh3d(self.meshes.add(plane)),
                MeshMaterial3d(material),
                Transform::from_translation(center),
            ))
            .id()
    }
}

/// Two by two tiles with all mip levels. Each level is the same pattern with fewer texels, exact
/// down to one texel a tile; the last is their mean.
fn checker() -> Image {
    let side = 2 * TILE;
    let mip_level_count = side.ilog2() + 1;
    let (light, dark) = (LIGHT.to_srgba(), DARK.to_srgba());
    // Bytes are sRGB, but light adds up linearly.
    let mean = Srgba::from((LIGHT.to_linear() + DARK.to_linear()) * 0.5);
    let mut data = Vec::new();
    for level in 0..mip_level_count {
        let side = side >> level;
        for texel in 0..side * side {
            let (x, y) = (texel % side, texel / side);
            let tile = match side {
                1 => mean,
                _ if (2 * x / side + 2 * y / side).is_multiple_of(2) => light,
                _ => dark,
            };
            data.extend(tile.to_u8_array());
        }
    }

    let mut image = Image::new_uninit(
        Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.mip_level_count = mip_level_count;
    image.data = Some(data);
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        mipmap_filter: ImageFilterMode::Linear,
        anisotropy_clamp: 16,
        ..default()
    });
    image
}
