//! Textures that passes draw to, and how much memory they take.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

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

use super::{Gpu, Input, pipelines::NO_LAYERS, support::LAYER_FORMAT};

/// The memory of all textures that passes of fluids draw to, of all cameras.
#[derive(Resource, Clone, Debug, Default)]
pub struct TextureMemory(Arc<AtomicU64>);

impl TextureMemory {
    /// The sum in this moment.
    pub fn bytes(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

/// A part of the memory, until it is dropped.
#[derive(Debug)]
struct Share {
    bytes: u64,
    memory: TextureMemory,
}

impl Drop for Share {
    fn drop(&mut self) {
        self.memory.0.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// A texture that a pass draws to.
#[derive(Debug)]
pub(crate) struct Target {
    pub(crate) texture: Texture,
    pub(crate) view: TextureView,
    _share: Option<Share>,
}

impl Target {
    fn new(
        gpu: &Gpu,
        label: &'static str,
        size: UVec2,
        (format, usage): (TextureFormat, TextureUsages),
    ) -> Self {
        let texture = gpu.device.create_texture(&TextureDescriptor {
            label: Some(label),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        // Of all formats in use; depth is as large as a float.
        let texel = format.block_copy_size(None).unwrap_or(4);
        let bytes = u64::from(size.x) * u64::from(size.y) * u64::from(texel);
        let memory = gpu.memory.clone();
        memory.0.fetch_add(bytes, Ordering::Relaxed);
        Self {
            view: texture.create_view(&TextureViewDescriptor::default()),
            texture,
            _share: Some(Share { bytes, memory }),
        }
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
    gpu: &Gpu,
    label: &'static str,
    size: UVec2,
    format: TextureFormat,
) {
    ensure_for(target, wanted, gpu, label, size, (format, TARGET));
}

/// The usages of a target.
pub(super) const TARGET: TextureUsages = TextureUsages::RENDER_ATTACHMENT
    .union(TextureUsages::TEXTURE_BINDING)
    .union(TextureUsages::COPY_SRC)
    .union(TextureUsages::COPY_DST);

/// Keeps a target of a size and for given usages while it is wanted.
pub(super) fn ensure_for(
    target: &mut Option<Target>,
    wanted: bool,
    gpu: &Gpu,
    label: &'static str,
    size: UVec2,
    texels: (TextureFormat, TextureUsages),
) {
    if !wanted {
        *target = None;
        return;
    }
    let fits = |Target { texture, .. }: &Target| {
        texture.size() == extent(size) && (texture.format(), texture.usage()) == texels
    };
    if !target.as_ref().is_some_and(fits) {
        // The old one is freed before.
        *target = None;
        *target = Some(Target::new(gpu, label, size, texels));
    }
}

/// One texel of "nothing here", for textures that a surface lacks.
#[derive(Resource)]
pub(crate) struct Placeholder(Target);

impl Placeholder {
    /// A texture, or "nothing here" where the surface lacks it.
    pub(crate) fn or<'a>(&'a self, target: &'a Option<Target>) -> Input<'a> {
        Input::texture(Some(target.as_ref().unwrap_or(&self.0)))
    }
}

pub(super) fn init_placeholder(
    mut commands: Commands,
    device: Res<RenderDevice>,
    queue: Res<RenderQueue>,
) {
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
        bytemuck::cast_slice(&NO_LAYERS[..2]),
    );
    commands.insert_resource(Placeholder(Target {
        view: texture.create_view(&TextureViewDescriptor::default()),
        texture,
        _share: None,
    }));
}
