// Planes fitted to device depth: a weighted linear regression over pixel offsets, front and back
// at once.

#import bevy_fluid::render::functions::{encode_normal, normal_from_slope}
#import bevy_fluid::render::slopes::one_sided_slope
#import bevy_fluid::render::smooth::window::{
    Window, accept, edge_weight, slant, tap_at, widen, window_at,
}

struct Output {
#ifdef TO_SLOPES
    @location(0) layers: vec4<u32>,
#else
    @location(0) layers: vec4<f32>,
#endif
#ifdef NORMALS
    @location(1) normals: vec4<f32>,
#endif
}

#ifdef NORMALS
fn encode_normals(window: Window, layers: vec2<f32>, slope_x: vec2<f32>, slope_y: vec2<f32>) -> vec4<f32> {
    let front = normal_from_slope(window.ndc, layers.x, vec2(slope_x.x, slope_y.x));
    let back = normal_from_slope(window.ndc, -layers.y, -vec2(slope_x.y, slope_y.y));
    return vec4(encode_normal(front), encode_normal(back));
}
#endif

#ifdef WHOLE_WINDOW
@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    var window = window_at(position);
    var out: Output;
    out.layers = vec4(window.center.xy, 0.0, 0.0);
    if !any(window.valid) {
        return out;
    }
    widen(&window, slant(window, vec2(1, 0)) + slant(window, vec2(0, 1)));
    var count = vec2(0.0);
    var s = vec2(0.0);
    var sx = vec2(0.0);
    var sy = vec2(0.0);
    var sxx = vec2(0.0);
    var sxy = vec2(0.0);
    var syy = vec2(0.0);
    var sd = vec2(0.0);
    var sxd = vec2(0.0);
    var syd = vec2(0.0);
    for (var j = -#{HALF_TAPS}; j <= #{HALF_TAPS}; j += 1) {
        for (var i = -#{HALF_TAPS}; i <= #{HALF_TAPS}; i += 1) {
            let tap = tap_at(window, vec2(i, j), edge_weight(window, i) * edge_weight(window, j));
            let w = tap.weight;
            // Relative to the centre: device depths differ in their last digits only.
            let wd = w * (tap.value.xy - window.center.xy);
            let x = f32(i);
            let y = f32(j);
            count += vec2<f32>(w > vec2(0.0));
            s += w;
            sx += w * x;
            sy += w * y;
            sxx += w * x * x;
            sxy += w * x * y;
            syy += w * y * y;
            sd += wd;
            sxd += wd * x;
            syd += wd * y;
        }
    }
    let total = max(s, vec2(1e-20));
    let mx = sx / total;
    let my = sy / total;
    let md = sd / total;
    let cxx = sxx / total - mx * mx;
    let cxy = sxy / total - mx * my;
    let cyy = syy / total - my * my;
    let cxd = sxd / total - mx * md;
    let cyd = syd / total - my * md;
    let det = cxx * cyy - cxy * cxy;
    let good = (count >= vec2(3.0)) & (det > 1e-4 * cxx * cyy);
    let safe = select(vec2(1.0), det, good);
    let slope_x = select(vec2(0.0), (cyy * cxd - cxy * cyd) / safe, good);
    let slope_y = select(vec2(0.0), (cxx * cyd - cxy * cxd) / safe, good);
    let fitted = window.center.xy + md - slope_x * mx - slope_y * my;
    let layers = accept(window, fitted, good);
    out.layers = vec4(layers, 0.0, 0.0);
#ifdef NORMALS
    let per_pixel = 1.0 / f32(window.spacing);
    out.normals = encode_normals(window, layers, slope_x * per_pixel, slope_y * per_pixel);
#endif
    return out;
}
#endif

#ifdef LINE
#ifdef TO_SLOPES
fn output(layers: vec4<f32>) -> vec4<u32> {
    return bitcast<vec4<u32>>(layers);
}
#else
fn output(layers: vec4<f32>) -> vec4<f32> {
    return layers;
}
#endif

// Along rows (LINE = 0) or columns (1). Rows pass on their slope; columns average it.
@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> Output {
    var window = window_at(position);
    var out: Output;
    out.layers = output(vec4(window.center.xy, 0.0, 0.0));
    if !any(window.valid) {
        return out;
    }
    let axis = select(vec2(1, 0), vec2(0, 1), #{LINE} == 1);
    widen(&window, slant(window, axis));
    // The centre has been read already.
    var count = vec2<f32>(window.valid);
    var s = count;
    var sx = vec2(0.0);
    var sxx = vec2(0.0);
    var sd = vec2(0.0);
    var sxd = vec2(0.0);
    var across = s * window.center.zw;
    for (var t = -#{HALF_TAPS}; t < #{HALF_TAPS}; t += 1) {
        let i = select(t, t + 1, t >= 0);
        let tap = tap_at(window, i * axis, edge_weight(window, i));
        let w = tap.weight;
        let wd = w * (tap.value.xy - window.center.xy);
        let x = f32(i);
        count += vec2<f32>(w > vec2(0.0));
        s += w;
        sx += w * x;
        sxx += w * x * x;
        sd += wd;
        sxd += wd * x;
        across += w * tap.value.zw;
    }
    let total = max(s, vec2(1e-20));
    let mx = sx / total;
    let md = sd / total;
    let cxx = sxx / total - mx * mx;
    let cxd = sxd / total - mx * md;
    // Two taps do not smooth, but they do have a slope.
    let sloped = cxx > vec2(1e-4);
    let slope = select(vec2(0.0), cxd / select(vec2(1.0), cxx, sloped), sloped);
    let good = sloped & (count >= vec2(3.0));
    let layers = accept(window, window.center.xy + md - slope * mx, good);
    var per_pixel = slope / f32(window.spacing);
    if any(window.valid & !sloped) {
        // So steep that all taps are out of range: the slope to the next pixel is used instead.
        let beside = one_sided_slope(window.pixel, window.center.xy, axis);
        per_pixel = select(beside, per_pixel, sloped);
    }
#ifdef NORMALS
    out.layers = vec4(layers, 0.0, 0.0);
    out.normals = encode_normals(window, layers, across / total, per_pixel);
#else
    out.layers = output(vec4(layers, per_pixel));
#endif
    return out;
}
#endif
