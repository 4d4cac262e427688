// A bilateral filter of view depth: thesis 3.2, equation 3.1.

#import bevy_fluid::render::functions::device_depth
#import bevy_fluid::render::smooth::window::{
    accept, edge_weight, tap_at, view_depths, window_at,
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let window = window_at(position);
    if !any(window.valid) {
        return window.center;
    }
    // σ₁ = w / (2√2): exp(−(m² + n²) / 2σ₁²) = exp(−4 (m² + n²) / w²).
    let falloff = 4.0 / (window.half_taps * window.half_taps);
    var total = vec2(0.0);
    var sum = vec2(0.0);
    for (var j = -#{HALF_TAPS}; j <= #{HALF_TAPS}; j += 1) {
        for (var i = -#{HALF_TAPS}; i <= #{HALF_TAPS}; i += 1) {
            let tap = tap_at(window, vec2(i, j), edge_weight(window, i) * edge_weight(window, j));
            let w = tap.weight * exp(-falloff * f32(i * i + j * j));
            // A missing tap has no depth that could be multiplied by 0.
            let apart = view_depths(window.map, tap.value.xy) - window.depth;
            total += w;
            sum += select(vec2(0.0), w * apart, w > vec2(0.0));
        }
    }
    let z = window.depth + sum / max(total, vec2(1e-20));
    let fitted = vec2(device_depth(window.map, z.x), -device_depth(window.map, z.y));
    return vec4(accept(window, fitted, total > vec2(0.0)), 0.0, 0.0);
}
