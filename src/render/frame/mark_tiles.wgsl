// Which tiles hold (bulk, any liquid): one pixel per tile.

#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(0) @binding(0) var bulk_layers: texture_2d<f32>;
@group(0) @binding(1) var spray_layers: texture_2d<f32>;
@group(0) @binding(2) var coverage: texture_2d<f32>;

const TILE = #{TILE};

fn is_layer(layers: vec2<f32>) -> bool {
    return layers.x > NO_FRONT || layers.y > NO_BACK;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec2<f32> {
    let first = vec2<i32>(position.xy) * TILE;
    var bulk = false;
    var any_liquid = false;
    for (var y = 0; y < TILE; y += 1) {
        for (var x = 0; x < TILE; x += 1) {
            let texel = first + vec2(x, y);
#ifdef BULK_LAYERS
            bulk = bulk || is_layer(textureLoad(bulk_layers, texel, 0).xy);
#endif
#ifdef COVERAGE
            any_liquid = any_liquid || any(textureLoad(coverage, texel, 0) > vec4(0.0));
#else ifdef SPRAY_LAYERS
            any_liquid = any_liquid || is_layer(textureLoad(spray_layers, texel, 0).xy);
#endif
        }
    }
    return vec2(f32(bulk), f32(any_liquid));
}
