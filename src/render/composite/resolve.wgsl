// The mean light over a pixel of liquid whose neighbours part: of its neighbours, and of more rays
// through it.
#define_import_path bevy_fluid::render::resolve

#import bevy_fluid::render::frame::{frame, surface}
#import bevy_fluid::render::functions::{depth_map, depth_slope, ndc_from_pixel}
#import bevy_fluid::render::lit::{is_lit, light_of, tent}
#import bevy_fluid::render::refract::layers::{BULK, SPRAY, load_layers}

const RAYS: u32 = #{RAYS}u;
// Mean contrast to the four neighbours, as perceived (square root of light), from which on more rays
// are traced, and at which they count in full. By measurement: from 0.09 on, a splash is a quarter
// sharper than the mean of 64 pictures through other places of each pixel; from 0.03 on, softer.
const PARTED: vec2<f32> = vec2(0.05, 0.1);
// The neighbours' share of the mean among pixels of one surface, the smaller the more rays there are;
// and where half of them see other surfaces or none, of which no ray through the pixel knows. By measurement:
// with these, pictures are as sharp as the truth.
const NEIGHBORS: vec2<f32> = vec2(1.0 / (1.5 + 0.5 * f32(RAYS)), 0.75);

fn perceived(light: vec4<f32>) -> vec3<f32> {
    return sqrt(clamp(light.rgb, vec3(0.0), vec3(1.0)));
}

// The class and the depth of the front at a pixel.
struct Front {
    kind: u32,
    depth: f32,
}

fn front_of(pixel: vec2<i32>) -> Front {
    let bulk = load_layers(BULK, pixel).x;
    let spray = load_layers(SPRAY, pixel).x;
    return Front(select(SPRAY, BULK, bulk >= spray), max(bulk, spray));
}

// The pixel beside another; at the view's border, the pixel itself.
fn beside(pixel: vec2<i32>, offset: vec2<i32>) -> vec2<i32> {
    return clamp(pixel + offset, vec2(0), vec2<i32>(frame.view_size) - 1);
}

// How far a pixel's light differs from that of the four pixels beside it, 0 to 1; always at an edge.
fn parting(pixel: vec2<i32>, own: vec4<f32>) -> f32 {
    var contrast = 0.0;
    for (var k = 0; k < 4; k += 1) {
        let along = select(vec2(1, 0), vec2(0, 1), k >= 2);
        let found = light_of(beside(pixel, select(along, -along, k % 2 == 1)));
        let apart = abs(perceived(found) - perceived(own));
        contrast += select(0.25, 0.25 * max(apart.r, max(apart.g, apart.b)), is_lit(found));
    }
    return smoothstep(PARTED.x, PARTED.y, contrast);
}

// Twice the part of the four pixels beside it that see other surfaces than a pixel, or none; 1 at the
// most.
fn others(pixel: vec2<i32>) -> f32 {
    let front = front_of(pixel);
    // A particle apart in device depth, to first order.
    let map = depth_map(ndc_from_pixel(vec2<f32>(pixel) + 0.5));
    let same_depth = 2.0 * surface.radius / abs(depth_slope(map, vec2(front.depth)).x);
    var found = 0.0;
    for (var k = 0; k < 4; k += 1) {
        let along = select(vec2(1, 0), vec2(0, 1), k >= 2);
        let at = beside(pixel, select(along, -along, k % 2 == 1));
        let its = front_of(at);
        let is_same = is_lit(light_of(at)) && its.kind == front.kind
            && abs(its.depth - front.depth) <= same_depth;
        found += select(0.5, 0.0, is_same);
    }
    return min(found, 1.0);
}

// A pixel's light after that of its neighbours; `rays` is the mean of the rays through it.
fn resolved(pixel: vec2<i32>, own: vec4<f32>, rays: vec4<f32>) -> vec4<f32> {
    let parted = parting(pixel, own);
    let others = others(pixel);
    if parted + others <= 0.0 {
        return own;
    }
    var sum = vec4(0.0);
    var total = 0.0;
    for (var j = -1; j <= 1; j += 1) {
        for (var i = -1; i <= 1; i += 1) {
            let found = light_of(beside(pixel, vec2(i, j)));
            let weight = tent(vec2(i, j), found);
            sum += weight * found;
            total += weight;
        }
    }
    let share = mix(NEIGHBORS.x, NEIGHBORS.y, others) * max(parted, others);
    // Rays are there only where it parts.
    let mean = select(own, mix(own, rays, parted), parted > 0.0);
    return mix(mean, sum / total, share);
}
