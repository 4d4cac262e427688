//! Motion vectors, read from where Bevy's effects read them.

use bevy::{
    core_pipeline::prepass::ViewPrepassTextures,
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            BindGroupEntries, BindGroupLayoutEntries, BufferDescriptor, BufferUsages,
            CommandEncoderDescriptor, ComputePassDescriptor, PipelineLayoutDescriptor,
            RawComputePipelineDescriptor, ShaderModuleDescriptor, ShaderSource, ShaderStages,
            TextureSampleType,
            binding_types::{storage_buffer_sized, texture_2d, texture_2d_multisampled},
        },
        renderer::{RenderDevice, RenderQueue},
    },
};
use fluid_stage::read_buffer;

/// Of every pixel, row by row. Unit: pixels. Multisampled: of the first sample.
pub(crate) fn motion_vectors(app: &App) -> Vec<Vec2> {
    let world = app.sub_app(RenderApp).world();
    let (device, queue) = (
        world.resource::<RenderDevice>(),
        world.resource::<RenderQueue>(),
    );
    let textures = world
        .iter_entities()
        .find_map(|entity| entity.get::<ViewPrepassTextures>())
        .expect("a view has prepass textures");
    let vectors = &textures.motion_vectors.as_ref().unwrap().texture;
    let size = uvec2(vectors.texture.width(), vectors.texture.height());
    let multisampled = vectors.texture.sample_count() > 1;

    let sampled = TextureSampleType::Float { filterable: false };
    let texture = if multisampled {
        texture_2d_multisampled(sampled)
    } else {
        texture_2d(sampled)
    };
    let layout = device.create_bind_group_layout(
        None,
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (texture, storage_buffer_sized(false, None)),
        ),
    );
    let kind = if multisampled { "multisampled_" } else { "" };
    let source = format!(
        "@group(0) @binding(0) var vectors: texture_{kind}2d<f32>;
        @group(0) @binding(1) var<storage, read_write> read: array<vec2<f32>>;
        @compute @workgroup_size(1)
        fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
            let size = textureDimensions(vectors);
            let vector = textureLoad(vectors, vec2<i32>(id.xy), 0).xy;
            read[id.y * size.x + id.x] = vector * vec2<f32>(size);
        }}"
    );
    let module = device.create_and_validate_shader_module(ShaderModuleDescriptor {
        label: None,
        source: ShaderSource::Wgsl(source.into()),
    });
    let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&RawComputePipelineDescriptor {
        label: None,
        layout: Some(&pipeline_layout),
        module: &module,
        entry_point: Some("main"),
        compilation_options: default(),
        cache: None,
    });
    let buffer = device.create_buffer(&BufferDescriptor {
        label: None,
        size: u64::from(size.x * size.y) * size_of::<Vec2>() as u64,
        usage: BufferUsages::STORAGE | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let group = device.create_bind_group(
        None,
        &layout,
        &BindGroupEntries::sequential((&vectors.default_view, buffer.as_entire_binding())),
    );
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(size.x, size.y, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    let bytes = read_buffer(app, &buffer).unwrap();
    let read: &[[f32; 2]] = bytemuck::cast_slice(&bytes);
    read.iter().copied().map(Vec2::from).collect()
}
