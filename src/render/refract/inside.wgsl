// The inside of a surface: its surrounding light, source term and thickness.
#define_import_path bevy_fluid::render::refract::inside

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::texel_at
#import bevy_fluid::render::optics::even_light

@group(1) @binding(4) var thickness: texture_2d<f32>;

// In-scattered light and emission per metre of the medium.
fn medium_source() -> vec3<f32> {
    var out = surface.emission;
#ifdef SCATTERING
    out += surface.scattering * even_light();
#endif
    return out;
}

// The accumulated path length through all particles at a pixel.
fn accumulated_length(pixel: vec2<i32>) -> f32 {
    return textureLoad(thickness, texel_at(pixel), 0).x;
}
