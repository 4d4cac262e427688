//! Formulae of the shaders, run one by one on the GPU and compared with f64.

use bevy::{
    math::DVec3,
    prelude::*,
    render::{
        RenderApp,
        render_resource::{
            BindGroupEntries, BindGroupLayoutDescriptor, BindGroupLayoutEntries,
            BufferInitDescriptor, BufferUsages, CachedComputePipelineId, CommandEncoderDescriptor,
            ComputePassDescriptor, ComputePipelineDescriptor, PipelineCache, ShaderStages,
            UniformBuffer,
            binding_types::{storage_buffer_read_only_sized, storage_buffer_sized, uniform_buffer},
        },
        renderer::{RenderDevice, RenderQueue},
    },
    shader::Shader,
};
use fluid_stage::{headless_app, read_buffer, settle};

use super::surface::GpuSurface;
use crate::{
    FluidPlugin,
    rain::{RainPlugin, births::diameter_of_birth},
};

/// Four numbers in and four out, as often as there are inputs.
struct Formula {
    app: App,
    pipeline: CachedComputePipelineId,
    layouts: [BindGroupLayoutDescriptor; 2],
}

impl Formula {
    /// `expression` is a `vec4<f32>` computed from `in` and the imports.
    fn new(imports: &str, expression: &str) -> Self {
        let source = format!(
            "#import bevy_fluid::{imports}
            @group(1) @binding(8) var<storage, read> inputs: array<vec4<f32>>;
            @group(1) @binding(9) var<storage, read_write> outputs: array<vec4<f32>>;
            @compute @workgroup_size(1)
            fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
                let in = inputs[id.x];
                outputs[id.x] = {expression};
            }}"
        );
        let mut app = headless_app(UVec2::splat(16), |app| {
            app.add_plugins((FluidPlugin::default(), RainPlugin::default()));
        })
        .unwrap();
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let shader = shaders.add(Shader::from_wgsl(source, "formula.wgsl"));
        settle(&mut app).unwrap();
        let layouts = [
            BindGroupLayoutDescriptor::new(
                "surface",
                &BindGroupLayoutEntries::with_indices(
                    ShaderStages::COMPUTE,
                    ((2, uniform_buffer::<GpuSurface>(false)),),
                ),
            ),
            BindGroupLayoutDescriptor::new(
                "numbers",
                &BindGroupLayoutEntries::with_indices(
                    ShaderStages::COMPUTE,
                    (
                        (8, storage_buffer_read_only_sized(false, None)),
                        (9, storage_buffer_sized(false, None)),
                    ),
                ),
            ),
        ];
        let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
        let pipeline = cache.queue_compute_pipeline(ComputePipelineDescriptor {
            label: Some("formula".into()),
            layout: layouts.to_vec(),
            shader,
            entry_point: Some("main".into()),
            ..default()
        });
        settle(&mut app).unwrap();
        Self {
            app,
            pipeline,
            layouts,
        }
    }

    fn run(&self, surface: GpuSurface, inputs: &[[f32; 4]]) -> Vec<[f32; 4]> {
        let world = self.app.sub_app(RenderApp).world();
        let cache = world.resource::<PipelineCache>();
        let (device, queue) = (
            world.resource::<RenderDevice>(),
            world.resource::<RenderQueue>(),
        );
        let buffer = |usage| {
            device.create_buffer_with_data(&BufferInitDescriptor {
                label: None,
                contents: bytemuck::cast_slice(inputs),
                usage,
            })
        };
        let input = buffer(BufferUsages::STORAGE);
        let output = buffer(BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let mut uniform = UniformBuffer::from(surface);
        uniform.write_buffer(device, queue);
        let [surface, numbers] = self
            .layouts
            .each_ref()
            .map(|l| cache.get_bind_group_layout(l));
        let surface = device.create_bind_group(
            None,
            &surface,
            &BindGroupEntries::with_indices(((2, uniform.binding().unwrap()),)),
        );
        let numbers = device.create_bind_group(
            None,
            &numbers,
            &BindGroupEntries::with_indices((
                (8, input.as_entire_binding()),
                (9, output.as_entire_binding()),
            )),
        );
        let mut encoder = device.create_command_encoder(&CommandEncoderDescriptor::default());
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
        pass.set_pipeline(cache.get_compute_pipeline(self.pipeline).unwrap());
        pass.set_bind_group(0, &surface, &[]);
        pass.set_bind_group(1, &numbers, &[]);
        pass.dispatch_workgroups(inputs.len() as u32, 1, 1);
        drop(pass);
        queue.submit([encoder.finish()]);
        bytemuck::cast_slice(&read_buffer(&self.app, &output).unwrap()).to_vec()
    }
}

