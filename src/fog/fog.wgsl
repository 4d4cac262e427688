// Bevy's distance fog over a path from the eye: `fog.wgsl` of bevy_pbr, without branches.
#define_import_path bevy_fluid::fog

// Twin of `GpuFog`.
struct Fog {
    // Its alpha is the largest opacity; 0: there is no fog.
    color: vec4<f32>,
    // Of the glow around directional lights; its alpha is the strength.
    glow: vec4<f32>,
    // 1/m, or the distances of start and end.
    extinction: vec3<f32>,
    glow_exponent: f32,
    inscattering: vec3<f32>,
    falloff: u32,
}

const LINEAR: u32 = 0u;
const SQUARED: u32 = 2u;

// What a path does to light from behind it.
struct Fogged {
    transmitted: vec3<f32>,
    added: vec3<f32>,
}

// The light of a directional light that a ray towards it scatters into the eye.
fn glow(fog: Fog, to_light: vec3<f32>, illuminance: vec3<f32>, ray: vec3<f32>) -> vec3<f32> {
    // Nothing to the power of nothing is undefined.
    let facing = max(dot(ray, to_light), 1e-6);
    return pow(facing, max(fog.glow_exponent, 1e-3)) * illuminance;
}

// Over `distance` metres; `glow` is the sum over the lights, exposed.
fn fog_over(fog: Fog, distance: f32, glow: vec3<f32>) -> Fogged {
    let range = max(fog.extinction.y - fog.extinction.x, 1e-6);
    let linear = 1.0 - saturate((fog.extinction.y - distance) / range);
    let thickness = distance * fog.extinction;
    let power = select(thickness, thickness * thickness, fog.falloff == SQUARED);
    let is_linear = fog.falloff == LINEAR;
    let taken = select(1.0 - exp(-power), vec3(linear), is_linear);
    let scattered = distance * fog.inscattering;
    let given = select(
        1.0 - exp(-select(scattered, scattered * scattered, fog.falloff == SQUARED)),
        vec3(linear),
        is_linear,
    );
    let color = fog.color.rgb + glow * fog.glow.rgb * fog.glow.a;
    return Fogged(1.0 - fog.color.a * taken, fog.color.a * given * color);
}
