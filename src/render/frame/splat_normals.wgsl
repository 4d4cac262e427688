// Normals from the ellipsoids themselves, for spray: the splats are drawn once more over finished
// layers, and only the ellipsoid that made a layer writes its normal.

#import bevy_fluid::render::functions::encode_normal
#import bevy_fluid::render::ellipsoid::{EllipsoidVertex, intersect, place}
#import bevy_fluid::render::types::INSIDE_FRONT

@group(2) @binding(0) var layers: texture_2d<f32>;

// Two pipelines may round the same formula differently.
const SAME: f32 = 4e-6;
// Below every encoded normal: loses every `max`.
const NONE: vec2<f32> = vec2(-2.0);

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) splat: u32,
) -> EllipsoidVertex {
    return place(splat, corner);
}

@fragment
fn fragment(in: EllipsoidVertex) -> @location(0) vec4<f32> {
    let found = intersect(in);
    let layer = textureLoad(layers, vec2<i32>(in.position.xy), 0).xy;
    let same = abs(found.layers - layer) <= SAME * abs(layer);
    if !found.hit || !any(same) {
        discard;
    }
    let front = same.x && found.layers.x < INSIDE_FRONT;
    return vec4(
        select(NONE, encode_normal(normalize(found.front_normal)), front),
        select(NONE, encode_normal(normalize(found.back_normal)), same.y),
    );
}
