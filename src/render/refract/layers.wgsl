// The four layers and the opaque scene, asked between pixels.
#define_import_path bevy_fluid::render::refract::layers

#import bevy_fluid::render::bindings::{body, view}
#import bevy_fluid::render::functions::{
    DepthMap, decode_normal, depth_map, depth_slope, nearest_scene_depth, ndc_from_pixel,
}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(1) @binding(2) var bulk_layers: texture_2d<f32>;
@group(1) @binding(3) var bulk_normals: texture_2d<f32>;
@group(1) @binding(4) var spray_layers: texture_2d<f32>;
@group(1) @binding(5) var spray_normals: texture_2d<f32>;
@group(1) @binding(6) var nearest_sampler: sampler;

const BULK: u32 = 0u;
const SPRAY: u32 = 1u;
const FRONT: u32 = 0u;
const BACK: u32 = 1u;

fn on_screen(pixel: vec2<f32>) -> bool {
    let uv = (pixel - view.main_pass_viewport.xy) / view.main_pass_viewport.zw;
    return all(uv >= vec2(0.0)) && all(uv < vec2(1.0));
}

// The point of the screen that is nearest to one outside of it.
fn clamp_to_view(pixel: vec2<f32>) -> vec2<f32> {
    let low = view.main_pass_viewport.xy + 0.5;
    return clamp(pixel, low, low + view.main_pass_viewport.zw - 1.0);
}

fn load_layers(kind: u32, pixel: vec2<i32>) -> vec2<f32> {
    if !on_screen(vec2<f32>(pixel) + 0.5) {
        return vec2(NO_FRONT, NO_BACK);
    }
#ifdef BULK_LAYERS
    if kind == BULK {
        return textureLoad(bulk_layers, pixel, 0).xy;
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        return textureLoad(spray_layers, pixel, 0).xy;
    }
#endif
    return vec2(NO_FRONT, NO_BACK);
}

fn load_normal(kind: u32, side: u32, pixel: vec2<i32>) -> vec3<f32> {
    var encoded = vec4(0.0);
#ifdef BULK_LAYERS
    if kind == BULK {
        encoded = textureLoad(bulk_normals, pixel, 0);
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        encoded = textureLoad(spray_normals, pixel, 0);
    }
#endif
    // The back's are stored towards the viewer, as the front's: encoding them is then as fine.
    return select(-decode_normal(encoded.zw), decode_normal(encoded.xy), side == FRONT);
}

// Bilinear weights of the four pixels about a point, in the order of `textureGather`. Pixels that
// are not there or belong to another surface than the nearest get none.
struct Quad {
    there: bool,
    base: vec2<i32>,
    weights: vec4<f32>,
    depths: vec4<f32>,
}

const CORNERS_X: vec4<f32> = vec4(0.0, 1.0, 1.0, 0.0);
const CORNERS_Y: vec4<f32> = vec4(1.0, 1.0, 0.0, 0.0);

// Device depths of one side, not above 0 where there is none.
fn gather_depths(kind: u32, side: u32, base: vec2<f32>) -> vec4<f32> {
#ifdef BULK_LAYERS
    if kind == BULK {
        // The middle of the four: no rounding picks others.
        let uv = (base + 1.0) / vec2<f32>(textureDimensions(bulk_layers));
        if side == FRONT {
            return textureGather(0, bulk_layers, nearest_sampler, uv);
        }
        return back_depths(textureGather(1, bulk_layers, nearest_sampler, uv));
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        let uv = (base + 1.0) / vec2<f32>(textureDimensions(spray_layers));
        if side == FRONT {
            return textureGather(0, spray_layers, nearest_sampler, uv);
        }
        return back_depths(textureGather(1, spray_layers, nearest_sampler, uv));
    }
#endif
    return vec4(0.0);
}

fn back_depths(stored: vec4<f32>) -> vec4<f32> {
    return select(vec4(0.0), -stored, stored > vec4(NO_BACK));
}

fn quad_at(kind: u32, side: u32, pixel: vec2<f32>, map: DepthMap) -> Quad {
    var out: Quad;
    let p = pixel - 0.5;
    let base = floor(p);
    let f = p - base;
    out.base = vec2<i32>(base);
    out.depths = gather_depths(kind, side, base);
    let w = (1.0 - abs(f.x - CORNERS_X)) * (1.0 - abs(f.y - CORNERS_Y));
    let near_x = select(vec2(out.depths.w, out.depths.x), vec2(out.depths.z, out.depths.y), f.x >= 0.5);
    let nearest = select(near_x.x, near_x.y, f.y >= 0.5);
    out.there = nearest > 0.0;
    // Particles apart in device depth, to first order.
    let apart = 2.0 * body.radius / abs(depth_slope(map, vec2(nearest)).x);
    let same = out.depths > vec4(0.0) & abs(out.depths - nearest) <= vec4(apart);
    out.weights = select(vec4(0.0), w, same);
    out.weights /= max(dot(out.weights, vec4(1.0)), 1e-20);
    return out;
}

// Device depth, 0 where the layer has none. It is affine over a plane, so it is what is
// interpolated.
fn layer_depth(kind: u32, side: u32, pixel: vec2<f32>, map: DepthMap) -> f32 {
    let quad = quad_at(kind, side, pixel, map);
    return select(0.0, dot(quad.weights, quad.depths), quad.there);
}

// Codes of the normals about `base`, in the order of `textureGather`: x of all four, then y.
struct Codes {
    x: vec4<f32>,
    y: vec4<f32>,
}

fn gather_codes(kind: u32, side: u32, base: vec2<f32>) -> Codes {
#ifdef BULK_LAYERS
    if kind == BULK {
        let uv = (base + 1.0) / vec2<f32>(textureDimensions(bulk_normals));
        if side == FRONT {
            return Codes(
                textureGather(0, bulk_normals, nearest_sampler, uv),
                textureGather(1, bulk_normals, nearest_sampler, uv),
            );
        }
        return Codes(
            textureGather(2, bulk_normals, nearest_sampler, uv),
            textureGather(3, bulk_normals, nearest_sampler, uv),
        );
    }
#endif
#ifdef SPRAY_LAYERS
    if kind == SPRAY {
        let uv = (base + 1.0) / vec2<f32>(textureDimensions(spray_normals));
        if side == FRONT {
            return Codes(
                textureGather(0, spray_normals, nearest_sampler, uv),
                textureGather(1, spray_normals, nearest_sampler, uv),
            );
        }
        return Codes(
            textureGather(2, spray_normals, nearest_sampler, uv),
            textureGather(3, spray_normals, nearest_sampler, uv),
        );
    }
#endif
    return Codes(vec4(0.0), vec4(0.0));
}

// Outward unit normal. A layer that has none there gives the direction to the viewer. Codes are
// interpolated as they are: all are of normals towards the viewer, where the mapping has no fold.
fn layer_normal(kind: u32, side: u32, pixel: vec2<f32>) -> vec3<f32> {
    let inside = clamp_to_view(pixel);
    let quad = quad_at(kind, side, inside, depth_map(ndc_from_pixel(inside)));
    let codes = gather_codes(kind, side, vec2<f32>(quad.base));
    let normal = decode_normal(vec2(dot(quad.weights, codes.x), dot(quad.weights, codes.y)));
    return select(normal, -normal, side == BACK);
}

// Device depth of the opaque scene, 0 where there is nothing.
fn scene_depth_at(pixel: vec2<f32>) -> f32 {
    return nearest_scene_depth(vec2<i32>(pixel));
}
