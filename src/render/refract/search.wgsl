// Finding the next interface along a ray (METHOD 5).
#define_import_path bevy_fluid::render::refract::search

#import bevy_fluid::render::bindings::{body, view}
#import bevy_fluid::render::functions::{pixel_from_ndc, pixels_per_metre}
#import bevy_fluid::render::refract::layers::{
    BACK, FRONT, clamp_to_view, layer_depth, on_screen, scene_view_depth,
}
#import bevy_fluid::render::types::{
    STATUS_BUDGET, STATUS_HIT, STATUS_INVALID, STATUS_LEFT_LAYER, STATUS_NO_BRACKET,
}

// What a ray is looking for.
struct Target {
    kind: u32,
    // Leaving the liquid: the back layer, and with `both` the front layer as well (after a total
    // reflection a ray may come back). Otherwise entering: the front layer.
    leaving: bool,
    both: bool,
    // The opaque scene instead of a layer.
    scene: bool,
}

// How far past the target a point is: negative before it, positive behind it.
struct Gap {
    // Whether there is a layer at all; if not, `value` holds only the sign: outside of the
    // liquid, so before a front and behind a back.
    known: bool,
    value: f32,
    side: u32,
    seen: bool,
}

struct Found {
    status: u32,
    t: f32,
    side: u32,
}

const EVALUATIONS: i32 = 8;
const SECANT_EVALUATIONS: i32 = 16;

// Where a point is on screen; points behind the eye are nowhere.
fn pixel_of(position: vec3<f32>) -> vec2<f32> {
    let clip = view.clip_from_view * vec4(position, 1.0);
    return select(vec2(NOWHERE), pixel_from_ndc(clip.xy / clip.w), clip.w > 0.0);
}

const NOWHERE: f32 = -1e9;

// How often this pixel has asked a layer: what a search costs.
var<private> evaluations: u32;

fn gap_at(to: Target, position: vec3<f32>) -> Gap {
    evaluations += select(1u, 0u, to.scene);
    let pixel = pixel_of(position);
    let z = -position.z;
    var out = Gap(false, select(-1.0, 1.0, to.leaving), select(FRONT, BACK, to.leaving), on_screen(pixel));
    if pixel.x == NOWHERE {
        return out;
    }
    // Off the screen the liquid and the solids are taken to go on as they are at its border;
    // droplets are not.
    let asked = clamp_to_view(pixel);
    if to.scene {
        let scene = scene_view_depth(asked);
        out.known = scene.there;
        out.value = select(-1.0, z - scene.z, scene.there);
        return out;
    }
    if !to.leaving {
        let front = layer_depth(to.kind, FRONT, asked);
        out.known = front.there && out.seen;
        out.value = select(-1.0, z - front.z, out.known);
        return out;
    }
    let back = layer_depth(to.kind, BACK, asked);
    if !back.there {
        return out;
    }
    out.known = true;
    out.value = z - back.z;
    if to.both {
        let front = layer_depth(to.kind, FRONT, asked);
        if front.there && front.z - z > out.value {
            out.value = front.z - z;
            out.side = FRONT;
        }
    }
    return out;
}

// Half a pixel, or a fiftieth of a particle.
fn tolerance(position: vec3<f32>) -> f32 {
    return max(0.5 / pixels_per_metre(position), 0.02 * body.radius);
}

// A bracket [low, high] whose ends may be known by their sign only.
struct Bracket {
    low: f32,
    low_gap: Gap,
    high: f32,
    high_gap: Gap,
}

// Between an end of the bracket and a point that is near enough, the line through both gaps comes
// nearer still, at no cost.
fn polished(t: f32, gap: Gap, end: f32, end_gap: Gap) -> f32 {
    let slope = gap.value - end_gap.value;
    if !end_gap.known || slope == 0.0 {
        return t;
    }
    let better = t - gap.value * (t - end) / slope;
    // No farther than the gap itself warrants.
    return clamp(better, t - 2.0 * abs(gap.value), t + 2.0 * abs(gap.value));
}

