// Rays on screen.
#define_import_path bevy_fluid::render::refract::track

#import bevy_fluid::render::frame::{frame, surface, view}
#import bevy_fluid::render::functions::{DepthMap, depth_map, depth_slope}

// A ray's position on screen and in device depth is affine in s = t / w: t is the distance along
// the ray, w the clip coordinate there. Over a plane the layers' device depth is affine as well, so
// the gap between a ray and a plane is linear in s for every projection.
struct Track {
    // Device coordinates of the start, and their change with s.
    start: vec3<f32>,
    along: vec3<f32>,
    // Clip w of the start, and its change with t.
    w: f32,
    w_along: f32,
    // Of the start; it is the same everywhere unless the near plane is oblique.
    map: DepthMap,
}

fn track_of(origin: vec3<f32>, direction: vec3<f32>) -> Track {
    let origin_clip = view.clip_from_view * vec4(origin, 1.0);
    let direction_clip = view.clip_from_view * vec4(direction, 0.0);
    let start = origin_clip.xyz / origin_clip.w;
    return Track(
        start, direction_clip.xyz - direction_clip.w * start, origin_clip.w, direction_clip.w,
        depth_map(start.xy),
    );
}

// Short of the plane through the eye, where s is infinite.
fn s_from_distance(track: Track, t: f32) -> f32 {
    let w = track.w + t * track.w_along;
    return select(20.0 * t / track.w, t / w, w > 0.05 * track.w);
}

// Short of it as well: a point there has no place on screen.
fn distance_from_s(track: Track, s: f32) -> f32 {
    let to_eye = select(1e30, -0.999 * track.w / track.w_along, track.w_along < 0.0);
    return min(s * track.w / (1.0 - s * track.w_along), to_eye);
}

fn device_at(track: Track, s: f32) -> vec3<f32> {
    return track.start + s * track.along;
}

fn w_at(track: Track, s: f32) -> f32 {
    return track.w / (1.0 - s * track.w_along);
}

// Lengths along the view (m) in device depth, to first order.
fn in_device_depth(track: Track, metres: f32, device_depth: f32) -> f32 {
    return metres / max(abs(depth_slope(track.map, vec2(device_depth)).x), 1e-30);
}

// How near to a surface is near enough, m: half a pixel, or a fiftieth of a particle.
fn tolerance(track: Track, s: f32) -> f32 {
    let pixel = w_at(track, s) / (frame.view_size.y * abs(view.clip_from_view[1][1]));
    return max(pixel, 0.02 * surface.radius);
}
