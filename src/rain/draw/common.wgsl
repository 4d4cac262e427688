// Bindings and lighting shared by all parts of rain.
#define_import_path bevy_fluid::rain::draw::common

#import bevy_fluid::fog::{fog_over, glow}
#import bevy_fluid::rain::draw::types::{DRY_PLANES, GpuRain}
#import bevy_render::view::{View, frag_coord_to_ndc}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> rain: GpuRain;
#ifdef MULTISAMPLED
@group(0) @binding(2) var scene_depth: texture_depth_multisampled_2d;
#else
@group(0) @binding(2) var scene_depth: texture_depth_2d;
#endif
@group(0) @binding(3) var environment_map: texture_cube<f32>;
@group(0) @binding(4) var environment_sampler: sampler;
@group(0) @binding(5) var streaks: texture_2d_array<f32>;
@group(0) @binding(6) var streak_sampler: sampler;

const PI: f32 = 3.14159265;
// Farther than any scene.
const FAR: f32 = 1e9;

// A hash (Jarzynski and Olano 2020). No field may have its name: imports would rename it.
fn pcg(seed: u32) -> u32 {
    let state = seed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Random bits as a number in 0..1.
fn uniform_of(bits: u32) -> f32 {
    return f32(bits >> 8u) / 16777216.0;
}

// Twin of `phase` in `phase.rs`.
fn phase(cosine: f32) -> f32 {
    let even = (1.0 - 0.93 - 0.045) / (4.0 * PI);
    let ahead = 0.93 * 7.4 / (2.0 * PI) * exp(7.4 * (cosine - 1.0));
    let off = (cosine + 0.79) / 0.12;
    let bow = 0.045 / (2.0 * PI * 0.12 * sqrt(PI)) * exp(-off * off);
    return even + ahead + bow;
}

// From relative positions to the screen, without the world's large numbers.
fn clip_from_relative(position: vec3<f32>) -> vec4<f32> {
    return view.clip_from_view * vec4((view.view_from_world * vec4(position, 0.0)).xyz, 1.0);
}

// The direction from the eye to a position, of unit length.
fn ray_to(position: vec3<f32>) -> vec3<f32> {
    return select(rain.forward, normalize(position), rain.perspective == 1u);
}

// View depth (positive forward) of the opaque scene and of liquids, in metres also where the camera
// is scaled.
fn scene_view_depth(pixel: vec2<f32>) -> f32 {
    let depth = textureLoad(scene_depth, vec2<i32>(pixel), 0);
    if rain.perspective == 1u && depth <= 0.0 {
        return FAR;
    }
    let ndc = frag_coord_to_ndc(vec4(pixel, depth, 1.0), view.main_pass_viewport);
    let position = view.view_from_clip * vec4(ndc, 1.0);
    return -position.z / position.w * rain.view_scale.y;
}

// How much a pixel spans across the view.
fn metres_per_pixel(view_depth: f32) -> f32 {
    let inverse_focal = 2.0 / (view.main_pass_viewport.w * abs(view.clip_from_view[1][1]));
    let depth = select(1.0, max(view_depth, 1e-4) / rain.view_scale.y, rain.perspective == 1u);
    return inverse_focal * depth * rain.view_scale.x;
}

fn environment(direction: vec3<f32>) -> vec3<f32> {
    let level = f32(textureNumLevels(environment_map) - 1u);
    let to_map = rain.environment_from_world * direction;
    return textureSampleLevel(environment_map, environment_sampler, to_map, level).rgb;
}

// Radiance of drops lit from all around: mostly light from behind them.
fn surroundings(direction: vec3<f32>) -> vec3<f32> {
    // Without a map the intensity is 0.
    return rain.ambient + rain.environment_intensity * environment(direction);
}

// Radiance of drops at a position, lit by lamps and suns: the illuminance of a surface that faces
// them, times the phase function. Falloff, cone and range are Bevy's.
fn lamplight(position: vec3<f32>, ray: vec3<f32>, lamps: u32) -> vec3<f32> {
    var light = vec3(0.0);
#ifdef SUNS
    for (var i = 0u; i < rain.sun_count; i += 1u) {
        light += rain.suns[i].illuminance * phase(dot(rain.suns[i].direction, -ray));
    }
#endif
#ifdef LAMPS
    for (var left = lamps; left != 0u; left &= left - 1u) {
        let lamp = rain.lights[firstTrailingBit(left)];
        let way = position - lamp.position;
        let square = dot(way, way);
        let near = square * lamp.inverse_range_squared;
        let fade = saturate(1.0 - near * near);
        let direction = way * inverseSqrt(max(square, 1e-8));
        let cone = saturate(dot(direction, lamp.direction) * lamp.spot_scale + lamp.spot_offset);
        let attenuation = fade * fade * cone * cone / max(square, 0.0001);
        if attenuation > 0.0 {
            light += lamp.intensity * attenuation * phase(dot(direction, -ray));
        }
    }
#endif
    return light;
}

// Whether one of the shelters lies above a position, along the fall of the drops.
fn is_sheltered(position: vec3<f32>, shelters: vec2<u32>) -> bool {
#ifdef SHELTERS
    for (var word = 0u; word < 2u; word += 1u) {
        for (var left = shelters[word]; left != 0u; left &= left - 1u) {
            let shelter = 32u * word + firstTrailingBit(left);
            var depth = FAR;
            for (var i = 0u; i < DRY_PLANES; i += 1u) {
                let plane = rain.shelters.places[shelter].planes[i];
                depth = min(depth, dot(plane.xyz, position) + plane.w);
            }
            if depth >= 0.0 {
                return true;
            }
        }
    }
#endif
    return false;
}

// Radiance from a position, exposed, as it arrives through the camera's fog.
fn in_fog(radiance: vec3<f32>, position: vec3<f32>, ray: vec3<f32>) -> vec3<f32> {
    var around_suns = vec3(0.0);
#ifdef SUNS
    for (var i = 0u; i < rain.sun_count; i += 1u) {
        around_suns += glow(rain.fog, -rain.suns[i].direction, rain.suns[i].illuminance, ray);
    }
#endif
    let fogged = fog_over(rain.fog, length(position), around_suns * view.exposure);
    return radiance * (view.exposure * rain.brightness) * fogged.transmitted + fogged.added;
}

// Premultiplied colour, blended over the target.
fn over(color: vec3<f32>, opacity: f32) -> vec4<f32> {
    return vec4(color * opacity, opacity);
}
