// Extinction and radiance of the rain beyond the streaks, and of rain seen so steeply that drops
// are points, without what shelters keep dry.

#import bevy_fluid::rain::draw::common::{
    in_fog, over, rain, scene_view_depth, surroundings, view,
}
#import bevy_fluid::rain::draw::types::{DRY_PLANES, STEEPEST}
#import bevy_render::view::frag_coord_to_ndc

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let uv = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4(uv * 2.0 - 1.0, 1.0, 1.0);
}

struct Ray {
    start: vec3<f32>,
    direction: vec3<f32>,
}

fn view_ray(pixel: vec2<f32>) -> Ray {
    let ndc = frag_coord_to_ndc(vec4(pixel, 0.0, 1.0), view.main_pass_viewport).xy;
    let point = view.view_from_clip * vec4(ndc, 1.0, 1.0);
    let way = (view.world_from_view * vec4(point.xyz / point.w, 0.0)).xyz;
    let across = way - dot(way, rain.forward) * rain.forward;
    let is_perspective = rain.perspective == 1u;
    return Ray(
        select(across, vec3(0.0), is_perspective),
        select(rain.forward, normalize(way), is_perspective),
    );
}

// The part of a stretch of the ray that a shelter keeps dry; one that ends before it starts is none.
fn dry_part(shelter: u32, ray: Ray, stretch: vec2<f32>) -> vec2<f32> {
    var dry = stretch;
    for (var i = 0u; i < DRY_PLANES; i += 1u) {
        let plane = rain.shelters.places[shelter].planes[i];
        let slope = dot(plane.xyz, ray.direction);
        // Not quite parallel to the plane.
        let grows = select(slope, 1e-9, abs(slope) < 1e-9);
        let crossing = -(dot(plane.xyz, ray.start) + plane.w) / grows;
        dry = select(
            vec2(dry.x, min(dry.y, crossing)),
            vec2(max(dry.x, crossing), dry.y),
            grows > 0.0,
        );
    }
    return dry;
}

// The rain in a stretch of a ray that nothing else draws, in metres: all of it beyond the streaks'
// distance, and before that a share.
fn undrawn(stretch: vec2<f32>, share: f32) -> f32 {
    let before = min(stretch, vec2(rain.distance));
    let beyond = max(stretch, vec2(rain.distance));
    return share * (before.y - before.x) + (beyond.y - beyond.x);
}

// The same where shelters keep it dry.
fn undrawn_but_dry(ray: Ray, stretch: vec2<f32>, share: f32) -> f32 {
    var sum = 0.0;
#ifdef SHELTERS
    // Dry places overlap: each time the part that begins first, from the end of the last one on.
    var left = stretch;
    for (var count = 0u; count < rain.shelters.count; count += 1u) {
        var first = vec2(stretch.y);
        for (var i = 0u; i < rain.shelters.count; i += 1u) {
            let dry = dry_part(i, ray, left);
            if dry.x < min(dry.y, first.x) {
                first = dry;
            }
        }
        if first.x >= stretch.y {
            break;
        }
        sum += undrawn(first, share);
        left.x = first.y;
    }
#endif
    return sum;
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let ray = view_ray(position.xy);
    let scene = scene_view_depth(position.xy) / max(dot(ray.direction, rain.forward), 1e-4);
    // Within `distance`: the stretch of individually drawn drops, and that of billboards.
    let along = dot(ray.direction, rain.axis);
    let across = sqrt(max(1.0 - along * along, 0.0));
    let before = min(scene, rain.distance);
    let near = min(rain.drops_end / max(across, 1e-6), before);
    let part = min(across / STEEPEST, 1.0);
    let billboards = (before - near) * mix(floor(part), part, f32(rain.perspective));
    let drops = min(near, rain.drops_reach);
    let share = max(before - drops - billboards, 0.0) / max(before - drops, 1e-6);
    let stretch = vec2(drops, min(scene, max(rain.extent, rain.distance)));
    let length = undrawn(stretch, share) - undrawn_but_dry(ray, stretch, share);
    let opacity = 1.0 - exp(-rain.extinction * length);
    if opacity <= 0.0 {
        discard;
    }
    let direction = ray.direction;
    return over(in_fog(surroundings(direction), direction * rain.distance, direction), opacity);
}
