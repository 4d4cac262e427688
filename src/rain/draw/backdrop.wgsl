// Extinction and radiance of the rain beyond the streaks, and of rain seen so steeply that drops
// are points.

#import bevy_fluid::rain::draw::common::{in_fog, over, rain, scene_view_depth, surroundings, view}
#import bevy_fluid::rain::draw::types::STEEPEST
#import bevy_render::view::frag_coord_to_ndc

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let uv = vec2(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4(uv * 2.0 - 1.0, 1.0, 1.0);
}

fn view_ray(pixel: vec2<f32>) -> vec3<f32> {
    let ndc = frag_coord_to_ndc(vec4(pixel, 0.0, 1.0), view.main_pass_viewport).xy;
    let point = view.view_from_clip * vec4(ndc, 1.0, 1.0);
    let along = normalize((view.world_from_view * vec4(point.xyz / point.w, 0.0)).xyz);
    return select(rain.forward, along, rain.perspective == 1u);
}

@fragment
fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let ray = view_ray(position.xy);
    let scene = scene_view_depth(position.xy) / max(dot(ray, rain.forward), 1e-4);
    let beyond = clamp(scene, rain.distance, max(rain.extent, rain.distance)) - rain.distance;
    // Within `distance`: the stretch of individually drawn drops, and that of billboards.
    let along = dot(ray, rain.axis);
    let across = sqrt(max(1.0 - along * along, 0.0));
    let before = min(scene, rain.distance);
    let near = min(rain.drops_end / max(across, 1e-6), before);
    let part = min(across / STEEPEST, 1.0);
    let billboards = (before - near) * mix(floor(part), part, f32(rain.perspective));
    let drawn = min(near, rain.drops_reach) + billboards;
    let opacity = 1.0 - exp(-rain.extinction * (beyond + max(before - drawn, 0.0)));
    if opacity <= 0.0 {
        discard;
    }
    return over(in_fog(surroundings(ray), ray * rain.distance, ray), opacity);
}
