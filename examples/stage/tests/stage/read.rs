//! What the GPU holds comes back exactly, or with the reason why it cannot.

use bevy::{
    prelude::*,
    render::{
        render_resource::{
            BufferInitDescriptor, BufferUsages, Extent3d, TextureDataOrder, TextureDescriptor,
            TextureDimension, TextureFormat, TextureUsages,
        },
        renderer::{RenderDevice, RenderQueue},
    },
};
use fluid_stage::{StageError, capture, headless_app, read_buffer, read_texture};

fn empty() -> App {
    headless_app(UVec2::new(16, 16), |_| {}).unwrap()
}

fn texture(app: &App, format: TextureFormat, usage: TextureUsages, data: &[u8]) -> wgpu::Texture {
    let (device, queue) = (
        app.world().resource::<RenderDevice>(),
        app.world().resource::<RenderQueue>(),
    );
    let descriptor = TextureDescriptor {
        label: Some("known"),
        size: Extent3d {
            width: 3,
            height: 2,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    };
    let texture =
        device.create_texture_with_data(queue, &descriptor, TextureDataOrder::LayerMajor, data);
    (*texture).clone()
}

#[test]
fn textures_and_buffers_are_read_exactly() {
    let app = empty();
    let numbers: Vec<u8> = (0..96).collect();
    for (format, bytes) in [
        (TextureFormat::Rgba8Unorm, 24),
        (TextureFormat::R32Float, 24),
        (TextureFormat::Rg32Float, 48),
        (TextureFormat::Rgba16Float, 48),
        (TextureFormat::Rgba32Float, 96),
        (TextureFormat::Rgba32Uint, 96),
    ] {
        let known = texture(&app, format, TextureUsages::COPY_SRC, &numbers[..bytes]);
        let data = read_texture(&app, &known).unwrap();
        assert_eq!(data.size, UVec2::new(3, 2));
        assert_eq!(data.bytes, numbers[..bytes], "{format:?}");
    }

    let floats: Vec<f32> = (0..12).map(|i| i as f32 / 4.0).collect();
    let known = texture(
        &app,
        TextureFormat::Rg32Float,
        TextureUsages::COPY_SRC,
        bytemuck::cast_slice(&floats),
    );
    let data = read_texture(&app, &known).unwrap();
    assert_eq!(data.f32x2(2, 1), [2.5, 2.75]);
    assert_eq!(data.texels::<[f32; 2]>().count(), 6);

    let halves: Vec<half::f16> = (0..24)
        .map(|i| half::f16::from_f32(i as f32 / 8.0))
        .collect();
    let known = texture(
        &app,
        TextureFormat::Rgba16Float,
        TextureUsages::COPY_SRC,
        &halves
            .iter()
            .flat_map(|half| half.to_le_bytes())
            .collect::<Vec<_>>(),
    );
    let data = read_texture(&app, &known).unwrap();
    assert_eq!(data.f16x4(0, 1), [1.5, 1.625, 1.75, 1.875]);

    let buffer = app
        .world()
        .resource::<RenderDevice>()
        .create_buffer_with_data(&BufferInitDescriptor {
            label: None,
            contents: &numbers,
            usage: BufferUsages::COPY_SRC,
        });
    assert_eq!(read_buffer(&app, &buffer).unwrap(), numbers);
}

#[test]
fn what_cannot_be_read_is_said() {
    let mut app = empty();
    let known = texture(
        &app,
        TextureFormat::R32Float,
        TextureUsages::TEXTURE_BINDING,
        &[0; 24],
    );
    let error = read_texture(&app, &known).unwrap_err().to_string();
    assert!(error.contains("COPY_SRC"), "{error}");
    assert!(matches!(capture(&mut app), Err(StageError::NotRendered)));
    assert!(matches!(
        headless_app(UVec2::new(100_000, 10), |_| {}),
        Err(StageError::Size(_))
    ));
}
