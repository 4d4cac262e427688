// Finding the next interface along a ray.
#define_import_path bevy_fluid::render::refract::search

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::{pixel_from_ndc, view_depth}
#import bevy_fluid::render::refract::layers::{
    BACK, FRONT, clamp_to_view, layer_depths, on_screen, scene_depth_at,
}
#import bevy_fluid::render::refract::track::{
    Track, device_at, distance_from_s, in_device_depth, s_from_distance, tolerance, track_of, w_at,
}
#import bevy_fluid::render::types::{
    STATUS_BUDGET, STATUS_HIT, STATUS_INVALID, STATUS_LEFT_LAYER, STATUS_NO_BRACKET,
}

// The target of a search along a ray.
struct Target {
    kind: u32,
    // Leaving the liquid: the back layer, and with `both` the front layer as well (after a total
    // reflection a ray may come back). Otherwise entering: the front layer.
    leaving: bool,
    both: bool,
    // The opaque scene instead of a layer.
    scene: bool,
}

// How far past the target a point of the ray is: negative before it, positive behind it.
struct Gap {
    // Whether there is a layer at all; if not, `value` holds only the sign: outside of the
    // liquid, so before a front and behind a back.
    known: bool,
    // In device depth.
    value: f32,
    // Within how much of it the target counts as met.
    near: f32,
    side: u32,
    // On screen.
    seen: bool,
}

struct Found {
    status: u32,
    // Distance along the ray, m.
    t: f32,
    side: u32,
}

const EVALUATIONS: i32 = 8;
const SECANT_EVALUATIONS: i32 = 16;

// Number of layer samples for this pixel: the cost of its searches.
var<private> evaluations: u32;

fn gap_at(to: Target, track: Track, s: f32) -> Gap {
    evaluations += select(1u, 0u, to.scene);
    let at = device_at(track, s);
    let pixel = pixel_from_ndc(at.xy);
    let near = in_device_depth(track, tolerance(track, s), at.z);
    var out = Gap(false, select(-1.0, 1.0, to.leaving), near, select(FRONT, BACK, to.leaving), on_screen(pixel));
    // Off the screen, the liquid and the solids are assumed to continue as at its border; droplets
    // are not.
    let asked = clamp_to_view(pixel);
    if to.scene {
        let depth = scene_depth_at(asked);
        out.known = depth > 0.0;
        out.value = select(-1.0, depth - at.z, out.known);
        return out;
    }
    let depths = layer_depths(to.kind, asked, track.map);
    if !to.leaving {
        out.known = depths.x > 0.0 && out.seen;
        out.value = select(-1.0, depths.x - at.z, out.known);
        return out;
    }
    if depths.y <= 0.0 {
        return out;
    }
    out.known = true;
    out.value = depths.y - at.z;
    if to.both && depths.x > 0.0 && at.z - depths.x > out.value {
        out.value = at.z - depths.x;
        out.side = FRONT;
    }
    return out;
}

// A bracket [low, high] in s whose ends may be known by their sign only.
struct Bracket {
    low: f32,
    low_gap: Gap,
    high: f32,
    high_gap: Gap,
}

// Where the line through two gaps is zero.
fn zero_of_line(a: f32, a_value: f32, b: f32, b_value: f32) -> f32 {
    let slope = b_value - a_value;
    return select(b, b - b_value * (b - a) / slope, slope != 0.0);
}

// At a point that is near enough, the line to an end on the other side gives a better point at no
// cost.
fn hit(track: Track, s: f32, gap: Gap, end: f32, end_gap: Gap) -> Found {
    let better = zero_of_line(end, end_gap.value, s, gap.value);
    return Found(STATUS_HIT, distance_from_s(track, select(s, better, end_gap.known)), gap.side);
}

