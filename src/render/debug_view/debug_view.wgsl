// Intermediate results in place of the liquid.

#import bevy_fluid::render::functions::{
    decode_normal, depth_map, has_back, has_front, ndc_from_pixel, pixel_from_camera,
    texel_at, view_depth,
}
#import bevy_fluid::render::straight::layered_length

@group(1) @binding(0) var bulk_layers: texture_2d<f32>;
@group(1) @binding(1) var bulk_normals: texture_2d<f32>;
@group(1) @binding(2) var spray_layers: texture_2d<f32>;
@group(1) @binding(3) var spray_normals: texture_2d<f32>;
@group(1) @binding(4) var exits: texture_2d<u32>;
// Nearest and farthest view depth of the surface.
@group(1) @binding(5) var<uniform> depth_range: vec4<f32>;
// The number of splats, or the accumulated path length through them.
@group(1) @binding(6) var amounts: texture_2d<f32>;

const DIRECT: u32 = 0x80000u;

fn shade(there: bool, d: f32, position: vec2<f32>) -> vec3<f32> {
    if !there {
        discard;
    }
    let z = view_depth(depth_map(ndc_from_pixel(position)), d);
    return vec3(mix(1.0, 0.08, clamp((z - depth_range.x) / (depth_range.y - depth_range.x), 0.0, 1.0)));
}

// One colour per number of interfaces, or per search status.
fn palette(i: u32) -> vec3<f32> {
    switch i {
        case 1u: { return vec3(0.05, 0.15, 0.8); }
        case 2u: { return vec3(0.05, 0.6, 0.1); }
        case 3u: { return vec3(0.9, 0.75, 0.05); }
        case 4u: { return vec3(0.85, 0.1, 0.05); }
        case 5u: { return vec3(0.7, 0.1, 0.8); }
        case 6u: { return vec3(0.9, 0.4, 0.0); }
        case 7u: { return vec3(0.3, 0.3, 0.3); }
        default: { return vec3(0.0); }
    }
}

// From nothing to all: black, violet, red, orange, white.
fn heat(amount: f32) -> vec3<f32> {
    let t = 4.0 * clamp(amount, 0.0, 1.0);
    var color = mix(vec3(0.0), vec3(0.18, 0.02, 0.35), min(t, 1.0));
    color = mix(color, vec3(0.7, 0.03, 0.12), clamp(t - 1.0, 0.0, 1.0));
    color = mix(color, vec3(0.95, 0.45, 0.02), clamp(t - 2.0, 0.0, 1.0));
    return mix(color, vec3(1.0), clamp(t - 3.0, 0.0, 1.0));
}

// The straight path length through the liquid, as a fraction of the surface's depth.
fn relative_thickness(bulk: vec2<f32>, spray: vec2<f32>, position: vec2<f32>) -> f32 {
    let pixel = vec2<i32>(position);
#ifdef ACCUMULATED
    let length = textureLoad(amounts, texel_at(pixel), 0).x;
#else
    // A front without a back: nothing is seen through it.
    if (has_front(bulk) && !has_back(bulk)) || (has_front(spray) && !has_back(spray)) {
        return 1.0;
    }
    let length = layered_length(bulk, spray, pixel, ndc_from_pixel(position));
#endif
    return length / (depth_range.y - depth_range.x);
}

// The worst status of a ray's searches.
fn worst(status: u32) -> u32 {
    var out = 0u;
    for (var i = 0u; i < 4u; i += 1u) {
        let s = (status >> (4u * i)) & 15u;
        // A hit is no failure, and neither is meeting an opaque surface.
        if (s > 1u && s < 7u) || out <= 1u {
            out = max(out, s);
        }
    }
    return out;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = pixel_from_camera(position);
    let texel = texel_at(vec2<i32>(at));
    let bulk = textureLoad(bulk_layers, texel, 0).xy;
    let spray = textureLoad(spray_layers, texel, 0).xy;
    let exit = textureLoad(exits, texel, 0);
    let there = (exit.w >> 31u) == 1u;
    var color = vec3(0.0);
#ifdef BULK_FRONT
    color = shade(has_front(bulk), bulk.x, at);
#endif
#ifdef BULK_BACK
    color = shade(has_back(bulk), -bulk.y, at);
#endif
#ifdef SPRAY_FRONT
    color = shade(has_front(spray), spray.x, at);
#endif
#ifdef SPRAY_BACK
    color = shade(has_back(spray), -spray.y, at);
#endif
#ifdef NORMALS
    if !there { discard; }
    let encoded = select(
        textureLoad(spray_normals, texel, 0),
        textureLoad(bulk_normals, texel, 0),
        bulk.x >= spray.x,
    );
    color = 0.5 + 0.5 * decode_normal(encoded.xy);
#endif
#ifdef INTERFACES
    if !there { discard; }
    color = palette((exit.w >> 16u) & 7u);
#endif
#ifdef STATUS
    if !there { discard; }
    // A hit is shown green.
    let status = worst(exit.w & 0xffffu);
    color = palette(select(status, 2u, status == 1u));
    if status == 2u {
        color = palette(1u);
    }
#endif
#ifdef CLASSES
    if !there { discard; }
    color = select(vec3(0.9, 0.35, 0.03), vec3(0.03, 0.25, 0.8), bulk.x >= spray.x);
#endif
#ifdef THICKNESS
    if !there { discard; }
    color = heat(relative_thickness(bulk, spray, at));
#endif
#ifdef EXIT_RAY
    if !there { discard; }
    let direction = 0.5 + 0.5 * decode_normal(unpack2x16snorm(exit.z));
    color = direction * select(1.0, 0.5, (exit.w & DIRECT) != 0u);
#endif
#ifdef OVERDRAW
    let count = textureLoad(amounts, texel, 0).x;
    if count < 0.5 { discard; }
    // 1, 4, 16 and 64 are a quarter, a half, three quarters and all.
    color = heat(0.25 + log2(count) / 8.0);
#endif
    return vec4(color, 1.0);
}
