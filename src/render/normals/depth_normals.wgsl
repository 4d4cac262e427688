// Normals of a surface's bulk from its depth layers.

#import bevy_fluid::render::functions::{
    encode_normal, ndc_from_pixel, normal_from_slope, pixel_from_texture,
}
#import bevy_fluid::render::slopes::{layers_at, one_sided_slope}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = pixel_from_texture(position);
    let pixel = vec2<i32>(at);
    let ndc = ndc_from_pixel(at);
    let center = layers_at(pixel).xy;
    let x = one_sided_slope(pixel, center, vec2(1, 0));
    let y = one_sided_slope(pixel, center, vec2(0, 1));
    let front = normal_from_slope(ndc, center.x, vec2(x.x, y.x));
    let back = normal_from_slope(ndc, -center.y, -vec2(x.y, y.y));
    return vec4(encode_normal(front), encode_normal(back));
}
