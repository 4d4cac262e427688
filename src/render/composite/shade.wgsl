// The light of each pixel of liquid: its own, and that of the background at the end of its ray.

#import bevy_fluid::render::background::{background, color_at, light_through}
#import bevy_fluid::render::functions::{
    decode_normal, pixel_from_ndc, pixel_from_texture, view_from_device,
}

// Radiance, and the transmitted fraction of red.
@group(1) @binding(0) var radiance: texture_2d<f32>;
// The transmitted fractions of green and blue.
@group(1) @binding(1) var transmission: texture_2d<f32>;
@group(1) @binding(2) var exits: texture_2d<u32>;
@group(1) @binding(3) var bulk_layers: texture_2d<f32>;
@group(1) @binding(4) var spray_layers: texture_2d<f32>;

const THERE: u32 = 0x80000000u;
const DIRECT: u32 = 0x80000u;

// The light at the end of an exit ray.
fn behind_exit(pixel: vec2<f32>, exit: vec4<u32>) -> vec4<f32> {
    let uv = unpack2x16unorm(exit.x);
    let ndc = uv * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
    if (exit.w & DIRECT) != 0u {
        return color_at(pixel_from_ndc(ndc));
    }
    let start = view_from_device(ndc, bitcast<f32>(exit.y));
    let direction = decode_normal(unpack2x16snorm(exit.z));
    // Beyond the screen it is clamped to the border.
    let is_on_screen = all(uv > vec2(0.0)) && all(uv < vec2(1.0));
    return background(pixel, start, direction, is_on_screen);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = pixel_from_texture(position);
    let texel = vec2<i32>(position.xy);
    let exit = textureLoad(exits, texel, 0);
    if (exit.w & THERE) == 0u {
        discard;
    }
    let front = max(
        textureLoad(bulk_layers, texel, 0).x, textureLoad(spray_layers, texel, 0).x,
    );
    let own = textureLoad(radiance, texel, 0);
    let transmitted = vec3(own.a, textureLoad(transmission, texel, 0).rg);
    return light_through(pixel, front, own.rgb, transmitted, behind_exit(pixel, exit));
}
