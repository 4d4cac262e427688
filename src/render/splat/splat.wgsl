// Ellipsoids into the depth layers of their class.

#import bevy_fluid::render::functions::{farthest_scene_depth, pixel_from_texture}
#import bevy_fluid::render::ellipsoid::{EllipsoidVertex, intersect, place}
#import bevy_fluid::render::types::NO_FRONT

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) splat: u32,
) -> EllipsoidVertex {
    return place(splat, corner);
}

// A front behind the opaque scene is hidden and left out; the back is kept, because refracted rays
// that pass the opaque thing must still find it.
fn visible_front(front: f32, position: vec4<f32>) -> f32 {
    let pixel = pixel_from_texture(position);
    return select(NO_FRONT, front, front >= farthest_scene_depth(vec2<i32>(pixel)));
}

#ifdef MAX_BLEND
@fragment
fn fragment(in: EllipsoidVertex) -> @location(0) vec2<f32> {
    let found = intersect(in);
    if !found.hit {
        discard;
    }
    return vec2(visible_front(found.layers.x, in.position), found.layers.y);
}
#endif

#ifdef COUNT
@fragment
fn fragment(in: EllipsoidVertex) -> @location(0) f32 {
    if !intersect(in).hit {
        discard;
    }
    return 1.0;
}
#endif

#ifdef DEPTH_FRONT
@fragment
fn fragment(in: EllipsoidVertex) -> @builtin(frag_depth) f32 {
    let found = intersect(in);
    if !found.hit {
        discard;
    }
    return visible_front(found.layers.x, in.position);
}
#endif

#ifdef DEPTH_BACK
@fragment
fn fragment(in: EllipsoidVertex) -> @builtin(frag_depth) f32 {
    let found = intersect(in);
    if !found.hit {
        discard;
    }
    return -found.layers.y;
}
#endif
