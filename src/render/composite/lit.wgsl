// The light of pixels of liquid.
#define_import_path bevy_fluid::render::lit

#import bevy_fluid::render::functions::texel_at

@group(1) @binding(4) var lights: texture_2d<f32>;

// From the liquid and through it at a pixel.
fn light_of(pixel: vec2<i32>) -> vec4<f32> {
    return textureLoad(lights, texel_at(pixel), 0);
}

fn is_lit(light: vec4<f32>) -> bool {
    return light.a >= 0.0;
}

// The weight of a neighbour's light in a mean by a tent, two pixels wide to each side; 0 where there is
// no liquid.
fn tent(offset: vec2<i32>, light: vec4<f32>) -> f32 {
    let part = 2 - abs(offset);
    return select(0.0, f32(part.x * part.y) * tame(light), is_lit(light));
}

// The weight of a light in a mean. With equal weights one highlight would outshine all others by
// far, though tone mapping shows it hardly brighter.
fn tame(light: vec4<f32>) -> f32 {
    return 1.0 / (1.0 + max(light.r, max(light.g, light.b)));
}
