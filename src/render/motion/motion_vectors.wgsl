// Motion vectors of the liquid as Bevy's prepass writes them: the way on screen since the frame before,
// as a fraction of the view, y down.

#import bevy_fluid::render::functions::{
    has_front, ndc_from_pixel, pixel_from_camera, texel_at, view_from_device,
}
#import bevy_fluid::render::types::INSIDE_FRONT

struct GpuMotion {
    // Without jitter, which is no motion.
    clip_from_view: mat4x4<f32>,
    // From this frame's view space to the screen of the frame before.
    clip_from_view_before: mat4x4<f32>,
}

@group(1) @binding(0) var<uniform> motion: GpuMotion;
// How far the nearest splat has moved, in view space.
@group(1) @binding(1) var displacements: texture_2d<f32>;
@group(1) @binding(2) var bulk_layers: texture_2d<f32>;
@group(1) @binding(3) var spray_layers: texture_2d<f32>;

struct Output {
    @location(0) motion: vec2<f32>,
    // Tested for equality with what the composite has written.
    @builtin(frag_depth) depth: f32,
}

fn front_at(texel: vec2<i32>) -> f32 {
    return max(textureLoad(bulk_layers, texel, 0).x, textureLoad(spray_layers, texel, 0).x);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    let pixel = vec2<i32>(pixel_from_camera(position));
    var texel = texel_at(pixel);
    var depth = front_at(texel);
    if !has_front(vec2(depth, 0.0)) {
        // Mostly covered, but not in its middle: the composite takes the nearest neighbour's depth.
        for (var k = 0; k < 9; k += 1) {
            let beside = texel_at(pixel + vec2(k % 3, k / 3) - 1);
            let front = front_at(beside);
            if front > depth {
                depth = front;
                texel = beside;
            }
        }
    }
    if !has_front(vec2(depth, 0.0)) {
        discard;
    }
    let bulk = textureLoad(bulk_layers, texel, 0).xy;
    let spray = textureLoad(spray_layers, texel, 0).xy;
    if depth >= INSIDE_FRONT {
        // The eye is in the liquid, and sees its far surface.
        depth = -select(spray, bulk, bulk.x >= INSIDE_FRONT).y;
    }
    let now = view_from_device(ndc_from_pixel(vec2<f32>(pixel) + 0.5), depth);
    let before = now - textureLoad(displacements, texel, 0).xyz;
    let clip = motion.clip_from_view * vec4(now, 1.0);
    let clip_before = motion.clip_from_view_before * vec4(before, 1.0);
    // What was behind the eye was off screen.
    let way = clip.xy / clip.w - clip_before.xy / max(clip_before.w, 1e-6);
    return Output(clamp(way * vec2(0.5, -0.5), vec2(-1.0), vec2(1.0)), depth);
}
