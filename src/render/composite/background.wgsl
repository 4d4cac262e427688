// What is seen at the end of a ray that has left the liquid.
#define_import_path bevy_fluid::render::background

#import bevy_fluid::render::frame::{frame, surface, view}
#import bevy_fluid::render::functions::{
    depth_map, device_from_view, nearest_scene_depth, ndc_from_pixel, pixel_from_ndc, view_depth,
    view_from_device,
}
#import bevy_fluid::render::haze::haze_before
#import bevy_fluid::render::optics::{environment, lighting}
#import bevy_fluid::render::types::INSIDE_FRONT

// The scene's colour as it is before this surface, and before any.
@group(3) @binding(0) var scene_color: texture_2d<f32>;
@group(3) @binding(1) var scene_before: texture_2d<f32>;
@group(3) @binding(2) var scene_sampler: sampler;

const MAX_HALF: f32 = 65504.0;
// A step is a few pixels long, so short tracks need few steps.
const STEP_PIXELS: f32 = 6.0;
const MAX_STEPS: f32 = 32.0;
const HALVINGS: i32 = 4;

fn color_in(scene: texture_2d<f32>, pixel: vec2<f32>) -> vec4<f32> {
    // Half a pixel off the viewport's edge, so that no neighbour outside of it is mixed in.
    let inside = clamp(pixel, vec2(0.5), frame.view_size - 0.5) + frame.view_origin;
    let uv = inside / vec2<f32>(textureDimensions(scene));
    return textureSampleLevel(scene, scene_sampler, uv, 0.0);
}

// The scene's premultiplied colour and its alpha.
fn color_at(pixel: vec2<f32>) -> vec4<f32> {
    return color_in(scene_color, pixel);
}

// A surface painted earlier. Surfaces are in no depth texture that could be searched; if the colour
// has changed where the ray passes the next surface's centre, that colour is used.
struct Painted {
    is_there: bool,
    color: vec4<f32>,
}

fn painted_behind(position: vec3<f32>, direction: vec3<f32>) -> Painted {
#ifdef SEVERAL
    let t = dot(surface.behind.xyz - position, direction);
    let device = device_from_view(position + t * direction);
    let is_ahead = (surface.behind.w > 0.0) & (t > 0.0);
    if is_ahead && all(abs(device.xy) <= vec2(1.0)) && device.z > 0.0 {
        let pixel = pixel_from_ndc(device.xy);
        let color = color_at(pixel);
        let is_there = nearest_scene_depth(vec2<i32>(pixel)) <= 0.0
            && any(color != color_in(scene_before, pixel));
        return Painted(is_there, color);
    }
#endif
    return Painted(false, vec4(0.0));
}

// The end of a ray on screen, where it leaves the viewport or comes to its vanishing point.
struct Track {
    start: vec3<f32>,
    end: vec3<f32>,
    // Whether it comes to its vanishing point there.
    vanishes: bool,
}

// Along a ray the screen position and the device depth are affine in each other.
fn track(position: vec3<f32>, direction: vec3<f32>) -> Track {
    let start = device_from_view(position);
    let clip = view.clip_from_view * vec4(direction, 0.0);
    var end: vec3<f32>;
    if clip.w > 1e-6 {
        end = clip.xyz / clip.w;
    } else {
        // Parallel to the screen, towards the eye, or orthographic: as far as the depths go.
        let far = 1e3 * (abs(position.z) + surface.radius);
        let t = select(far, start.z / -clip.z, clip.z < 0.0 && clip.w >= 0.0);
        end = device_from_view(position + t * direction);
        if clip.w < 0.0 {
            end = start;
        }
    }
    let recedes = clip.w > 1e-6 || (clip.w >= 0.0 && clip.z < 0.0);
    let way = end - start;
    // Distance to the border along each axis, as a fraction of the way.
    let border = select(vec2(-1.0), vec2(1.0), way.xy >= vec2(0.0));
    let reach = select(vec2(1e9), (border - start.xy) / way.xy, abs(way.xy) > vec2(1e-9));
    let fraction = clamp(min(reach.x, reach.y), 0.0, 1.0);
    return Track(start, start + fraction * way, recedes && fraction >= 1.0);
}

// A track on screen: (pixel, device depth) at its start, and the way to its end.
struct Way {
    start: vec3<f32>,
    step: vec3<f32>,
}

fn way_of(track: Track) -> Way {
    let start = vec3(pixel_from_ndc(track.start.xy), track.start.z);
    let end = vec3(pixel_from_ndc(track.end.xy), track.end.z);
    return Way(start, end - start);
}

