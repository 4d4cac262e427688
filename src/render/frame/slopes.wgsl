// Slopes of a depth layer from one pixel to the next.
#define_import_path bevy_fluid::render::slopes

#import bevy_fluid::render::functions::{has_back, has_front, texel_at}

#ifdef FROM_SLOPES
// Bits of f32: see `EXIT_FORMAT`.
@group(1) @binding(0) var layers: texture_2d<u32>;
#else
@group(1) @binding(0) var layers: texture_2d<f32>;
#endif

// A pixel of the layers.
fn layers_at(pixel: vec2<i32>) -> vec4<f32> {
#ifdef FROM_SLOPES
    return bitcast<vec4<f32>>(textureLoad(layers, texel_at(pixel), 0));
#else
    return textureLoad(layers, texel_at(pixel), 0);
#endif
}

fn there(value: vec2<f32>) -> vec2<bool> {
    return vec2(has_front(value), has_back(value));
}

// Of both layers along one axis: the smaller of the one-sided differences, so that a step in depth
// does not tilt the surfaces beside it.
fn one_sided_slope(pixel: vec2<i32>, center: vec2<f32>, step: vec2<i32>) -> vec2<f32> {
    let before = layers_at(pixel - step).xy;
    let after = layers_at(pixel + step).xy;
    let to = after - center;
    let behind = center - before;
    let to_ok = there(after);
    let behind_ok = there(before);
    let smaller = select(to, behind, abs(behind) < abs(to));
    return select(
        select(vec2(0.0), behind, behind_ok),
        select(to, smaller, behind_ok),
        to_ok,
    );
}
