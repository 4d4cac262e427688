//! The WGSL twin of the closed form, run over numbers.

use bevy::{
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
            BufferInitDescriptor, BufferUsages, CachedPipelineState, CommandEncoderDescriptor,
            ComputePassDescriptor, ComputePipelineDescriptor, PipelineCache, ShaderStages,
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized},
        },
        renderer::{RenderDevice, RenderQueue},
    },
};
use bevy_fluid::prelude::FluidPlugin;
use fluid_stage::{headless_app, read_buffer, settle};

const SHADER: &str = "
#import bevy_fluid::render::medium::{reflected, transmitted}

// Extinction and length in, what is left and what is sent by a source of 1 out.
@group(0) @binding(0) var<storage, read> paths: array<vec2<f32>>;
@group(0) @binding(1) var<storage, read_write> results: array<vec2<f32>>;

@compute @workgroup_size(64)
fn measure(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&paths) {
        let path = paths[id.x];
        results[id.x] = vec2(
            transmitted(vec3(path.x), path.y).x,
            reflected(vec3(1.0), vec3(path.x), path.y).x,
        );
    }
}
";

/// What is left and what a source of 1 sends, for each (extinction, length).
pub(crate) fn measure(paths: &[[f32; 2]]) -> Vec<[f32; 2]> {
    let mut app = headless_app(UVec2::splat(16), |app| {
        app.add_plugins(FluidPlugin::default());
    })
    .unwrap();
    let shader = app
        .world_mut()
        .resource_mut::<Assets<Shader>>()
        .add(Shader::from_wgsl(SHADER, "measure.wgsl"));
    settle(&mut app).unwrap();

    let layout = BindGroupLayoutDescriptor::new(
        "measure",
        &BindGroupLayoutEntries::sequential(
            ShaderStages::COMPUTE,
            (
                storage_buffer_read_only_sized(false, None),
                storage_buffer_sized(false, None),
            ),
        ),
    );
    let render = app.sub_app(RenderApp).world();
    let id = render
        .resource::<PipelineCache>()
        .queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some("measure".into()),
            layout: vec![layout.clone()],
            shader,
            entry_point: Some("measure".into()),
            ..default()
        });
    settle(&mut app).unwrap();

    let render = app.sub_app(RenderApp).world();
    let cache = render.resource::<PipelineCache>();
    let state = cache.get_compute_pipeline_state(id);
    let Some(pipeline) = cache.get_compute_pipeline(id) else {
        panic!("{:?}", matches!(state, CachedPipelineState::Ok(_)));
    };
    let (device, queue) = (
        render.resource::<RenderDevice>(),
        render.resource::<RenderQueue>(),
    );
    let buffer = |usage| {
        device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some("measure"),
            contents: bytemuck::cast_slice(paths),
            usage,
        })
    };
    let input = buffer(BufferUsages::STORAGE);
    let output = buffer(BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let group = device.create_bind_group(
        "measure",
        &cache.get_bind_group_layout(&layout),
        &BindGroupEntries::sequential((input.as_entire_binding(), output.as_entire_binding())),
    );
    let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
    pass.set_pipeline(pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(paths.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);
    bytemuck::cast_slice(&read_buffer(&app, &output).unwrap()).to_vec()
}
