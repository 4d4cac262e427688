// Intermediate results in place of the liquid.

#import bevy_fluid::render::bindings::view
#import bevy_fluid::render::functions::{
    decode_normal, depth_map, has_back, has_front, ndc_from_pixel, view_depth,
}

@group(1) @binding(0) var bulk_layers: texture_2d<f32>;
@group(1) @binding(1) var bulk_normals: texture_2d<f32>;
@group(1) @binding(2) var spray_layers: texture_2d<f32>;
@group(1) @binding(3) var spray_normals: texture_2d<f32>;
@group(1) @binding(4) var exits: texture_2d<u32>;
// Nearest and farthest view depth of the body.
@group(1) @binding(5) var<uniform> depth_range: vec4<f32>;

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

// The least fortunate of a ray's searches.
fn worst(status: u32) -> u32 {
    var out = 0u;
    for (var i = 0u; i < 4u; i += 1u) {
        let s = (status >> (4u * i)) & 15u;
        // A hit is no news, and an opaque surface met is none either.
        if (s > 1u && s < 7u) || out <= 1u {
            out = max(out, s);
        }
    }
    return out;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let bulk = textureLoad(bulk_layers, pixel, 0).xy;
    let spray = textureLoad(spray_layers, pixel, 0).xy;
    let exit = textureLoad(exits, pixel, 0);
    let there = (exit.w >> 31u) == 1u;
    var color = vec3(0.0);
#ifdef BULK_FRONT
    color = shade(has_front(bulk), bulk.x, position.xy);
#endif
#ifdef BULK_BACK
    color = shade(has_back(bulk), -bulk.y, position.xy);
#endif
#ifdef SPRAY_FRONT
    color = shade(has_front(spray), spray.x, position.xy);
#endif
#ifdef SPRAY_BACK
    color = shade(has_back(spray), -spray.y, position.xy);
#endif
#ifdef NORMALS
    if !there { discard; }
    let encoded = select(
        textureLoad(spray_normals, pixel, 0),
        textureLoad(bulk_normals, pixel, 0),
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
    return vec4(color, 1.0);
}