// Halving while an end is known by its sign only, Anderson–Björck steps otherwise.
fn refine(to: Target, origin: vec3<f32>, direction: vec3<f32>, start: Bracket, evaluations: i32) -> Found {
    var b = start;
    // Anderson–Björck scales the value of an end that stays.
    var low_value = b.low_gap.value;
    var high_value = b.high_gap.value;
    var last = 0;
    for (var i = 0; i < evaluations; i += 1) {
        var t = 0.5 * (b.low + b.high);
        if b.low_gap.known && b.high_gap.known {
            let secant = b.low - low_value * (b.high - b.low) / (high_value - low_value);
            if secant > b.low && secant < b.high {
                t = secant;
            }
        }
        let position = origin + t * direction;
        let gap = gap_at(to, position);
        let near_enough = tolerance(position);
        if gap.known && abs(gap.value) <= near_enough {
            let below = gap.value < 0.0;
            let end = select(b.low, b.high, below);
            var end_gap = b.low_gap;
            if below {
                end_gap = b.high_gap;
            }
            return Found(STATUS_HIT, polished(t, gap, end, end_gap), gap.side);
        }
        if gap.value < 0.0 {
            if last == -1 && b.low_gap.known {
                let m = 1.0 - gap.value / low_value;
                high_value *= select(0.5, m, m > 0.0);
            }
            b.low = t;
            b.low_gap = gap;
            low_value = gap.value;
            last = -1;
        } else {
            if last == 1 && b.high_gap.known {
                let m = 1.0 - gap.value / high_value;
                low_value *= select(0.5, m, m > 0.0);
            }
            b.high = t;
            b.high_gap = gap;
            high_value = gap.value;
            last = 1;
        }
        if b.high - b.low <= 0.5 * near_enough {
            // A step in depth, or the silhouette: there is nothing in between to converge to.
            if b.low_gap.known && b.high_gap.known && to.leaving {
                return Found(STATUS_HIT, b.low, b.low_gap.side);
            }
            break;
        }
    }
    if to.leaving {
        let status = select(STATUS_LEFT_LAYER, STATUS_BUDGET, b.high_gap.known);
        return Found(status, b.low, select(b.low_gap.side, b.high_gap.side, b.high_gap.known));
    }
    // Entering counts only where the layer really is: rays pass behind droplets.
    let missed = abs(b.high_gap.value) > 4.0 * tolerance(origin + b.high * direction);
    return Found(select(STATUS_BUDGET, STATUS_NO_BRACKET, missed), b.high, b.high_gap.side);
}

// Expanding steps until the gap changes sign, then `refine`.
fn search_bracketed(to: Target, origin: vec3<f32>, direction: vec3<f32>, start: Gap, guess: f32) -> Found {
    var b = Bracket(0.0, start, guess, start);
    var left = EVALUATIONS;
    var step = guess;
    if body.coarse_samples > 0u {
        // As far as twice the guess, evenly.
        step = 2.0 * guess / f32(body.coarse_samples);
        left += i32(body.coarse_samples);
    }
    // The last three evaluations are kept for refining.
    let expansions = left - 3;
    var bracketed = false;
    for (var i = 0; i < expansions; i += 1) {
        let t = b.low + step;
        let gap = gap_at(to, origin + t * direction);
        left -= 1;
        if gap.value >= 0.0 {
            if gap.known && gap.value <= tolerance(origin + t * direction) {
                return Found(STATUS_HIT, polished(t, gap, b.low, b.low_gap), gap.side);
            }
            b.high = t;
            b.high_gap = gap;
            bracketed = true;
            break;
        }
        b.low = t;
        b.low_gap = gap;
        if !gap.seen && !to.leaving {
            break;
        }
        if u32(i + 1) >= body.coarse_samples {
            step = max(step, t);
        }
    }
    if !bracketed {
        return Found(STATUS_NO_BRACKET, b.low, b.low_gap.side);
    }
    return refine(to, origin, direction, b, left);
}

