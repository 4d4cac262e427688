// Ellipsoids into the depth layers of their class, and into the coverage of pixels.

#import bevy_fluid::render::functions::{farthest_scene_depth, pixel_from_texture}
#import bevy_fluid::render::ellipsoid::{EllipsoidVertex, Intersection, intersect, place}
#ifdef COVERAGE
#import bevy_fluid::render::ellipsoid::coverage_of
#endif
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

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

#ifdef COVERAGE
// Of what is not hidden by the opaque scene.
fn visible_coverage(in: EllipsoidVertex, found: Intersection) -> vec4<f32> {
    var covered = vec4(f32(found.hit));
    var depth = found.layers.x;
    if in.form == 0u {
        covered = coverage_of(in);
        // Beside the outline, the depth of the ellipsoid's centre.
        depth = select(in.center.z, depth, found.hit);
    }
    return select(vec4(0.0), covered, visible_front(depth, in.position) > NO_FRONT);
}
#endif

#ifdef MAX_BLEND
struct Output {
    @location(0) layers: vec2<f32>,
#ifdef COVERAGE
    @location(1) coverage: vec4<f32>,
#endif
}

@fragment
fn fragment(in: EllipsoidVertex) -> Output {
    let found = intersect(in);
    var out: Output;
    out.layers = select(
        vec2(NO_FRONT, NO_BACK),
        vec2(visible_front(found.layers.x, in.position), found.layers.y),
        found.hit,
    );
#ifdef COVERAGE
    out.coverage = visible_coverage(in, found);
    let is_empty = !found.hit && all(out.coverage <= vec4(0.0));
#else
    let is_empty = !found.hit;
#endif
    if is_empty {
        discard;
    }
    return out;
}
#endif

#ifdef COVERAGE_ALONE
@fragment
fn fragment(in: EllipsoidVertex) -> @location(0) vec4<f32> {
    return visible_coverage(in, intersect(in));
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
