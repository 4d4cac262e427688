// Light at an interface and beyond: Fresnel, refraction, highlights, the environment.
#define_import_path bevy_fluid::render::optics

#import bevy_fluid::fog::Fog
#import bevy_fluid::render::frame::{surface, view}

const PI: f32 = 3.14159265;
const MAX_LIGHTS: u32 = 4u;

struct DirectionalLight {
    // World space, unit length.
    direction_to_light: vec3<f32>,
    // lx, times the light's colour.
    illuminance: vec3<f32>,
}

// The atmosphere around the eye: see `aerial.wgsl`.
struct Aerial {
    // From the planet's centre.
    up: vec3<f32>,
    // Of the eye. Lengths are in units of the atmosphere.
    radius: f32,
    inner_radius: f32,
    outer_radius: f32,
    // Units of the atmosphere in a metre.
    scale: f32,
    // How far the table reaches, and in how many slices.
    distance: f32,
    slices: f32,
}

// The light that falls on the surfaces of a view.
struct Lighting {
    // World to cubemap, handedness included.
    environment_from_world: mat3x3<f32>,
    // Background without an environment map.
    clear_color: vec4<f32>,
    // Turns texels of the environment map into the view's units; 0: there is none.
    environment_intensity: f32,
    // Mean over all directions of the light from lights and ambient, exposed.
    even_light: vec3<f32>,
    // Turns texels of the diffuse environment map into the view's units; 0: there is none.
    diffuse_intensity: f32,
    // Unused ones are all zero.
    lights: array<DirectionalLight, MAX_LIGHTS>,
    fog: Fog,
    aerial: Aerial,
}

@group(2) @binding(0) var<uniform> lighting: Lighting;
@group(2) @binding(1) var environment_map: texture_cube<f32>;
@group(2) @binding(2) var diffuse_map: texture_cube<f32>;
@group(2) @binding(3) var environment_sampler: sampler;

// Exposed radiance from far away, along a direction in view space.
fn environment(direction: vec3<f32>) -> vec3<f32> {
    let world = (view.world_from_view * vec4(direction, 0.0)).xyz;
    let texel = textureSampleLevel(
        environment_map, environment_sampler, lighting.environment_from_world * world, 0.0,
    );
    let seen = texel.rgb * lighting.environment_intensity;
    return select(lighting.clear_color.rgb, seen, lighting.environment_intensity > 0.0);
}

struct Interface {
    reflectance: f32,
    // Zero vector under total reflection.
    refracted: vec3<f32>,
    reflected: vec3<f32>,
}

// A ray meets an interface whose unit normal `n` faces it; `eta` is the refractive index on its
// side over that beyond.
fn meet(direction: vec3<f32>, n: vec3<f32>, eta: f32) -> Interface {
    var out: Interface;
    out.reflected = reflect(direction, n);
    let ci = clamp(-dot(direction, n), 0.0, 1.0);
    let st2 = eta * eta * (1.0 - ci * ci);
    if st2 >= 1.0 {
        out.reflectance = 1.0;
        out.refracted = vec3(0.0);
        return out;
    }
    let ct = sqrt(1.0 - st2);
    out.refracted = normalize(eta * direction + (eta * ci - ct) * n);
#ifdef SCHLICK
    let r0 = (eta - 1.0) / (eta + 1.0);
    // The angle on the thinner side: with the other angle, the approximation has no total internal
    // reflection.
    let c = 1.0 - select(ct, ci, eta <= 1.0);
    out.reflectance = r0 * r0 + (1.0 - r0 * r0) * c * c * c * c * c;
#else
    let s = (eta * ci - ct) / (eta * ci + ct);
    let p = (eta * ct - ci) / (eta * ct + ci);
    out.reflectance = 0.5 * (s * s + p * p);
#endif
    return out;
}

// A normal that faces the ray at least at a grazing angle. Interpolated normals near silhouettes
// may not.
fn facing(n: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    let away = max(dot(n, direction) + 0.01, 0.0);
    return normalize(n - away * direction);
}

// Highlights of the directional lights: GGX with the height-correlated Smith term, as in Bevy's
// own materials, and the interface's Fresnel at the half vector.
fn highlights(direction: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    var out = vec3(0.0);
    let alpha = surface.perceptual_roughness * surface.perceptual_roughness;
    let a2 = alpha * alpha;
    let v = -direction;
    let nov = max(dot(n, v), 1e-4);
    for (var i = 0u; i < MAX_LIGHTS; i += 1u) {
        let light = lighting.lights[i];
        let to_light = (view.view_from_world * vec4(light.direction_to_light, 0.0)).xyz;
        // Unused lights are all zero.
        let l = to_light * inverseSqrt(max(dot(to_light, to_light), 1e-20));
        let nol = dot(n, l);
        if nol <= 0.0 {
            continue;
        }
        let h = normalize(v + l);
        let noh = clamp(dot(n, h), 0.0, 1.0);
        let f = noh * noh * (a2 - 1.0) + 1.0;
        let d = a2 / (PI * f * f);
        let smith = 0.5 / (nol * sqrt(nov * nov * (1.0 - a2) + a2)
            + nov * sqrt(nol * nol * (1.0 - a2) + a2));
        let fresnel = meet(-v, h, 1.0 / surface.refractive_index).reflectance;
        out += d * smith * fresnel * nol * light.illuminance;
    }
    return out * view.exposure;
}

// The mean over all directions of the light that falls on the scene.
fn even_light() -> vec3<f32> {
    // A texel holds the mean over a hemisphere, weighted by the cosine. Over six opposite ones
    // all that is left is the mean over the sphere (to the fourth order of spherical harmonics).
    var sum = vec3(0.0);
    for (var i = 0u; i < 6u; i += 1u) {
        var axis = vec3(0.0);
        axis[i >> 1u] = select(-1.0, 1.0, (i & 1u) == 0u);
        sum += textureSampleLevel(diffuse_map, environment_sampler, axis, 0.0).rgb;
    }
    let around = select(vec3(0.0), sum / 6.0 * lighting.diffuse_intensity, lighting.diffuse_intensity > 0.0);
    return lighting.even_light + around;
}
