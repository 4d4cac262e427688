// The four layers and the opaque scene, asked between pixels.
#define_import_path bevy_fluid::render::refract::layers

#import bevy_fluid::render::bindings::{body, view}
#import bevy_fluid::render::functions::{
    decode_normal, depth_map, has_back, has_front, nearest_scene_depth, ndc_from_pixel,
    pixel_from_ndc, view_depth,
}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

@group(1) @binding(2) var bulk_layers: texture_2d<f32>;
@group(1) @binding(3) var bulk_normals: texture_2d<f32>;
@group(1) @binding(4) var spray_layers: texture_2d<f32>;
@group(1) @binding(5) var spray_normals: texture_2d<f32>;

const BULK: u32 = 0u;
const SPRAY: u32 = 1u;
const FRONT: u32 = 0u;
const BACK: u32 = 1u;

// A depth on a layer; `there` is false where the layer has none.
struct Depth {
    there: bool,
    // View depth, positive forward.
    z: f32,
}

fn on_screen(pixel: vec2<f32>) -> bool {
    let uv = (pixel - view.main_pass_viewport.xy) / view.main_pass_viewport.zw;
    return all(uv >= vec2(0.0)) && all(uv < vec2(1.0));
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

// Device depth of one side, 0 where there is none.
fn load_side(kind: u32, side: u32, pixel: vec2<i32>) -> f32 {
    let layers = load_layers(kind, pixel);
    if side == FRONT {
        return select(0.0, layers.x, has_front(layers));
    }
    return select(0.0, -layers.y, has_back(layers));
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

// Bilinear weights of the four pixels about a point, from the one with the smaller coordinates
// on. Pixels that are not there or belong to another surface than the nearest get none.
struct Quad {
    there: bool,
    base: vec2<i32>,
    weights: vec4<f32>,
    depths: vec4<f32>,
}

fn corner(i: u32) -> vec2<i32> {
    return vec2(i32(i & 1u), i32(i >> 1u));
}

fn quad_at(kind: u32, side: u32, pixel: vec2<f32>) -> Quad {
    var out: Quad;
    let p = pixel - 0.5;
    let f = fract(p);
    out.base = vec2<i32>(floor(p));
    let nearest = u32(f.x >= 0.5) + 2u * u32(f.y >= 0.5);
    let map = depth_map(ndc_from_pixel(pixel));
    for (var i = 0u; i < 4u; i += 1u) {
        out.depths[i] = load_side(kind, side, out.base + corner(i));
    }
    out.there = out.depths[nearest] > 0.0;
    let reference = view_depth(map, out.depths[nearest]);
    for (var i = 0u; i < 4u; i += 1u) {
        let c = vec2<f32>(corner(i));
        let w = (1.0 - abs(f.x - c.x)) * (1.0 - abs(f.y - c.y));
        let same = out.depths[i] > 0.0
            && abs(view_depth(map, out.depths[i]) - reference) <= 2.0 * body.radius;
        out.weights[i] = select(0.0, w, same);
    }
    out.weights /= max(dot(out.weights, vec4(1.0)), 1e-20);
    return out;
}

// Device depth is affine over a plane, so it is what is interpolated.
fn layer_depth(kind: u32, side: u32, pixel: vec2<f32>) -> Depth {
    let quad = quad_at(kind, side, pixel);
    let d = dot(quad.weights, quad.depths);
    return Depth(quad.there, view_depth(depth_map(ndc_from_pixel(pixel)), d));
}

// Outward unit normal. A layer that has none there gives the direction to the viewer.
fn layer_normal(kind: u32, side: u32, pixel: vec2<f32>) -> vec3<f32> {
    let quad = quad_at(kind, side, pixel);
    var sum = vec3(0.0);
    for (var i = 0u; i < 4u; i += 1u) {
        if quad.weights[i] > 0.0 {
            sum += quad.weights[i] * load_normal(kind, side, quad.base + corner(i));
        }
    }
    let size = length(sum);
    return select(vec3(0.0, 0.0, select(1.0, -1.0, side == BACK)), sum / size, size > 1e-6);
}

fn scene_view_depth(pixel: vec2<f32>) -> Depth {
    if !on_screen(pixel) {
        return Depth(false, 0.0);
    }
    let d = nearest_scene_depth(vec2<i32>(pixel));
    return Depth(d > 0.0, view_depth(depth_map(ndc_from_pixel(pixel)), d));
}
