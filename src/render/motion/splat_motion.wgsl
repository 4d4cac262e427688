// How far the nearest splat of each pixel has moved since the frame before.

#import bevy_fluid::render::frame::view
#import bevy_fluid::render::functions::{ndc_from_pixel, pixel_from_texture, view_from_device}
#import bevy_fluid::render::ellipsoid::{EllipsoidVertex, fluid, intersect, linear, place, splats}

struct GpuFluidMotion {
    // World from the fluid's space, less what it was in the frame before.
    change: mat4x4<f32>,
    // The same for ways in the world, from a splat's centre.
    about_center: mat3x3<f32>,
    // World from the fluid's space in the frame before, for ways.
    before: mat3x3<f32>,
    // How many particles have a displacement of their own, the first ones.
    displaced: u32,
}

// In the fluid's space, by particle.
@group(2) @binding(0) var<storage, read> displacements: array<vec4<f32>>;
@group(2) @binding(1) var<uniform> motion: GpuFluidMotion;

struct Output {
    // In view space.
    @location(0) displacement: vec4<f32>,
    @builtin(frag_depth) depth: f32,
}

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) splat_index: u32,
) -> EllipsoidVertex {
    var out = place(splat_index, corner);
    let splat = splats[splat_index];
    var own = vec3(0.0);
    if splat.particle < motion.displaced {
        own = displacements[splat.particle].xyz;
    }
    out.displacement = (motion.change * vec4(splat.center, 1.0)).xyz + motion.before * own;
    let local_linear = linear(fluid.world_from_local);
    out.from_eye = local_linear * splat.center + (fluid.world_from_local[3].xyz - view.world_position);
    return out;
}

@fragment
fn fragment(in: EllipsoidVertex) -> Output {
    let found = intersect(in);
    if !found.hit {
        discard;
    }
    let ndc = ndc_from_pixel(pixel_from_texture(in.position));
    let position = linear(view.world_from_view) * view_from_device(ndc, found.layers.x);
    let displacement = in.displacement + motion.about_center * (position - in.from_eye);
    return Output(
        vec4(linear(view.view_from_world) * displacement, 0.0),
        found.layers.x,
    );
}
