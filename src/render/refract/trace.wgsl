// A ray through up to four interfaces.
#define_import_path bevy_fluid::render::refract::trace

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::{
    depth_map, device_from_view, ndc_from_pixel, pixel_from_ndc, view_depth, view_from_device,
    view_ray,
}
#import bevy_fluid::render::medium::{reflected, transmitted}
#import bevy_fluid::render::optics::{environment, facing, highlights, meet}
#import bevy_fluid::render::refract::inside::{accumulated_length, medium_source}
#import bevy_fluid::render::refract::layers::{
    BULK, SPRAY, layer_depths, layer_normal, load_layers, on_screen,
}
#import bevy_fluid::render::refract::search::{Target, meets_scene, search}
#import bevy_fluid::render::straight::layered_length
#import bevy_fluid::render::types::{
    INSIDE_FRONT, STATUS_HIT, STATUS_INVALID, STATUS_LEFT_LAYER, STATUS_NO_BRACKET, STATUS_OPAQUE,
    STATUS_TOTAL_REFLECTION,
}

const INTERFACES: u32 = #{INTERFACES}u;
// Whether there is a second class to enter.
const BOTH_CLASSES: bool = #{BOTH_CLASSES};
#ifdef OPAQUE
// Nothing is seen through the surface.
const SEEN_THROUGH: bool = false;
#else
const SEEN_THROUGH: bool = true;
#endif

struct Path {
    position: vec3<f32>,
    direction: vec3<f32>,
    radiance: vec3<f32>,
    transmission: vec3<f32>,
    // In-scattered light and emission per metre of the medium.
    source: vec3<f32>,
    kind: u32,
    first_kind: u32,
    interfaces: u32,
    searches: u32,
    // Four bits a search.
    status: u32,
    // The background is the scene at `position` itself.
    direct: bool,
}

fn note(path: ptr<function, Path>, status: u32) {
    (*path).status |= status << (4u * (*path).searches);
    (*path).searches = min((*path).searches + 1u, 3u);
}

// Crosses an interface, or is totally reflected (false). `n` points out of the liquid.
fn cross_interface(path: ptr<function, Path>, n: vec3<f32>, entering: bool) -> bool {
    let d = (*path).direction;
    let against = facing(select(-n, n, entering), d);
    let eta = select(surface.refractive_index, 1.0 / surface.refractive_index, entering);
    let at = meet(d, against, eta);
    (*path).interfaces += 1u;
    if at.reflectance >= 1.0 {
        (*path).direction = at.reflected;
        // From outside (index below 1) no light enters: only the reflection is visible.
        return false;
    }
    (*path).radiance += (*path).transmission * at.reflectance * environment(at.reflected);
    (*path).transmission *= 1.0 - at.reflectance;
    (*path).direction = at.refracted;
    return true;
}

fn pixel_of(position: vec3<f32>) -> vec2<f32> {
    return pixel_from_ndc(device_from_view(position).xy);
}

// A path through the medium: its light is added to the radiance so far, and its extinction dims
// everything behind it.
fn pass_through(path: ptr<function, Path>, length: f32) {
#ifdef SOURCE
    (*path).radiance += (*path).transmission * reflected((*path).source, surface.extinction, length);
#endif
#ifdef EXTINCTION
    (*path).transmission *= transmitted(surface.extinction, length);
#endif
}

fn advance(path: ptr<function, Path>, t: f32) {
    (*path).position += t * (*path).direction;
}

// How far behind a liquid's surface an opaque one still counts as wetted by it: no air between.
fn contact_along(direction: vec3<f32>, n: vec3<f32>) -> f32 {
    return surface.contact / max(abs(dot(direction, n)), 0.25);
}

// Searches for an opaque surface up to `t`; if one is met, the path ends there.
fn stops(path: ptr<function, Path>, t: f32, inside: bool) -> bool {
    let met = meets_scene((*path).position, (*path).direction, t);
    if met.status != STATUS_HIT {
        return false;
    }
    advance(path, met.t);
    if inside {
        pass_through(path, met.t);
    }
    (*path).direct = true;
    note(path, STATUS_OPAQUE);
    return true;
}

// The straight path length through the liquid at a pixel.
fn straight_length(pixel: vec2<i32>, ndc: vec2<f32>) -> f32 {
#ifdef ACCUMULATED
    return accumulated_length(pixel);
#else ifdef OPAQUE
    // Farther than light reaches.
    return 1e30;
#else
    return layered_length(load_layers(BULK, pixel), load_layers(SPRAY, pixel), pixel, ndc);
#endif
}

// Whether a point is in the liquid of a class. Of the spray only its hindmost droplet counts: there
// may be air between that and the front one.
fn in_liquid(kind: u32, position: vec3<f32>) -> bool {
    let pixel = pixel_of(position);
    if !on_screen(pixel) {
        return false;
    }
    let map = depth_map(ndc_from_pixel(pixel));
    let depths = layer_depths(kind, pixel, map);
    let z = -position.z;
    let to_back = view_depth(map, depths.y) - z;
    return depths.x > 0.0 && depths.y > 0.0 && z > view_depth(map, depths.x)
        && to_back > 0.02 * surface.radius && (kind == BULK || to_back < 2.0 * surface.radius);
}

