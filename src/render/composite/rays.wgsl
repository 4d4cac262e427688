// More rays through the pixels of liquid whose neighbours part. They are few and scattered: each
// workgroup collects those of its tile, so that threads side by side have a ray to trace.

#import bevy_fluid::render::background::{background, color_at, light_through}
#import bevy_fluid::render::frame::{frame, tiles}
#import bevy_fluid::render::functions::{depth_map, ndc_from_pixel}
#import bevy_fluid::render::lit::{is_lit, light_of, tame}
#import bevy_fluid::render::refract::layers::{
    FRONT, layer_depths, layer_normal, load_layers, on_screen,
}
#import bevy_fluid::render::refract::trace::{pixel_of, trace_from}
#import bevy_fluid::render::resolve::{RAYS, front_of, parting}
#import bevy_fluid::render::types::INSIDE_FRONT

// The mean light of the rays through each of those pixels.
@group(1) @binding(5) var rays: texture_storage_2d<rgba16float, write>;

const TILE = u32(#{TILE});
// Of a workgroup.
const EDGE = 8u;
// Rays in pairs on opposite sides of the middle: four are a rotated grid.
const OFFSETS = array(vec2(0.125, 0.375), vec2(0.375, -0.125), vec2(0.25, 0.2), vec2(-0.2, 0.25));

var<workgroup> count: atomic<u32>;
// Indices of pixels within the tile.
var<workgroup> found: array<u32, TILE * TILE>;

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

// The mean of the rays through a pixel.
fn mean_over(pixel: vec2<i32>) -> vec4<f32> {
    let own = light_of(pixel);
    let kind = front_of(pixel).kind;
    var weights = tame(own);
    var sum = weights * own;
    for (var k = 0u; k < RAYS; k += 1u) {
        let offset = OFFSETS[k / 2u];
        let at = vec2<f32>(pixel) + 0.5 + select(offset, -offset, k % 2u == 1u);
        let light = light_at(at, kind);
        sum += tame(light) * light;
        weights += tame(light);
    }
    return sum / weights;
}

@compute @workgroup_size(EDGE, EDGE)
fn trace_more(
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_id) place: vec3<u32>,
    @builtin(local_invocation_index) index: u32,
) {
    let corner = vec2<i32>(tile.xy * TILE) + frame.origin;
    let held = textureLoad(tiles, tile.xy, 0).xy;
    if held.x + held.y > 0.0 {
        for (var y = place.y; y < TILE; y += EDGE) {
            for (var x = place.x; x < TILE; x += EDGE) {
                let pixel = corner + vec2<i32>(vec2(x, y));
                let own = light_of(pixel);
                if is_lit(own) && parting(pixel, own) > 0.0 {
                    found[atomicAdd(&count, 1u)] = TILE * y + x;
                }
            }
        }
    }
    workgroupBarrier();
    for (var i = index; i < atomicLoad(&count); i += EDGE * EDGE) {
        let pixel = corner + vec2<i32>(vec2(found[i] % TILE, found[i] / TILE));
        textureStore(rays, pixel - frame.origin, mean_over(pixel));
    }
}
