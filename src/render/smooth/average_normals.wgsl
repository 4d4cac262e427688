// The mean of the splats' normals over a window: Takahashi & Doi. Depth stays as splatted.

#import bevy_fluid::render::functions::{decode_normal, encode_normal, texel_at}
#import bevy_fluid::render::slopes::layers_at
#import bevy_fluid::render::smooth::window::{edge_weight, valid_layers, window_at}

@group(2) @binding(0) var normals: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let window = window_at(position);
    var front = vec3(0.0);
    var back = vec3(0.0);
    for (var j = -#{HALF_TAPS}; j <= #{HALF_TAPS}; j += 1) {
        for (var i = -#{HALF_TAPS}; i <= #{HALF_TAPS}; i += 1) {
            let weight = edge_weight(window, i) * edge_weight(window, j);
            let pixel = window.pixel + vec2(i, j) * window.spacing;
            if weight <= 0.0 {
                continue;
            }
            let there = valid_layers(layers_at(pixel).xy);
            let encoded = textureLoad(normals, texel_at(pixel), 0);
            front += select(0.0, weight, there.x) * decode_normal(encoded.xy);
            back += select(0.0, weight, there.y) * decode_normal(encoded.zw);
        }
    }
    return vec4(
        encode_normal(select(vec3(0.0, 0.0, 1.0), normalize(front), dot(front, front) > 1e-12)),
        encode_normal(select(vec3(0.0, 0.0, 1.0), normalize(back), dot(back, back) > 1e-12)),
    );
}
