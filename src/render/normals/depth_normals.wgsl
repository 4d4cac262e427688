// Normals of a body's bulk from its depth layers: the smaller of the one-sided differences, so
// that a step in depth does not tilt the surfaces beside it.

#import bevy_fluid::render::bindings::view
#import bevy_fluid::render::functions::{
    encode_normal, has_back, has_front, ndc_from_pixel, normal_from_slope,
}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(1) @binding(0) var layers: texture_2d<f32>;

fn value_at(pixel: vec2<i32>) -> vec2<f32> {
    let low = vec2<i32>(view.main_pass_viewport.xy);
    let high = low + vec2<i32>(view.main_pass_viewport.zw);
    if any(pixel < low) || any(pixel >= high) {
        return vec2(NO_FRONT, NO_BACK);
    }
    return textureLoad(layers, pixel, 0).xy;
}

fn there(value: vec2<f32>) -> vec2<bool> {
    return vec2(has_front(value), has_back(value));
}

// Slope of both layers along one axis.
fn slope(pixel: vec2<i32>, center: vec2<f32>, step: vec2<i32>) -> vec2<f32> {
    let before = value_at(pixel - step);
    let after = value_at(pixel + step);
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

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<i32>(position.xy);
    let ndc = ndc_from_pixel(position.xy);
    let center = value_at(pixel);
    let x = slope(pixel, center, vec2(1, 0));
    let y = slope(pixel, center, vec2(0, 1));
    let front = normal_from_slope(ndc, center.x, vec2(x.x, y.x));
    let back = normal_from_slope(ndc, -center.y, -vec2(x.y, y.y));
    return vec4(encode_normal(front), encode_normal(back));
}