fn scene_depth_on(way: Way, s: f32) -> f32 {
    let pixel = vec2<i32>(way.start.xy + s * way.step.xy);
    return nearest_scene_depth(clamp(pixel, vec2(0), vec2<i32>(frame.view_size) - 1));
}

// How far behind the scene the ray is at `s`, in device depth (reverse z).
fn gap_on(way: Way, s: f32) -> f32 {
    return scene_depth_on(way, s) - (way.start.z + s * way.step.z);
}

// Point between `low`, in front of the scene, and `high`, behind it, where the ray meets the scene.
// Over a plane the gap is linear and one step along the line is enough; at a step in depth the
// interval is halved.
fn meeting_on(way: Way, low: vec2<f32>, high: vec2<f32>) -> f32 {
    let slope = (high.y - low.y) / (high.x - low.x);
    let zero = low.x - low.y / slope;
    let gap = gap_on(way, zero);
    if abs(gap) <= 0.1 * (high.y - low.y) {
        return zero - gap / slope;
    }
    var ends = select(vec2(zero, high.x), vec2(low.x, zero), gap > 0.0);
    for (var k = 0; k < HALVINGS; k += 1) {
        let middle = 0.5 * (ends.x + ends.y);
        ends = select(vec2(middle, ends.y), vec2(ends.x, middle), gap_on(way, middle) > 0.0);
    }
    return ends.y;
}

// The scene's colour where the ray meets its depth. A ray that meets nothing up to its vanishing
// point shows what is on screen there: the sky, or whatever has no depth, such as glass. `straight`
// is the pixel itself, for rays that are lost behind something near the eye.
fn background(
    straight: vec2<f32>, position: vec3<f32>, direction: vec3<f32>, starts_on_screen: bool,
) -> vec4<f32> {
    let track = track(position, direction);
    let way = way_of(track);
    let steps = clamp(ceil(length(way.step.xy) / STEP_PIXELS), 4.0, MAX_STEPS);
    // (s, gap) where the ray was last in sight.
    var before = vec2(0.0, gap_on(way, 0.0));
    var hidden = false;
    for (var i = 1.0; i <= steps; i += 1.0) {
        let at = vec2(i / steps, gap_on(way, i / steps));
        if at.y <= 0.0 {
            before = at;
            hidden = false;
            continue;
        }
        let map = depth_map(track.start.xy);
        let entry = view_depth(map, way.start.z + before.x * way.step.z);
        let slack = 4.0 * surface.radius + 0.05 * entry;
        // It is met if it lies within the step, not if it covers the ray from nearer the eye.
        let scene_depth = at.y + way.start.z + at.x * way.step.z;
        if view_depth(map, scene_depth) < entry - slack {
            hidden = true;
            continue;
        }
        if hidden {
            // Somewhere behind the thing that covers the ray.
            return color_at(way.start.xy + at.x * way.step.xy);
        }
        // At the start it may be behind already.
        let low = vec2(before.x, min(before.y, -1e-9));
        return color_at(way.start.xy + meeting_on(way, low, at) * way.step.xy);
    }
    let painted = painted_behind(position, direction);
    if painted.is_there {
        return painted.color;
    }
    if hidden {
        return color_at(straight);
    }
    if track.vanishes && starts_on_screen {
        return color_at(way.start.xy + way.step.xy);
    }
    let is_clear = lighting.environment_intensity <= 0.0;
    return vec4(environment(direction), select(1.0, lighting.clear_color.a, is_clear));
}

// Premultiplied light of the liquid itself and of the background through it. Alpha is what the
// liquid takes from light of no colour, over the alpha of the background.
fn light_through(
    pixel: vec2<f32>, front: f32, own: vec3<f32>, transmitted: vec3<f32>, behind: vec4<f32>,
) -> vec4<f32> {
    var color = own + transmitted * behind.rgb;
#ifdef HAZE
    // What is behind lies in haze as far as from the eye already, so that only the part of its light
    // that the liquid takes is replaced by that of the haze before the liquid.
    let is_outside = front < INSIDE_FRONT;
    let position = select(vec3(0.0), view_from_device(ndc_from_pixel(pixel), front), is_outside);
    let haze = haze_before(position, pixel / frame.view_size);
    color = own * haze.transmitted + haze.added * (1.0 - transmitted) + transmitted * behind.rgb;
#endif
    let taken = 1.0 - dot(transmitted, vec3(1.0 / 3.0));
    return vec4(min(color, vec3(MAX_HALF)), mix(behind.a, 1.0, taken));
}
