// The four layers and the opaque scene, sampled between pixels.
#define_import_path bevy_fluid::render::refract::layers

#import bevy_fluid::render::frame::{frame, surface}
#import bevy_fluid::render::functions::{
    DepthMap, decode_normal, depth_map, depth_slope, nearest_scene_depth, ndc_from_pixel, texel_at,
}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(1) @binding(0) var bulk_layers: texture_2d<f32>;
@group(1) @binding(1) var bulk_normals: texture_2d<f32>;
@group(1) @binding(2) var spray_layers: texture_2d<f32>;
@group(1) @binding(3) var spray_normals: texture_2d<f32>;

const BULK: u32 = 0u;
const SPRAY: u32 = 1u;
const FRONT: u32 = 0u;
const BACK: u32 = 1u;

fn on_screen(pixel: vec2<f32>) -> bool {
    let uv = pixel / frame.view_size;
    return all(uv >= vec2(0.0)) && all(uv < vec2(1.0));
}

// The point of the screen that is nearest to one outside of it.
fn clamp_to_view(pixel: vec2<f32>) -> vec2<f32> {
    return clamp(pixel, vec2(0.5), frame.view_size - 0.5);
}

fn load_layers(kind: u32, pixel: vec2<i32>) -> vec2<f32> {
    return texel(kind, texel_at(pixel));
}

fn load_normal(kind: u32, side: u32, pixel: vec2<i32>) -> vec3<f32> {
    let encoded = codes(kind, texel_at(pixel));
    // Back normals are stored towards the viewer, like the front's: they are then encoded as
    // precisely.
    return select(-decode_normal(encoded.zw), decode_normal(encoded.xy), side == FRONT);
}

// The four pixels about a point, in rows from its upper left one, and their bilinear weights.
struct Quad {
    // In the textures.
    base: vec2<i32>,
    weights: vec4<f32>,
    // Which of them holds the point.
    nearest: vec4<bool>,
    // Device depths, not above 0 where there is none.
    front: vec4<f32>,
    back: vec4<f32>,
}

// Loads, not gathers: a texel has both sides at once.
fn texel(kind: u32, at: vec2<i32>) -> vec2<f32> {
#ifdef BULK_LAYERS
    if kind == BULK {
        return textureLoad(bulk_layers, at, 0).xy;
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        return textureLoad(spray_layers, at, 0).xy;
    }
#endif
    return vec2(NO_FRONT, NO_BACK);
}

fn codes(kind: u32, at: vec2<i32>) -> vec4<f32> {
#ifdef BULK_LAYERS
    if kind == BULK {
        return textureLoad(bulk_normals, at, 0);
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        return textureLoad(spray_normals, at, 0);
    }
#endif
    return vec4(0.0);
}

fn quad_at(kind: u32, pixel: vec2<f32>) -> Quad {
    let p = pixel - 0.5;
    // Beyond the textures: four empty ones of the margin.
    let base = clamp(vec2<i32>(floor(p)) - frame.origin, vec2(0), frame.size - 2);
    let f = p - floor(p);
    let a = texel(kind, base);
    let b = texel(kind, base + vec2(1, 0));
    let c = texel(kind, base + vec2(0, 1));
    let d = texel(kind, base + vec2(1, 1));
    let stored_backs = vec4(a.y, b.y, c.y, d.y);
    let right = f.x >= 0.5;
    let below = f.y >= 0.5;
    return Quad(
        base,
        vec4(vec2(1.0 - f.x, f.x) * (1.0 - f.y), vec2(1.0 - f.x, f.x) * f.y),
        vec4(!right && !below, right && !below, !right && below, right && below),
        vec4(a.x, b.x, c.x, d.x),
        select(vec4(0.0), -stored_backs, stored_backs > vec4(NO_BACK)),
    );
}

// The quad's weights for one of its sides; pixels that are not there or belong to another surface
// than the nearest get none.
fn weights_on(quad: Quad, depths: vec4<f32>, map: DepthMap) -> vec4<f32> {
    let nearest = dot(select(vec4(0.0), depths, quad.nearest), vec4(1.0));
    // Particles apart in device depth, to first order.
    let apart = 2.0 * surface.radius / abs(depth_slope(map, vec2(nearest)).x);
    let same = depths > vec4(0.0) & abs(depths - nearest) <= vec4(apart);
    let weights = select(vec4(0.0), quad.weights, same);
    return select(vec4(0.0), weights / max(dot(weights, vec4(1.0)), 1e-20), nearest > 0.0);
}

// (front, back) in device depth, 0 where the layer has none. Device depth is affine over a plane,
// so it can be interpolated.
fn layer_depths(kind: u32, pixel: vec2<f32>, map: DepthMap) -> vec2<f32> {
    let quad = quad_at(kind, pixel);
    return vec2(
        dot(weights_on(quad, quad.front, map), quad.front),
        dot(weights_on(quad, quad.back, map), quad.back),
    );
}

// Outward unit normal. A layer that has none there gives the direction to the viewer. Codes are
// interpolated as they are: all are of normals towards the viewer, where the mapping has no fold.
fn layer_normal(kind: u32, side: u32, pixel: vec2<f32>) -> vec3<f32> {
    let inside = clamp_to_view(pixel);
    let quad = quad_at(kind, inside);
    let depths = select(quad.back, quad.front, side == FRONT);
    let weights = weights_on(quad, depths, depth_map(ndc_from_pixel(inside)));
    let both = weights.x * codes(kind, quad.base)
        + weights.y * codes(kind, quad.base + vec2(1, 0))
        + weights.z * codes(kind, quad.base + vec2(0, 1))
        + weights.w * codes(kind, quad.base + vec2(1, 1));
    let normal = decode_normal(select(both.zw, both.xy, side == FRONT));
    return select(normal, -normal, side == BACK);
}

// Device depth of the opaque scene, 0 where there is nothing.
fn scene_depth_at(pixel: vec2<f32>) -> f32 {
    return nearest_scene_depth(vec2<i32>(pixel));
}