#[test]
fn h29_an_interface_at_and_about_the_critical_angle() {
    let formula = Formula::new(
        "render::optics::meet",
        "vec4(meet(in.xyz, vec3(0.0, 0.0, 1.0), in.w).reflectance,
              meet(in.xyz, vec3(0.0, 0.0, 1.0), in.w).refracted)",
    );
    for index in [1.333_f64, 1.0001, 2.4, 5.0] {
        let critical = (1.0 / index).asin();
        let apart = [0.0, 1e-7, 1e-6, 1e-5, 1e-3, 0.1].map(|a| [a, -a]);
        let angles = apart.as_flattened().iter().map(|apart| critical + apart);
        let angles = angles
            .chain([0.0, 1.57])
            .filter(|a| (0.0..std::f64::consts::FRAC_PI_2).contains(a));
        let inputs: Vec<_> = angles
            .map(|angle| [angle.sin() as f32, 0.0, -angle.cos() as f32, index as f32])
            .collect();
        let outputs = formula.run(GpuSurface::default(), &inputs);
        for ([x, _, z, eta], [reflectance, rx, ry, rz]) in inputs.iter().zip(&outputs) {
            let (eta, ci) = (f64::from(*eta), f64::from(-z));
            let wanted = {
                let ct2 = 1.0 - eta * eta * (1.0 - ci * ci);
                let ct = ct2.max(0.0).sqrt();
                let s = (eta * ci - ct) / (eta * ci + ct);
                let p = (eta * ct - ci) / (eta * ct + ci);
                0.5 * (s * s + p * p)
            };
            // f32 resolves 1 − sin² to 1e-7, and the result depends on its root: 3e-4, times the
            // index squared over the cosine.
            let error = (f64::from(*reflectance) - wanted).abs();
            let allowed = 2e-6 + 4.0 * (3e-7 * eta * eta).sqrt() * eta / ci.max(1e-3);
            let critical = (1.0 - eta * eta * (1.0 - ci * ci)).abs() < 1e-4;
            assert!(
                error < if critical { allowed } else { 1e-4 },
                "index {index}, sine {x}: {reflectance}, not {wanted}"
            );
            assert!((0.0..=1.0).contains(reflectance));
            let length = vec3(*rx, *ry, *rz).length();
            let total = *reflectance == 1.0 && length == 0.0;
            assert!(
                total || (length - 1.0).abs() < 1e-5,
                "index {index}, sine {x}: {length}"
            );
        }
    }
}

#[test]
fn h34_h50_the_medium_equals_f64_on_the_gpu() {
    let formula = Formula::new(
        "render::frame::surface\n#import bevy_fluid::render::medium::transmitted",
        "vec4(transmitted(surface.extinction, in.x), 1.0)",
    );
    let distances = [0.0, 1e-6, 1e-3, 1.0, 1e6, f32::MAX, f32::INFINITY];
    let inputs = distances.map(|d| [d, 0.0, 0.0, 0.0]);
    for extinction in [[0.0, 1e-9, 1e-6], [1e-3, 1.0, 1e3], [1e30, 1e-30, 0.5]] {
        let surface = GpuSurface {
            extinction: extinction.into(),
            ..default()
        };
        for ([d, ..], left) in inputs.iter().zip(formula.run(surface, &inputs)) {
            for (b, left) in extinction.iter().zip(left) {
                // The path is clamped to 1e30 m: 0 · ∞ is NaN.
                let exact = (-f64::from(*b) * f64::from(*d).min(1e30)).exp();
                let error = (f64::from(left) - exact).abs();
                assert!(error < 1e-6, "B = {b}, d = {d}: {left}, not {exact}");
            }
        }
    }
}

#[test]
fn normals_survive_their_code_and_what_is_no_direction_is_z() {
    let formula = Formula::new(
        "render::functions::{decode_normal, encode_normal, unit_or_z}",
        "vec4(decode_normal(encode_normal(unit_or_z(in.xyz))), 1.0)",
    );
    let directions = [
        [1.0, 2.0, 3.0],
        [-1e-30, 2e-30, 1e-30],
        [3e30, -1e30, 0.0],
        [0.0, 0.0, -7.0],
        [0.0, 0.0, 0.0],
        [f32::NAN, 1.0, 0.0],
        [f32::INFINITY, 1.0, 0.0],
    ];
    let inputs = directions.map(|[x, y, z]| [x, y, z, 0.0]);
    for ([x, y, z], [gx, gy, gz, _]) in directions.iter().zip(formula.run(default(), &inputs)) {
        let length = DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)).length();
        let wanted = if length.is_finite() && length > 0.0 {
            DVec3::new(f64::from(*x), f64::from(*y), f64::from(*z)) / length
        } else {
            DVec3::Z
        };
        let got = vec3(gx, gy, gz).as_dvec3();
        assert!(got.distance(wanted) < 1e-5, "({x}, {y}, {z}): {got}");
    }
}

/// In thin rain and in the thickest, for common drops and for rare ones.
#[test]
fn drops_come_in_the_same_sizes_as_in_f64() {
    let formula = Formula::new(
        "rain::draw::births::diameter_of_birth",
        "vec4(diameter_of_birth(in.x, in.yzw))",
    );
    let inputs: Vec<[f32; 4]> = [0.0, 0.01, 30.0, 600.0, 2400.0, 6000.0]
        .into_iter()
        .flat_map(|drops| {
            [[0.5, 0.3, 0.9], [1e-4, 0.99, 0.01], [0.999, 0.0, 1.0]]
                .map(|[a, b, c]| [drops, a, b, c])
        })
        .collect();
    for (input, [found, ..]) in inputs.iter().zip(formula.run(default(), &inputs)) {
        let [drops, a, b, c] = input.map(f64::from);
        let wanted = diameter_of_birth(drops, [a, b, c]);
        assert!(
            (f64::from(found) / wanted - 1.0).abs() < 1e-4,
            "{input:?}: {found} mm, not {wanted}"
        );
    }
}
