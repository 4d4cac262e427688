// The window of a smoothing pass: taps spread over the projected particle radius.
#define_import_path bevy_fluid::render::smooth::window

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::{
    DepthMap, depth_map, depth_slope, has_back, has_front, ndc_from_pixel,
    pixel_from_texture, pixels_per_metre, view_depth, view_from_device,
}
#import bevy_fluid::render::slopes::layers_at
#import bevy_fluid::render::types::INSIDE_FRONT

struct Smoothing {
    // Half window in particle radii; 0: in pixels, one per tap.
    window_radii: f32,
    // Half of the smallest window, in pixels: where particles are smaller than pixels, neighbouring
    // pixels show different particles, which is noise and not the surface's shape.
    min_half_width: f32,
    // Depth difference of weight exp(-1).
    range: f32,
    // Largest shift in depth.
    bound: f32,
    // Curvature flow: time step, pixels squared.
    flow_step: f32,
}

@group(1) @binding(1) var<uniform> smoothing: Smoothing;

// Pixels between taps at the most: beyond it the window stops growing.
const MAX_SPACING: i32 = 16;

// By how much the range is widened at the most: strands behind strands may rise like a slope.
const MAX_SLACK: f32 = 8.0;

struct Window {
    pixel: vec2<i32>,
    ndc: vec2<f32>,
    map: DepthMap,
    // The centre's layers, which of them are there, and their view depths.
    center: vec4<f32>,
    valid: vec2<bool>,
    depth: vec2<f32>,
    // View depth over device depth at the centre, in units of the range.
    steepness: vec2<f32>,
    spacing: i32,
    // Half width in taps, fractional.
    half_taps: f32,
    // The same in metres.
    half_width: f32,
    // By how much the range and the bound are wider: see `widen`.
    slack: vec2<f32>,
}

struct Tap {
    // The layers' values, and (rows of a separable fit) their slopes along x.
    value: vec4<f32>,
    // Of front and back; 0 where there is nothing, or too far off in depth.
    weight: vec2<f32>,
}

fn valid_layers(value: vec2<f32>) -> vec2<bool> {
    return vec2(has_front(value) && value.x < INSIDE_FRONT, has_back(value));
}

fn view_depths(map: DepthMap, value: vec2<f32>) -> vec2<f32> {
    return vec2(view_depth(map, value.x), view_depth(map, -value.y));
}

fn window_at(position: vec4<f32>) -> Window {
    var out: Window;
    let at = pixel_from_texture(position);
    out.pixel = vec2<i32>(at);
    out.ndc = ndc_from_pixel(at);
    out.map = depth_map(out.ndc);
    out.center = layers_at(out.pixel);
    out.valid = valid_layers(out.center.xy);
    out.depth = view_depths(out.map, out.center.xy);
    out.steepness = depth_slope(out.map, abs(out.center.xy)) / smoothing.range;
    let d = select(-out.center.y, out.center.x, out.valid.x);
    let scale = pixels_per_metre(view_from_device(out.ndc, d));
    let half_taps = f32(#{HALF_TAPS});
    let least = min(smoothing.min_half_width, half_taps);
    let half_width = max(smoothing.window_radii * surface.radius * scale, least);
    let spacing = clamp(i32(ceil(half_width / half_taps)), 1, MAX_SPACING);
    let in_radii = smoothing.window_radii > 0.0;
    out.spacing = select(1, spacing, in_radii);
    out.half_taps = select(half_taps, min(half_width / f32(spacing), half_taps), in_radii);
    out.half_width = out.half_taps * f32(out.spacing) / scale;
    out.slack = vec2(1.0);
    return out;
}

// How far the surface's own slope takes it over half the window along an axis, in units of the range;
// from taps half as far, which are on the same strand. It goes on one way: a step on one side is
// left out by the smaller of both, a ridge by their signs.
fn slant(window: Window, axis: vec2<i32>) -> vec2<f32> {
    if smoothing.window_radii <= 0.0 {
        return vec2(0.0);
    }
    let reach = max(i32(0.5 * window.half_taps + 0.5), 1);
    let ahead = raw_tap_at(window, reach * axis).xy;
    let behind = raw_tap_at(window, -reach * axis).xy;
    let rise = (ahead - window.center.xy) * window.steepness;
    let fall = (window.center.xy - behind) * window.steepness;
    let goes_on = valid_layers(ahead) & valid_layers(behind) & (rise * fall > vec2(0.0));
    let step = select(vec2(0.0), min(abs(rise), abs(fall)), goes_on);
    return step * (window.half_taps / f32(reach));
}

// Seen at a grazing angle, or over pixels larger than particles, a surface leaves the range within
// the window: the range follows it there.
fn widen(window: ptr<function, Window>, slant: vec2<f32>) {
    let slack = clamp(slant, vec2(1.0), vec2(MAX_SLACK));
    (*window).slack = slack;
    (*window).steepness /= slack;
}

// How much of a tap lies in the window: the outermost ones fade, so that nothing pops when the
// window grows by a pixel.
fn edge_weight(window: Window, tap: i32) -> f32 {
    let faded = clamp(window.half_taps + 0.5 - f32(abs(tap)), 0.0, 1.0);
    return select(1.0, faded, smoothing.window_radii > 0.0);
}

// A tap's values.
fn raw_tap_at(window: Window, offset: vec2<i32>) -> vec4<f32> {
    return layers_at(window.pixel + offset * window.spacing);
}

fn tap_at(window: Window, offset: vec2<i32>, edge: f32) -> Tap {
    var out: Tap;
    if edge <= 0.0 {
        return out;
    }
    out.value = raw_tap_at(window, offset);
    // To first order: where it matters, taps are near.
    let apart = (out.value.xy - window.center.xy) * window.steepness;
    let weight = edge * exp(-apart * apart);
    out.weight = select(vec2(0.0), weight, window.valid & valid_layers(out.value.xy));
    return out;
}

// The new layers, except where the fit went too far, was degenerate or there was nothing to fit.
fn accept(window: Window, fitted: vec2<f32>, good: vec2<bool>) -> vec2<f32> {
    let moved = abs(view_depths(window.map, fitted) - window.depth);
    let near_enough = moved <= smoothing.bound * window.slack;
    let in_range = vec2(fitted.x > 0.0 && fitted.x < INSIDE_FRONT, fitted.y < 0.0 && fitted.y >= -1.0);
    let out = select(window.center.xy, fitted, window.valid & good & near_enough & in_range);
    // Fitted each on its own, front and back of a thin sheet may pass each other: no thickness
    // then.
    let crossed = all(window.valid) && out.x < -out.y;
    return vec2(out.x, select(out.y, -out.x, crossed));
}
