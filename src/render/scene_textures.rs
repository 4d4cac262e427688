//! Textures of a view that its bodies share, and placeholders for textures that a body lacks.

use bevy::{
    prelude::*,
    render::{
        render_resource::{
            AddressMode, Extent3d, FilterMode, Sampler, SamplerDescriptor, TextureDataOrder,
            TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
            TextureViewDescriptor,
        },
        renderer::{RenderDevice, RenderQueue},
        texture::{CachedTexture, TextureCache},
    },
};

use super::support::LAYER_FORMAT;

/// Placeholders.
#[derive(Resource)]
pub(crate) struct Placeholders {
    /// One pixel of "nothing here".
    pub(crate) layers: CachedTexture,
    /// Linear filtering, clamped at the border.
    pub(crate) linear: Sampler,
}

pub(crate) fn init_placeholders(
    mut commands: Commands,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let nothing = [0.0f32, -2.0];
    let texture = device.create_texture_with_data(
        &queue,
        &TextureDescriptor {
            label: Some("fluid_no_layers"),
            size: Extent3d {
                width: 1,
                height: 1,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: LAYER_FORMAT,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC,
            view_formats: &[],
        },
        TextureDataOrder::default(),
        bytemuck::cast_slice(&nothing),
    );
    let default_view = texture.create_view(&TextureViewDescriptor::default());
    commands.insert_resource(Placeholders {
        layers: CachedTexture {
            texture,
            default_view,
        },
        linear: device.create_sampler(&SamplerDescriptor {
            label: Some("fluid_sampler"),
            address_mode_u: AddressMode::ClampToEdge,
            address_mode_v: AddressMode::ClampToEdge,
            mag_filter: FilterMode::Linear,
            min_filter: FilterMode::Linear,
            ..default()
        }),
    });
}

/// A texture as large as a view's target, to be drawn or copied to.
pub(crate) fn view_texture(
    textures: &mut TextureCache,
    device: &RenderDevice,
    label: &'static str,
    size: UVec2,
    format: TextureFormat,
) -> CachedTexture {
    textures.get(
        device,
        TextureDescriptor {
            label: Some(label),
            size: Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC
                | TextureUsages::COPY_DST,
            view_formats: &[],
        },
    )
}
