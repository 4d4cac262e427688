// The liquid over the opaque scene.

#import bevy_fluid::render::background::scene_color
#import bevy_fluid::render::frame::frame
#import bevy_fluid::render::functions::{has_back, nearest_scene_depth, pixel_from_camera, texel_at}
#import bevy_fluid::render::lit::{is_lit, light_of, tent}
#import bevy_fluid::render::refract::layers::{BULK, SPRAY, load_layers}
#import bevy_fluid::render::types::INSIDE_FRONT
#ifdef RESOLVE
#import bevy_fluid::render::resolve::resolved
#endif

// The transmitted fraction of red in its alpha; or the mean light of rays.
@group(1) @binding(1) var radiance: texture_2d<f32>;
// The transmitted fractions of green and blue.
@group(1) @binding(3) var transmission: texture_2d<f32>;
@group(1) @binding(5) var coverage: texture_2d<f32>;

struct Output {
#ifndef DEPTH_ALONE
    @location(0) color: vec4<f32>,
#endif
    @builtin(frag_depth) depth: f32,
}

// What is seen of the liquid at a pixel.
struct Seen {
    color: vec4<f32>,
    // Device depth.
    depth: f32,
}

// The visible depth of a pixel of liquid.
fn depth_at(pixel: vec2<i32>) -> f32 {
    let bulk = load_layers(BULK, pixel);
    let spray = load_layers(SPRAY, pixel);
    let front = max(bulk.x, spray.x);
    if front < INSIDE_FRONT {
        return front;
    }
    // The eye is in the liquid: its far surface, or an opaque thing in it, is visible.
    let layers = select(spray, bulk, bulk.x >= INSIDE_FRONT);
    return max(select(0.0, -layers.y, has_back(layers)), nearest_scene_depth(pixel));
}

#ifdef COVERAGE
fn is_bulk(pixel: vec2<i32>) -> bool {
    let last = vec2<i32>(frame.view_size) - 1;
    return load_layers(BULK, clamp(pixel, vec2(0), last)).x > 0.0;
}

// Whether a pixel of bulk lies among others: no splat may cover it alone, but all do together.
fn is_surrounded(pixel: vec2<i32>) -> bool {
    return is_bulk(pixel)
        && is_bulk(pixel + vec2(1, 0)) && is_bulk(pixel - vec2(1, 0))
        && is_bulk(pixel + vec2(0, 1)) && is_bulk(pixel - vec2(0, 1));
}

// The liquid beside a pixel whose middle it misses.
fn beside(pixel: vec2<i32>) -> Seen {
    var sum = vec4(0.0);
    var total = 0.0;
    var depth = 0.0;
    for (var j = -1; j <= 1; j += 1) {
        for (var i = -1; i <= 1; i += 1) {
            let found = light_of(pixel + vec2(i, j));
            if is_lit(found) {
                let weight = tent(vec2(i, j), found);
                sum += weight * found;
                total += weight;
                depth = max(depth, depth_at(pixel + vec2(i, j)));
            }
        }
    }
    return Seen(select(vec4(-1.0), sum / total, total > 0.0), depth);
}
#endif

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    let pixel = vec2<i32>(pixel_from_camera(position));
    let texel = texel_at(pixel);
    var seen = Seen(light_of(pixel), depth_at(pixel));
    let is_hit = is_lit(seen.color);
    var covered = 1.0;
#ifdef COVERAGE
    covered = dot(textureLoad(coverage, texel, 0), vec4(0.25));
    if covered < 1.0 && is_surrounded(pixel) {
        covered = 1.0;
    }
    if !is_hit && covered > 0.0 {
        seen = beside(pixel);
    }
#endif
    if !is_lit(seen.color) || covered <= 0.0 {
        discard;
    }
#ifdef DENSE
    if !is_hit {
        discard;
    }
    let transmitted = vec3(textureLoad(radiance, texel, 0).a, textureLoad(transmission, texel, 0).rg);
    if max(transmitted.r, max(transmitted.g, transmitted.b)) > 0.5 {
        discard;
    }
#endif
    var out: Output;
    out.depth = seen.depth;
#ifdef DEPTH_ALONE
    if covered < 0.5 {
        discard;
    }
#else
    out.color = seen.color;
#ifdef RESOLVE
    if is_hit {
        var rays = seen.color;
#ifdef MORE_RAYS
        rays = textureLoad(radiance, texel, 0);
#endif
        out.color = resolved(pixel, seen.color, rays);
    }
#endif
#ifdef COVERAGE
    let behind = textureLoad(scene_color, pixel + vec2<i32>(frame.view_origin), 0);
    out.color = mix(behind, out.color, covered);
#endif
#endif
    return out;
}