// Halving while an end is known by its sign only, Anderson–Björck steps otherwise.
fn refine(to: Target, track: Track, start: Bracket, left: i32) -> Found {
    var b = start;
    // Anderson–Björck scales the value of an end that stays.
    var low_value = b.low_gap.value;
    var high_value = b.high_gap.value;
    var last = 0;
    for (var i = 0; i < left; i += 1) {
        var s = 0.5 * (b.low + b.high);
        if b.low_gap.known && b.high_gap.known {
            let zero = zero_of_line(b.low, low_value, b.high, high_value);
            if zero > b.low && zero < b.high {
                s = zero;
            }
        }
        let gap = gap_at(to, track, s);
        if gap.known && abs(gap.value) <= gap.near {
            if gap.value < 0.0 {
                return hit(track, s, gap, b.high, b.high_gap);
            }
            return hit(track, s, gap, b.low, b.low_gap);
        }
        if gap.value < 0.0 {
            if last == -1 && b.low_gap.known {
                let m = 1.0 - gap.value / low_value;
                high_value *= select(0.5, m, m > 0.0);
            }
            b.low = s;
            b.low_gap = gap;
            low_value = gap.value;
            last = -1;
        } else {
            if last == 1 && b.high_gap.known {
                let m = 1.0 - gap.value / high_value;
                low_value *= select(0.5, m, m > 0.0);
            }
            b.high = s;
            b.high_gap = gap;
            high_value = gap.value;
            last = 1;
        }
        let w = w_at(track, s);
        if (b.high - b.low) * w * w <= 0.5 * tolerance(track, s) * track.w {
            // A step in depth, or the silhouette: there is nothing in between to converge to.
            if b.low_gap.known && b.high_gap.known && to.leaving {
                return Found(STATUS_HIT, distance_from_s(track, b.low), b.low_gap.side);
            }
            break;
        }
    }
    if to.leaving {
        let status = select(STATUS_LEFT_LAYER, STATUS_BUDGET, b.high_gap.known);
        let side = select(b.low_gap.side, b.high_gap.side, b.high_gap.known);
        return Found(status, distance_from_s(track, b.low), side);
    }
    // Entering counts only where the layer really is: rays pass behind droplets.
    let missed = abs(b.high_gap.value) > 4.0 * b.high_gap.near;
    let status = select(STATUS_BUDGET, STATUS_NO_BRACKET, missed);
    return Found(status, distance_from_s(track, b.high), b.high_gap.side);
}

// Rays that have come so far meet nothing. Unit: m.
const FARTHEST: f32 = 1e30;

// Expanding steps until the gap changes sign, then `refine`. `guess` is a distance.
fn search_bracketed(to: Target, track: Track, start: Gap, guess: f32) -> Found {
    var b = Bracket(0.0, start, 0.0, start);
    let coarse = i32(surface.coarse_samples);
    var left = EVALUATIONS + coarse;
    var t = 0.0;
    // As far as twice the guess, evenly.
    var step = select(guess, 2.0 * guess / f32(coarse), coarse > 0);
    // The last three evaluations are kept for refining.
    let expansions = left - 3;
    var bracketed = false;
    for (var i = 0; (i < expansions) & (t < FARTHEST); i += 1) {
        t += step;
        let s = s_from_distance(track, t);
        let gap = gap_at(to, track, s);
        left -= 1;
        if gap.value >= 0.0 {
            if gap.known && gap.value <= gap.near {
                return hit(track, s, gap, b.low, b.low_gap);
            }
            b.high = s;
            b.high_gap = gap;
            bracketed = true;
            break;
        }
        b.low = s;
        b.low_gap = gap;
        if !gap.seen && !to.leaving {
            break;
        }
        if i + 1 >= coarse {
            step = max(step, t);
        }
    }
    if !bracketed {
        return Found(STATUS_NO_BRACKET, distance_from_s(track, b.low), b.low_gap.side);
    }
    return refine(to, track, b, left);
}

