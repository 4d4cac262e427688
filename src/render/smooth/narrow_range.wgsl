// The narrow-range filter, one dimension at a time: Truong & Yuksel, "A Narrow-Range Filter for
// Screen-Space Fluid Rendering", 2018. Taps much nearer than the centre count for nothing, taps
// much farther are drawn up to just behind it; the range widens as taps prove to belong.

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::device_depth
#import bevy_fluid::render::smooth::window::{
    accept, edge_weight, raw_tap_at, smoothing, valid_layers, view_depths, window_at,
}

struct Range {
    // How much nearer and farther than the centre a tap may be.
    nearer: vec2<f32>,
    farther: vec2<f32>,
    total: vec2<f32>,
    sum: vec2<f32>,
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let window = window_at(position);
    if !any(window.valid) {
        return window.center;
    }
    // A back is viewed from behind: nearer and farther are swapped.
    let towards = vec2(1.0, -1.0);
    let delta = vec2(smoothing.range);
    var range = Range(delta, delta, vec2(1.0), vec2(0.0));
    // σ is half of the half window.
    let falloff = 2.0 / (window.half_taps * window.half_taps);
    for (var i = 1; i <= #{HALF_TAPS}; i += 1) {
        let edge = edge_weight(window, i) * exp(-falloff * f32(i * i));
        for (var side = -1; side <= 1; side += 2) {
            let offset = select(vec2(side * i, 0), vec2(0, side * i), #{LINE} == 1);
            let value = raw_tap_at(window, offset);
            let there = window.valid & valid_layers(value.xy);
            let away = towards * (view_depths(window.map, value.xy) - window.depth);
            let near_ok = away >= -range.nearer;
            let far_ok = away <= range.farther;
            let counts = there & near_ok;
            let drawn_up = select(vec2(surface.radius), away, far_ok);
            range.total += select(vec2(0.0), vec2(edge), counts);
            range.sum += select(vec2(0.0), edge * towards * drawn_up, counts);
            let belongs = counts & far_ok;
            range.nearer = max(range.nearer, select(vec2(0.0), delta - away, belongs));
            range.farther = max(range.farther, select(vec2(0.0), delta + away, belongs));
        }
    }
    let z = window.depth + range.sum / range.total;
    let fitted = vec2(device_depth(window.map, z.x), -device_depth(window.map, z.y));
    return vec4(accept(window, fitted, range.total > vec2(1.0)), 0.0, 0.0);
}