// How far its faces may lean towards each other (1 - cos) and still be parallel, and where they are not.
// By measurement: at the rim of one particle's sheet they lean by up to 40° without meaning it.
const LEAN: vec2<f32> = vec2(0.4, 0.7);

// The face through which a ray leaves a sheet is parallel to the one through which it came: each has its
// own bumps and rounded edges, which would bend light as the faces of a prism. The thicker the liquid,
// the less may they lean for that, or streams would be no lenses.
fn sheet_normal(n: vec3<f32>, entry: vec3<f32>, thickness: f32) -> vec3<f32> {
    // Not by a branch on the uniform: software drivers compile such shaders anew in each frame.
    let sheets = select(
        1e4, clamp(thickness / max(surface.sheet, 1e-30), 1.0, 1e4), surface.sheet > 0.0,
    );
    let lean = (1.0 + dot(n, entry)) * sheets * sheets * sheets * sheets;
    return normalize(mix(-entry, n, smoothstep(LEAN.x, LEAN.y, lean)));
}

// Follows the path, which came in through a surface of the normal `entry` unless it began inside, until
// the budget is spent or nothing more is met. Every turn looks for one interface: the way out
// of the liquid, or after that the way into the other class.
fn trace(path: ptr<function, Path>, entry: vec3<f32>, began_inside: bool) {
    var leaving = true;
    var both = false;
    var may_enter = BOTH_CLASSES;
    for (var turn = 0u; turn < INTERFACES + u32(BOTH_CLASSES); turn += 1u) {
        if (*path).interfaces >= INTERFACES {
            return;
        }
        let found = search(
            Target((*path).kind, leaving, both, false), (*path).position, (*path).direction,
        );
        let lost = found.status == STATUS_INVALID || found.status == STATUS_NO_BRACKET;
        if select(found.status != STATUS_HIT, lost, leaving) {
            note(path, found.status);
            return;
        }
        let hit = (*path).position + found.t * (*path).direction;
        var n = layer_normal((*path).kind, found.side, pixel_of(hit));
        if turn == 0u && (*path).kind == BULK && !began_inside {
            n = sheet_normal(n, entry, found.t * abs(dot(entry, (*path).direction)));
        }
        let wetted = select(0.0, contact_along((*path).direction, n), leaving);
        if stops(path, found.t + wetted, leaving) {
            return;
        }
        (*path).position = hit;
        if leaving {
            pass_through(path, found.t);
            if BOTH_CLASSES && in_liquid(1u - (*path).kind, hit) {
                // Bulk and spray overlap: no interface lies between them.
                (*path).kind = 1u - (*path).kind;
                may_enter = false;
                both = false;
                continue;
            }
        }
        if !cross_interface(path, n, !leaving) {
            note(path, STATUS_TOTAL_REFLECTION);
            both = true;
            if leaving {
                continue;
            }
            return;
        }
        both = false;
        let on_border = leaving && !on_screen(pixel_of(hit));
        note(path, select(found.status, STATUS_LEFT_LAYER, on_border));
        if leaving {
            if !may_enter {
                return;
            }
            may_enter = false;
            (*path).kind = 1u - (*path).kind;
        }
        leaving = !leaving;
    }
}

// From the eye through a point of the screen, where the nearest surface lies at `front` and has a
// normal.
fn trace_from(at: vec2<f32>, first_kind: u32, front: f32, normal: vec3<f32>) -> Path {
    var path: Path;
    path.first_kind = first_kind;
    path.kind = path.first_kind;
    path.transmission = vec3(1.0);
#ifdef SOURCE
    path.source = medium_source();
#endif
    let ndc = ndc_from_pixel(at);
    let ray = view_ray(ndc);
    path.direction = ray.direction;
    let starts_inside = front >= INSIDE_FRONT;
    path.position = select(view_from_device(ndc, front), ray.origin, starts_inside);
#ifdef INDEX_ONE
    path.direct = true;
    pass_through(&path, straight_length(vec2<i32>(at), ndc));
    path.interfaces = 0u;
#else
    var entered = true;
    let n = facing(normal, ray.direction);
    if !starts_inside {
        path.radiance = highlights(ray.direction, n);
        entered = cross_interface(&path, n, true);
        if !entered {
            // Total reflection outside: only the mirrored surroundings are seen.
            path.radiance += environment(path.direction);
            path.transmission = vec3(0.0);
        }
    }
    if INTERFACES <= 1u {
        // No search: the path is as long as the liquid is deep at this pixel.
        let straight = straight_length(vec2<i32>(at), ndc);
        pass_through(&path, straight);
        if !SEEN_THROUGH || INTERFACES == 0u {
            path.direction = ray.direction;
            path.direct = true;
            path.interfaces = min(path.interfaces, INTERFACES);
        } else {
            advance(&path, straight);
        }
    } else if entered {
        trace(&path, n, starts_inside);
    }
#endif
    if path.direct && INTERFACES <= 1u {
        // The background is looked up at this very pixel.
        path.position = view_from_device(ndc, front);
    }

    return path;
}
