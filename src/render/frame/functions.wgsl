#define_import_path bevy_fluid::render::functions

#import bevy_fluid::render::frame::{frame, scene_depth, view}
#import bevy_fluid::render::types::{NO_BACK, NO_FRONT}

struct Ray {
    origin: vec3<f32>,
    // Unit length.
    direction: vec3<f32>,
}

// The pixel of a fragment drawn to a surface's textures.
fn pixel_from_texture(position: vec4<f32>) -> vec2<f32> {
    return position.xy + vec2<f32>(frame.origin);
}

// The pixel of a fragment drawn to the camera's target.
fn pixel_from_camera(position: vec4<f32>) -> vec2<f32> {
    return position.xy - frame.view_origin;
}

// Where a pixel lies in the surface's textures; pixels beyond them go to the empty margin.
fn texel_at(pixel: vec2<i32>) -> vec2<i32> {
    return clamp(pixel - frame.origin, vec2(0), frame.size - 1);
}

fn ndc_from_pixel(pixel: vec2<f32>) -> vec2<f32> {
    return pixel / frame.view_size * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
}

fn pixel_from_ndc(ndc: vec2<f32>) -> vec2<f32> {
    return (ndc * vec2(0.5, -0.5) + 0.5) * frame.view_size;
}

// The position of a pixel among the surface's textures, for the rasteriser.
fn ndc_in_textures(pixel: vec2<f32>) -> vec2<f32> {
    let texel = pixel - vec2<f32>(frame.origin);
    return texel / vec2<f32>(frame.size) * vec2(2.0, -2.0) + vec2(-1.0, 1.0);
}

// The view ray through a point of the screen, from the near plane on, for any projection.
fn view_ray(ndc: vec2<f32>) -> Ray {
    let near = view.view_from_clip * vec4(ndc, 1.0, 1.0);
    let far = view.view_from_clip * vec4(ndc, 0.0, 1.0);
    // Homogeneous difference: the far point may be at infinity (w = 0).
    let along = far.xyz * near.w - near.xyz * far.w;
    return Ray(near.xyz / near.w, normalize(along * sign(near.w)));
}

fn view_from_device(ndc: vec2<f32>, depth: f32) -> vec3<f32> {
    let position = view.view_from_clip * vec4(ndc, depth, 1.0);
    return position.xyz / position.w;
}

fn device_from_view(position: vec3<f32>) -> vec3<f32> {
    let clip = view.clip_from_view * vec4(position, 1.0);
    return clip.xyz / clip.w;
}

// The map from device depth to view depth (positive forward) along one pixel's ray:
// z = −(numerator · (1, d)) / (denominator · (1, d)).
struct DepthMap {
    numerator: vec2<f32>,
    denominator: vec2<f32>,
}

fn depth_map(ndc: vec2<f32>) -> DepthMap {
    let start = view.view_from_clip * vec4(ndc, 0.0, 1.0);
    let step = view.view_from_clip[2];
    return DepthMap(vec2(start.z, step.z), vec2(start.w, step.w));
}

fn view_depth(map: DepthMap, d: f32) -> f32 {
    return -(map.numerator.x + map.numerator.y * d) / (map.denominator.x + map.denominator.y * d);
}

// Derivative of the view depth by device depth.
fn depth_slope(map: DepthMap, d: vec2<f32>) -> vec2<f32> {
    let w = map.denominator.x + map.denominator.y * d;
    let area = map.numerator.x * map.denominator.y - map.numerator.y * map.denominator.x;
    return vec2(area) / (w * w);
}

fn device_depth(map: DepthMap, z: f32) -> f32 {
    return -(map.numerator.x + z * map.denominator.x) / (map.numerator.y + z * map.denominator.y);
}

// How many pixels a metre across the view spans at a point.
fn pixels_per_metre(position: vec3<f32>) -> f32 {
    let w = (view.clip_from_view * vec4(position, 1.0)).w;
    return 0.5 * frame.view_size.y * abs(view.clip_from_view[1][1]) / max(abs(w), 1e-20);
}

fn has_front(layers: vec2<f32>) -> bool {
    return layers.x > NO_FRONT;
}

fn has_back(layers: vec2<f32>) -> bool {
    return layers.y > NO_BACK;
}

// The plane d = depth + slope · (pixel offset), as a unit normal in view space. A plane that is
// affine over the screen is linear in clip space, whatever the projection.
fn normal_from_slope(ndc: vec2<f32>, depth: f32, slope: vec2<f32>) -> vec3<f32> {
    let per_ndc = slope * frame.view_size * vec2(0.5, -0.5);
    let clip_plane = vec4(-per_ndc, 1.0, dot(per_ndc, ndc) - depth);
    let view_plane = clip_plane * view.clip_from_view;
    return unit_or_z(view_plane.xyz);
}

// The unit vector along `v`, even if f32 cannot hold the square of its length; +z, towards the
// viewer, if `v` has no direction: where there is no layer there is no plane.
fn unit_or_z(v: vec3<f32>) -> vec3<f32> {
    let size = max(max(abs(v.x), abs(v.y)), abs(v.z));
    // Comparisons with NaN are false.
    let usable = all(abs(v) < vec3(1e38)) && size > 0.0;
    return select(vec3(0.0, 0.0, 1.0), normalize(v / size), usable);
}

// Nearest of a pixel's samples.
fn nearest_scene_depth(pixel: vec2<i32>) -> f32 {
    return textureLoad(scene_depth, pixel + frame.scene_origin, 0).x;
}

// Farthest of a pixel's samples: anything behind it is hidden in every one of them.
fn farthest_scene_depth(pixel: vec2<i32>) -> f32 {
    let depths = textureLoad(scene_depth, pixel + frame.scene_origin, 0);
    return select(depths.x, depths.y, frame.multisampled == 1u);
}

// Unit vectors in two numbers in −1..=1 (octahedral mapping, Meyer et al. 2010).
fn encode_normal(n: vec3<f32>) -> vec2<f32> {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    return select(folded, p, n.z >= 0.0);
}

fn decode_normal(e: vec2<f32>) -> vec3<f32> {
    var n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    let t = max(-n.z, 0.0);
    n = vec3(n.xy + select(vec2(t), vec2(-t), n.xy >= vec2(0.0)), n.z);
    return normalize(n);
}
