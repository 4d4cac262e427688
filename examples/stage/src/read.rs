//! Exact readback of textures and buffers from the GPU.

use std::sync::mpsc;

use crate::{StageError, TextureData};
use bevy::{
    app::App,
    math::UVec2,
    render::{
        render_resource::{
            BufferDescriptor, BufferUsages, CommandEncoder, CommandEncoderDescriptor, Extent3d,
            MapMode, Origin3d, PollType, TexelCopyBufferInfo, TexelCopyBufferLayout,
            TexelCopyTextureInfo, TextureAspect, TextureUsages,
        },
        renderer::{RenderDevice, RenderQueue},
    },
};

/// Reads the first layer of the first mip level.
///
/// Supports any uncompressed format with one aspect: colours of 8 to 32 bits, integers,
/// `Depth32Float`. The texture needs `COPY_SRC` and a single sample. Textures of the render world
/// are reused from frame to frame (`TextureCache`): read them before the next update.
pub fn read_texture(app: &App, texture: &wgpu::Texture) -> Result<TextureData, StageError> {
    read_subresource(app, texture, 0, 0)
}

/// Reads one layer (a face of a cube, a slice of a volume) of one mip level; otherwise as
/// [`read_texture`].
pub fn read_subresource(
    app: &App,
    texture: &wgpu::Texture,
    mip_level: u32,
    layer: u32,
) -> Result<TextureData, StageError> {
    let format = texture.format();
    let unreadable = |reason| StageError::Unreadable {
        format,
        samples: texture.sample_count(),
        reason,
    };
    if !texture.usage().contains(TextureUsages::COPY_SRC) {
        return Err(unreadable("its usages lack COPY_SRC"));
    }
    if texture.sample_count() > 1 {
        return Err(unreadable("multisampled textures cannot be copied"));
    }
    if format.block_dimensions() != (1, 1) {
        return Err(unreadable("it is compressed"));
    }
    if mip_level >= texture.mip_level_count() || layer >= texture.depth_or_array_layers() {
        return Err(unreadable("it has no such layer or mip level"));
    }
    let texel_bytes = format
        .block_copy_size(None)
        .ok_or_else(|| unreadable("its aspects cannot be copied at once"))?
        as usize;

    let size =
        UVec2::new(texture.width() >> mip_level, texture.height() >> mip_level).max(UVec2::ONE);
    let row = size.x as usize * texel_bytes;
    // wgpu copies rows to multiples of 256 bytes only.
    let padded_row = RenderDevice::align_copy_bytes_per_row(row);
    let padded = download(app, padded_row * size.y as usize, |encoder, buffer| {
        encoder.copy_texture_to_buffer(
            TexelCopyTextureInfo {
                texture,
                mip_level,
                origin: Origin3d {
                    x: 0,
                    y: 0,
                    z: layer,
                },
                aspect: TextureAspect::All,
            },
            TexelCopyBufferInfo {
                buffer,
                layout: TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row as u32),
                    rows_per_image: None,
                },
            },
            Extent3d {
                width: size.x,
                height: size.y,
                depth_or_array_layers: 1,
            },
        );
    })?;
    let bytes = padded
        .chunks_exact(padded_row)
        .flat_map(|padded| &padded[..row])
        .copied()
        .collect();
    Ok(TextureData {
        size,
        format,
        bytes,
    })
}

/// Reads a whole buffer; it needs `COPY_SRC`.
pub fn read_buffer(app: &App, buffer: &wgpu::Buffer) -> Result<Vec<u8>, StageError> {
    if !buffer.usage().contains(BufferUsages::COPY_SRC) {
        return Err(StageError::UnreadableBuffer(format!(
            "{:?}",
            buffer.usage()
        )));
    }
    download(app, buffer.size() as usize, |encoder, target| {
        encoder.copy_buffer_to_buffer(buffer, 0, target, 0, buffer.size());
    })
}

/// Lets `copy` fill a buffer of `bytes` bytes and waits until it can be read.
fn download(
    app: &App,
    bytes: usize,
    copy: impl FnOnce(&mut CommandEncoder, &wgpu::Buffer),
) -> Result<Vec<u8>, StageError> {
    let world = app.world();
    let (Some(device), Some(queue)) = (
        world.get_resource::<RenderDevice>(),
        world.get_resource::<RenderQueue>(),
    ) else {
        return Err(StageError::NotRendered);
    };
    let buffer = device.create_buffer(&BufferDescriptor {
        label: Some("stage_read"),
        size: bytes as u64,
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor {
        label: Some("stage_read"),
    });
    copy(&mut encoder, &buffer);
    queue.submit([encoder.finish()]);

    let (sender, receiver) = mpsc::channel();
    let slice = buffer.slice(..);
    slice.map_async(MapMode::Read, move |result| {
        // The receiver is gone only where the poll below has failed already.
        let _ = sender.send(result);
    });
    let failed = |error: &dyn std::error::Error| StageError::Map(error.to_string());
    device
        .poll(PollType::wait_indefinitely())
        .map_err(|error| failed(&error))?;
    receiver
        .recv()
        .map_err(|error| failed(&error))?
        .map_err(|error| failed(&error))?;
    Ok(slice.get_mapped_range().to_vec())
}
