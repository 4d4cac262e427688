// The depth prepass as (nearest, farthest) of each pixel's samples. Depths are never averaged
// across samples: anything behind the nearest is partly hidden, anything behind the farthest is
// hidden in every sample.

#import bevy_fluid::render::frame::FluidFrame

@group(0) @binding(0) var depth: texture_depth_multisampled_2d;
@group(0) @binding(1) var<uniform> frame: FluidFrame;

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec2<f32> {
    let pixel = vec2<i32>(position.xy + frame.view_origin);
    var range = vec2(textureLoad(depth, pixel, 0));
    for (var i = 1; i < i32(textureNumSamples(depth)); i += 1) {
        let sample = textureLoad(depth, pixel, i);
        range = vec2(max(range.x, sample), min(range.y, sample));
    }
    return range;
}