// The thesis's secant (3.12): the line through two gaps; distances are halved while
// there is no layer.
fn search_secant(to: Target, origin: vec3<f32>, direction: vec3<f32>, start: Gap, guess: f32) -> Found {
    var t0 = 0.0;
    var g0 = start.value;
    var t1 = guess;
    var side = start.side;
    var met_layer = false;
    for (var i = 0; i < SECANT_EVALUATIONS; i += 1) {
        let gap = gap_at(to, origin + t1 * direction);
        if !gap.known {
            t1 *= 0.5;
            continue;
        }
        if abs(gap.value) <= tolerance(origin + t1 * direction) {
            return Found(STATUS_HIT, t1, gap.side);
        }
        // Without a layer at the start there is no gap to draw a first line from.
        let has_line = (start.known || met_layer) && gap.value != g0;
        let next = select(2.0 * t1, t1 - gap.value * (t1 - t0) / (gap.value - g0), has_line);
        // "Either" of the two is replaced: we replace the one that is farther off.
        if !met_layer || abs(gap.value) <= abs(g0) {
            t0 = t1;
            g0 = gap.value;
        }
        met_layer = true;
        t1 = max(next, 0.0);
        side = gap.side;
    }
    let status = select(STATUS_INVALID, STATUS_BUDGET, met_layer);
    return Found(select(status, STATUS_NO_BRACKET, !to.leaving), t1, side);
}

fn search(to: Target, origin: vec3<f32>, direction: vec3<f32>) -> Found {
    var start = gap_at(to, origin);
    var guess = 4.0 * body.radius;
    // The depth to go, were the target square to the view; never along it.
    let forward = max(abs(direction.z), 0.2);
    if to.leaving && !start.known {
        return Found(STATUS_INVALID, 0.0, start.side);
    }
    if to.both {
        // On a surface by construction: take the first step on trust.
        start.value = min(start.value, -0.01 * body.radius);
        let back = layer_depth(to.kind, BACK, clamp_to_view(pixel_of(origin)));
        let front = layer_depth(to.kind, FRONT, clamp_to_view(pixel_of(origin)));
        guess = max(guess, select(0.0, back.z - front.z, front.there));
    } else if to.leaving && start.value >= -tolerance(origin) {
        // Thinner than can be told.
        return Found(STATUS_HIT, 0.0, start.side);
    } else if start.known && start.value >= 0.0 {
        // Entering, and behind it already.
        return Found(STATUS_NO_BRACKET, 0.0, start.side);
    } else if start.known {
        guess = -start.value / forward;
    }
#ifdef SECANT
    return search_secant(to, origin, direction, start, guess);
#else
    return search_bracketed(to, origin, direction, start, guess);
#endif
}

// Whether an opaque surface comes before `t`, and where. Rays that only pass behind something
// on screen do not meet it.
fn meets_scene(origin: vec3<f32>, direction: vec3<f32>, t: f32) -> Found {
    let to = Target(0u, false, false, true);
    let end = gap_at(to, origin + t * direction);
    if !end.known || end.value <= 0.0 {
        return Found(STATUS_NO_BRACKET, t, FRONT);
    }
    let start = gap_at(to, origin);
    if start.known && start.value > tolerance(origin) {
        return Found(STATUS_NO_BRACKET, t, FRONT);
    }
    var before = start;
    before.value = min(before.value, -1e-3 * body.radius);
    let found = refine(to, origin, direction, Bracket(0.0, before, t, end), EVALUATIONS);
    let gap = gap_at(to, origin + found.t * direction);
    let met = gap.known && abs(gap.value) <= body.radius;
    return Found(select(STATUS_NO_BRACKET, STATUS_HIT, met), found.t, FRONT);
}
