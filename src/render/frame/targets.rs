//! Textures that passes draw to.

use bevy::{
    prelude::*,
    render::{
        render_resource::{
            Extent3d, Texture, TextureDataOrder, TextureDescriptor, TextureDimension,
            TextureFormat, TextureUsages, TextureView, TextureViewDescriptor,
        },
        renderer::{RenderDevice, RenderQueue},
    },
};

use super::support::LAYER_FORMAT;

/// A texture that a pass draws to.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    pub(crate) texture: Texture,
    pub(crate) view: TextureView,
}

impl Target {
    fn new(device: &RenderDevice, label: &'static str, size: UVec2, format: TextureFormat) -> Self {
        let texture = device.create_texture(&TextureDescriptor {
            label: Some(label),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC
                | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self::of(texture)
    }

    fn of(texture: Texture) -> Self {
        let view = texture.create_view(&TextureViewDescriptor::default());
        Self { texture, view }
    }

    /// Its memory.
    pub(crate) fn bytes(&self) -> u64 {
        let texel = self.texture.format().block_copy_size(None).unwrap_or(4);
        u64::from(self.texture.width()) * u64::from(self.texture.height()) * u64::from(texel)
    }
}

fn extent(size: UVec2) -> Extent3d {
    Extent3d {
        width: size.x,
        height: size.y,
        depth_or_array_layers: 1,
    }
}

/// Keeps a target of a size while it is wanted.
pub(crate) fn ensure(
    target: &mut Option<Target>,
    wanted: bool,
    device: &RenderDevice,
    label: &'static str,
    size: UVec2,
    format: TextureFormat,
) {
    if !wanted {
        *target = None;
        return;
    }
    let fits = |it: &Target| it.texture.size() == extent(size) && it.texture.format() == format;
    if !target.as_ref().is_some_and(fits) {
        // The old one is freed before.
        *target = None;
        *target = Some(Target::new(device, label, size, format));
    }
}

/// One texel of "nothing here", for textures that a surface lacks.
#[derive(Resource)]
pub(crate) struct Placeholder(pub(crate) Target);

pub(super) fn init_placeholder(
    mut commands: Commands,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
    let nothing = [0.0f32, -2.0];
    let texture = device.create_texture_with_data(
        &queue,
        &TextureDescriptor {
            label: Some("fluid_no_layers"),
            size: extent(UVec2::ONE),
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
    commands.insert_resource(Placeholder(Target::of(texture)));
}