// The thesis's secant (3.12): the line through two gaps in view depth over distance; distances
// are halved while there is no layer.
fn search_secant(to: Target, track: Track, start: Gap, guess: f32) -> Found {
    var t0 = 0.0;
    var g0 = metres(track, 0.0, start);
    var t1 = guess;
    var side = start.side;
    var met_layer = false;
    for (var i = 0; i < SECANT_EVALUATIONS; i += 1) {
        let s = s_from_distance(track, t1);
        let gap = gap_at(to, track, s);
        if !gap.known {
            t1 *= 0.5;
            continue;
        }
        if abs(gap.value) <= gap.near {
            return Found(STATUS_HIT, t1, gap.side);
        }
        let g1 = metres(track, s, gap);
        // Without a layer at the start there is no gap to draw a first line from.
        let has_line = (start.known || met_layer) && g1 != g0;
        let next = select(2.0 * t1, zero_of_line(t0, g0, t1, g1), has_line);
        // The thesis replaces "either" of the two; this replaces the one that is farther off.
        if !met_layer || abs(g1) <= abs(g0) {
            t0 = t1;
            g0 = g1;
        }
        met_layer = true;
        t1 = max(next, 0.0);
        side = gap.side;
    }
    let status = select(STATUS_INVALID, STATUS_BUDGET, met_layer);
    return Found(select(status, STATUS_NO_BRACKET, !to.leaving), t1, side);
}

// A gap in view depth, m.
fn metres(track: Track, s: f32, gap: Gap) -> f32 {
    let at = device_at(track, s).z;
    let depth = view_depth(track.map, at) - view_depth(track.map, at + gap.value);
    return select(gap.value, depth, gap.known);
}

fn search(to: Target, origin: vec3<f32>, direction: vec3<f32>) -> Found {
    let track = track_of(origin, direction);
    var start = gap_at(to, track, 0.0);
    var guess = 4.0 * surface.radius;
    if to.leaving && !start.known {
        return Found(STATUS_INVALID, 0.0, start.side);
    }
    if to.both {
        // On a surface by construction: take the first step on trust, and no line through the start,
        // which is as near to the surface as a hit.
        let asked = clamp_to_view(pixel_from_ndc(track.start.xy));
        let depths = layer_depths(to.kind, asked, track.map);
        let deep = view_depth(track.map, depths.y) - view_depth(track.map, depths.x);
        guess = max(guess, select(0.0, deep, depths.x > 0.0));
        start.value = min(start.value, -in_device_depth(track, 0.01 * surface.radius, track.start.z));
        start.known = false;
    } else if to.leaving && start.value >= -start.near {
        // Thinner than the tolerance.
        return Found(STATUS_HIT, 0.0, start.side);
    } else if start.known && start.value >= 0.0 {
        // Entering, and behind it already.
        return Found(STATUS_NO_BRACKET, 0.0, start.side);
    } else if start.known {
        // The depth to go, were the target square to the view; never along it.
        guess = -metres(track, 0.0, start) / max(abs(direction.z), 0.2);
    }
#ifdef SECANT
    return search_secant(to, track, start, guess);
#else
    return search_bracketed(to, track, start, guess);
#endif
}

// Whether an opaque surface comes before `t`, and where. Rays that only pass behind something
// on screen do not meet it.
fn meets_scene(origin: vec3<f32>, direction: vec3<f32>, t: f32) -> Found {
    let to = Target(0u, false, false, true);
    let track = track_of(origin, direction);
    let s = s_from_distance(track, t);
    let end = gap_at(to, track, s);
    if !end.known || end.value <= 0.0 {
        return Found(STATUS_NO_BRACKET, t, FRONT);
    }
    let start = gap_at(to, track, 0.0);
    if start.known && start.value > start.near {
        return Found(STATUS_NO_BRACKET, t, FRONT);
    }
    var before = start;
    let skin = in_device_depth(track, 1e-3 * surface.radius, track.start.z);
    before.value = min(before.value, -skin);
    let found = refine(to, track, Bracket(0.0, before, s, end), EVALUATIONS);
    let at = s_from_distance(track, found.t);
    let gap = gap_at(to, track, at);
    let near = in_device_depth(track, surface.radius, device_at(track, at).z);
    let met = gap.known && abs(gap.value) <= near;
    return Found(select(STATUS_NO_BRACKET, STATUS_HIT, met), found.t, FRONT);
}
