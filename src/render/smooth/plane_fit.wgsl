// Planes fitted to device depth: a weighted linear regression over pixel offsets, front and back
// at once.

#import bevy_fluid::render::functions::{encode_normal, normal_from_slope}
#import bevy_fluid::render::slopes::one_sided_slope
#import bevy_fluid::render::smooth::window::{
    Tap, Window, accept, edge_weight, slant, smoothing, tap_at, widen, window_at,
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

// Weighted sums over taps to one side of the centre, of fronts and backs. Depths are relative to the
// centre's, as device depths differ in their last digits only, in units of the range.
struct Sums {
    count: vec2<f32>,
    weight: vec2<f32>,
    x: vec2<f32>,
    xx: vec2<f32>,
    d: vec2<f32>,
    xd: vec2<f32>,
    dd: vec2<f32>,
    // Of slopes along x.
    across: vec2<f32>,
}

fn add(sums: ptr<function, Sums>, x: f32, d: vec2<f32>, across: vec2<f32>, w: vec2<f32>) {
    (*sums).count += vec2<f32>(w > vec2(0.0));
    (*sums).weight += w;
    (*sums).x += w * x;
    (*sums).xx += w * x * x;
    (*sums).d += w * d;
    (*sums).xd += w * x * d;
    (*sums).dd += w * d * d;
    (*sums).across += w * across;
}

fn both(a: Sums, b: Sums) -> Sums {
    return Sums(
        a.count + b.count, a.weight + b.weight, a.x + b.x, a.xx + b.xx, a.d + b.d, a.xd + b.xd,
        a.dd + b.dd, a.across + b.across,
    );
}

// The weight of a tap by its distance, in a window of `half_taps` to each side. Towards the window's border
// it fades, or particles that enter the window from pixel to pixel and frame to frame would shake the
// slope, for which taps count by their distance.
fn fading(half_taps: f32, tap: i32) -> f32 {
    let q = f32(tap) / (half_taps + 0.5);
    return select(1.0, max(1.0 - q * q, 0.0), smoothing.window_radii > 0.0);
}

// Sums over the taps to one side, in the window and in one twice as wide.
struct Side {
    inner: Sums,
    wide: Sums,
}

// How far a tap's layers are from the centre's; 0 where there is nothing, as it may be infinite.
fn relative(window: Window, tap: Tap) -> vec2<f32> {
    let apart = (tap.value.xy - window.center.xy) * window.steepness;
    return select(vec2(0.0), apart, tap.weight > vec2(0.0));
}

fn to_side(window: Window, axis: vec2<i32>, side: i32) -> Side {
    var inner: Sums;
    var wide: Sums;
    for (var t = 1; t <= #{HALF_TAPS}; t += 1) {
        let near = fading(window.half_taps, t);
#ifdef WIDE
        let far = fading(2.0 * window.half_taps, t);
        let tap = tap_at(window, side * t * axis, far);
        let d = relative(window, tap);
        add(&inner, f32(side * t), d, tap.value.zw, near / max(far, 1e-3) * tap.weight);
        add(&wide, f32(side * t), d, tap.value.zw, tap.weight);
#else
        let tap = tap_at(window, side * t * axis, near);
        add(&inner, f32(side * t), relative(window, tap), tap.value.zw, tap.weight);
#endif
    }
#ifdef WIDE
    // Beyond, where the surface is smooth already, every other one.
    for (var t = #{HALF_TAPS} + 2; t <= 2 * #{HALF_TAPS}; t += 2) {
        let tap = tap_at(window, side * t * axis, 2.0 * fading(2.0 * window.half_taps, t));
        add(&wide, f32(side * t), relative(window, tap), tap.value.zw, tap.weight);
    }
#endif
    return Side(inner, wide);
}

struct Fit {
    // At the centre, relative to it, and per tap.
    depth: vec2<f32>,
    slope: vec2<f32>,
    across: vec2<f32>,
    // Two taps do not smooth, but they do have a slope.
    sloped: vec2<bool>,
    good: vec2<bool>,
    // Mean squared distance of the taps from it.
    error: vec2<f32>,
}

