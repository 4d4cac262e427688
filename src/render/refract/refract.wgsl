// Traces each pixel's ray.

#import bevy_fluid::render::functions::{
    device_from_view, encode_normal, farthest_scene_depth, pixel_from_texture,
}
#import bevy_fluid::render::refract::layers::{BULK, FRONT, SPRAY, load_layers, load_normal}
#import bevy_fluid::render::refract::search::evaluations
#import bevy_fluid::render::refract::trace::{Path, trace_from}

const MAX_HALF: f32 = 65504.0;

struct Output {
    // The liquid's own radiance (reflections, highlights, in-scattered light, emission), and the
    // transmitted fraction of the background's red light.
    @location(0) radiance: vec4<f32>,
    // The transmitted fractions of green and blue.
    @location(1) transmission: vec2<f32>,
    // Where to look for the background: see `pack_exit`.
    @location(2) exit: vec4<u32>,
}

// (screen position, device depth, direction, flags): position as two 16-bit fractions of the
// viewport, direction octahedral in view space. Flags: bits 0–15 search statuses, 16–18
// interfaces met, 19 direct, 20 first kind, 21–28 evaluations, 31 there is liquid.
fn pack_exit(path: Path) -> vec4<u32> {
    let device = device_from_view(path.position);
    let uv = clamp(device.xy * vec2(0.5, -0.5) + 0.5, vec2(0.0), vec2(1.0));
    let flags = path.status | (path.interfaces << 16u) | (select(0u, 1u, path.direct) << 19u)
        | (path.first_kind << 20u) | (min(evaluations, 255u) << 21u) | (1u << 31u);
    return vec4(
        pack2x16unorm(uv),
        bitcast<u32>(device.z),
        pack2x16snorm(encode_normal(path.direction)),
        flags,
    );
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    let at = pixel_from_texture(position);
    let pixel = vec2<i32>(at);
    let bulk = load_layers(BULK, pixel);
    let spray = load_layers(SPRAY, pixel);
    let front = max(bulk.x, spray.x);
    if front <= 0.0 || front < farthest_scene_depth(pixel) {
        discard;
    }
    let kind = select(SPRAY, BULK, bulk.x >= spray.x);
    let path = trace_from(at, kind, front, load_normal(kind, FRONT, pixel));

    var out: Output;
    // The sun in a smooth surface is brighter than f16 can represent.
    out.radiance = vec4(min(path.radiance, vec3(MAX_HALF)), path.transmission.r);
    out.transmission = path.transmission.gb;
    out.exit = pack_exit(path);
    return out;
}
