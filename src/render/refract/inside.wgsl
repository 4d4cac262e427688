// The inside of a body: its surrounding light, source term and thickness.
#define_import_path bevy_fluid::render::refract::inside

#import bevy_fluid::render::bindings::body
#import bevy_fluid::render::optics::environment_sampler

@group(1) @binding(6) var diffuse_map: texture_cube<f32>;
@group(1) @binding(7) var thickness: texture_2d<f32>;

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
    let around = select(vec3(0.0), sum / 6.0 * body.diffuse_intensity, body.diffuse_intensity > 0.0);
    return body.even_light + around;
}

// In-scattered light and emission per metre of the body.
fn medium_source() -> vec3<f32> {
    var out = body.emission;
#ifdef SCATTERING
    out += body.scattering * even_light();
#endif
    return out;
}

// The accumulated path length through all particles at a pixel.
fn accumulated_length(pixel: vec2<i32>) -> f32 {
    return textureLoad(thickness, pixel, 0).x;
}