fn fit(sums: Sums) -> Fit {
    let total = max(sums.weight, vec2(1e-20));
    let mx = sums.x / total;
    let md = sums.d / total;
    let cxx = sums.xx / total - mx * mx;
    let cxd = sums.xd / total - mx * md;
    let sloped = cxx > vec2(1e-4);
    let slope = select(vec2(0.0), cxd / select(vec2(1.0), cxx, sloped), sloped);
    return Fit(
        md - slope * mx, slope, sums.across / total, sloped, sloped & (sums.count >= vec2(3.0)),
        max(sums.dd / total - md * md - slope * cxd, vec2(0.0)),
    );
}

// How well taps at a mean squared distance from a line lie on it: from 1 down.
fn straight(error: vec2<f32>, bend: f32) -> vec2<f32> {
    let part = 1.0 / (1.0 + error / (bend * bend));
    return max(part * part * part * part, vec2(1e-12));
}

// Mean distance of the taps from a line, over half the window's width, from which on there is a
// crease; and how much more the fit to the whole window counts than one to a side if both are as
// good. By measurement: below, bumps and curves are taken for creases, and half a window is noisier.
// Where the range is wider (see `widen`), so is this: distances in depth are long at grazing angles.
const CREASE: f32 = 0.1;
const WHOLE: f32 = 100.0;
// The same two of a window twice as wide, from which a flat surface's slope is taken: no bump of a
// single particle tilts it. By measurement: waves three times as long as the wide window keep theirs.
const FLAT: f32 = 0.015;
const WIDE_COUNTS: f32 = 2000.0;

// Along rows (LINE = 0) or columns (1). Rows pass on their slope; columns average it. Where the whole
// window does not lie on a line but one half of it does, that half counts: a crease keeps its edge
// (weights as in essentially non-oscillatory schemes, Jiang & Shu 1996).
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
    var center: Sums;
    add(&center, 0.0, vec2(0.0), window.center.zw, vec2<f32>(window.valid));
    let to_left = to_side(window, axis, -1);
    let to_right = to_side(window, axis, 1);
    let before = fit(both(to_left.inner, center));
    let after = fit(both(center, to_right.inner));
    let whole = fit(both(both(to_left.inner, center), to_right.inner));
    let half_width = window.half_width / smoothing.range;
    let bend = CREASE * half_width;
    let w0 = select(vec2(0.0), straight(before.error, bend), before.good);
    let w1 = select(vec2(0.0), straight(after.error, bend), after.good);
    let w = WHOLE * straight(whole.error, bend);
    let total = w0 + w1 + w;
    let depth = (w0 * before.depth + w1 * after.depth + w * whole.depth) / total;
    var slope = (w0 * before.slope + w1 * after.slope + w * whole.slope) / total;
    var across = (w0 * before.across + w1 * after.across + w * whole.across) / total;
#ifdef WIDE
    let wide = fit(both(both(to_left.wide, center), to_right.wide));
    let w2 = select(vec2(0.0), WIDE_COUNTS * straight(wide.error, 2.0 * FLAT * half_width), wide.good);
    slope = mix(slope, wide.slope, w2 / (total + w2));
    across = mix(across, wide.across, w2 / (total + w2));
#endif
    let to_device = 1.0 / window.steepness;
    let layers = accept(window, window.center.xy + depth * to_device, whole.good);
    var per_pixel = slope * to_device / f32(window.spacing);
    if any(window.valid & !whole.sloped) {
        // So steep that all taps are out of range: the slope to the next pixel is used instead.
        let beside = one_sided_slope(window.pixel, window.center.xy, axis);
        per_pixel = select(beside, per_pixel, whole.sloped);
    }
#ifdef NORMALS
    out.layers = vec4(layers, 0.0, 0.0);
    out.normals = encode_normals(window, layers, across, per_pixel);
#else
    out.layers = output(vec4(layers, per_pixel));
#endif
    return out;
}
#endif
