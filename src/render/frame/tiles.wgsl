// The vertex stage of passes over a surface's pixels: one quad per tile that holds liquid.
#define_import_path bevy_fluid::render::tiles

#import bevy_fluid::render::frame::{frame, tiles}
#import bevy_fluid::render::functions::{ndc_from_pixel, ndc_in_textures}

const TILE = u32(#{TILE});

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) instance: u32,
) -> @builtin(position) vec4<f32> {
    let columns = textureDimensions(tiles).x;
    let tile = vec2(instance % columns, instance / columns);
#ifdef ALL_TILES
    let holds_liquid = true;
#else
    let held = textureLoad(tiles, vec2<i32>(tile), 0).xy;
#ifdef BULK_TILES
    let holds_liquid = held.x > 0.0;
#else
    let holds_liquid = held.x + held.y > 0.0;
#endif
#endif
    let texel = vec2<f32>((tile + vec2(corner & 1u, corner >> 1u)) * TILE);
    let pixel = texel + vec2<f32>(frame.origin);
#ifdef TO_CAMERA
    let ndc = ndc_from_pixel(pixel);
#else
    let ndc = ndc_in_textures(pixel);
#endif
    // Empty tiles collapse to a point outside.
    return select(vec4(2.0, 2.0, 0.0, 1.0), vec4(ndc, 0.0, 1.0), holds_liquid);
}
