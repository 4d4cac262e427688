// Slopes of a depth layer from one pixel to the next.
#define_import_path bevy_fluid::render::slopes

#import bevy_fluid::render::bindings::view
#import bevy_fluid::render::functions::{has_back, has_front}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(1) @binding(0) var layers: texture_2d<f32>;

// A pixel of the layers, nothing outside of the viewport.
fn layers_at(pixel: vec2<i32>) -> vec4<f32> {
    let low = vec2<i32>(view.main_pass_viewport.xy);
    let high = low + vec2<i32>(view.main_pass_viewport.zw);
    if any(pixel < low) || any(pixel >= high) {
        return vec4(NO_FRONT, NO_BACK, 0.0, 0.0);
    }
    return textureLoad(layers, pixel, 0);
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
