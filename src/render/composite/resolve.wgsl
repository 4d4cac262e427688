// The mean light over a pixel of liquid whose neighbours part: of more rays through it, and of its
// neighbours.
#define_import_path bevy_fluid::render::resolve

#import bevy_fluid::render::background::{background, color_at, light_through}
#import bevy_fluid::render::frame::{frame, surface}
#import bevy_fluid::render::functions::{depth_map, depth_slope, ndc_from_pixel}
#import bevy_fluid::render::lit::{is_lit, light_of, tame, tent}
#import bevy_fluid::render::refract::layers::{
    BULK, FRONT, SPRAY, layer_depths, layer_normal, load_layers, on_screen,
}
#import bevy_fluid::render::refract::trace::{pixel_of, trace_from}
#import bevy_fluid::render::types::INSIDE_FRONT

const RAYS: u32 = #{RAYS}u;
// Mean contrast to the four neighbours, as perceived (square root of light), from which on more rays
// are traced, and at which they count in full. By measurement: a fifteenth of the pixels of a splash
// lie above it, and nine tenths of the squared error.
const PARTED: vec2<f32> = vec2(0.09, 0.15);
// The neighbours' share of the mean among pixels of one surface, the smaller the more rays there are;
// and where all of them see other surfaces, of which no ray through the pixel knows. By measurement:
// with these, pictures are as sharp as the truth.
const NEIGHBORS: vec2<f32> = vec2(1.0 / (1.5 + 0.5 * f32(RAYS)), 0.75);
// Rays in pairs on opposite sides of the middle: four are a rotated grid.
const OFFSETS = array(vec2(0.125, 0.375), vec2(0.375, -0.125), vec2(0.25, 0.2), vec2(-0.2, 0.25));

fn perceived(light: vec4<f32>) -> vec3<f32> {
    return sqrt(clamp(light.rgb, vec3(0.0), vec3(1.0)));
}

// What the ray through a point of the screen sees. The point is in the pixel of the same surface.
fn light_at(at: vec2<f32>, kind: u32) -> vec4<f32> {
    let between = layer_depths(kind, at, depth_map(ndc_from_pixel(at))).x;
    // A front that only says that the eye is in the liquid is no depth.
    let is_inside = load_layers(kind, vec2<i32>(at)).x >= INSIDE_FRONT;
    let front = select(between, INSIDE_FRONT, is_inside);
    let path = trace_from(at, kind, front, layer_normal(kind, FRONT, at));
    let end = pixel_of(path.position);
    var behind: vec4<f32>;
    if path.direct {
        behind = color_at(end);
    } else {
        behind = background(at, path.position, path.direction, on_screen(end));
    }
    return light_through(at, front, path.radiance, path.transmission, behind);
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

fn resolved(pixel: vec2<i32>, own: vec4<f32>) -> vec4<f32> {
    let at = vec2<f32>(pixel) + 0.5;
    let front = front_of(pixel);
    // A particle apart in device depth, to first order.
    let slope = depth_slope(depth_map(ndc_from_pixel(at)), vec2(front.depth)).x;
    let same_depth = 2.0 * surface.radius / abs(slope);
    // The neighbours' mean.
    var sum = vec4(0.0);
    var total = 0.0;
    var contrast = 0.0;
    var others = 0.0;
    for (var j = -1; j <= 1; j += 1) {
        for (var i = -1; i <= 1; i += 1) {
            let beside = pixel + vec2(i, j);
            let found = light_of(beside);
            let there = is_lit(found);
            let weight = tent(vec2(i, j), found);
            sum += weight * found;
            total += weight;
            if abs(i) + abs(j) == 1 {
                let its = front_of(beside);
                let same = there && its.kind == front.kind && abs(its.depth - front.depth) <= same_depth;
                others += select(0.25, 0.0, same || !there);
                let apart = abs(perceived(found) - perceived(own));
                contrast += select(0.0, 0.25 * max(apart.r, max(apart.g, apart.b)), there);
            }
        }
    }
    var mean = own;
    let parted = smoothstep(PARTED.x, PARTED.y, contrast);
#ifdef MORE_RAYS
    if parted > 0.0 {
        var weights = tame(own);
        var rays = weights * own;
        for (var k = 1u; k <= RAYS; k += 1u) {
            let offset = OFFSETS[(k - 1u) / 2u];
            let ray = light_at(at + select(-offset, offset, k % 2u == 1u), front.kind);
            rays += tame(ray) * ray;
            weights += tame(ray);
        }
        mean = mix(own, rays / weights, parted);
    }
#endif
    let share = mix(NEIGHBORS.x, NEIGHBORS.y, others);
    return mix(mean, sum / total, share * max(parted, others));
}
