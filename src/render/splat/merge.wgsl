// Two depth textures into one layer texture, where the adapter cannot blend 32-bit floats.

#import bevy_fluid::render::types::NO_BACK

@group(0) @binding(0) var front: texture_depth_2d;
@group(0) @binding(1) var back: texture_depth_2d;

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec2<f32> {
    let pixel = vec2<i32>(position.xy);
    let back_depth = textureLoad(back, pixel, 0);
    return vec2(
        textureLoad(front, pixel, 0),
        // The clear value, 1, means nothing.
        select(-back_depth, NO_BACK, back_depth >= 1.0),
    );
}
