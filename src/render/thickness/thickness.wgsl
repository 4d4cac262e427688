// The path length of a pixel's ray through each splat, summed up by the blend.

#import bevy_fluid::render::frame::surface
#import bevy_fluid::render::functions::{
    nearest_scene_depth, ndc_from_pixel, pixel_from_texture, view_from_device,
}
#import bevy_fluid::render::ellipsoid::{EllipsoidVertex, chord_of, place}

@vertex
fn vertex(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) splat: u32,
) -> EllipsoidVertex {
    return place(splat, corner);
}

@fragment
fn fragment(in: EllipsoidVertex) -> @location(0) f32 {
    let chord = chord_of(in);
    // The path ends at an opaque surface.
    var end = chord.middle + chord.half_length;
    let pixel = pixel_from_texture(in.position);
    let scene = nearest_scene_depth(vec2<i32>(pixel));
    if scene > 0.0 {
        let met = view_from_device(ndc_from_pixel(pixel), scene);
        end = min(end, dot(met - chord.ray.origin, chord.ray.direction));
    }
    let passed = end - max(chord.middle - chord.half_length, 0.0);
    if chord.disc <= 0.0 || passed <= 0.0 {
        discard;
    }
    // With q² = 1 − disc at the middle of the chord, the integral of (1 − q²)^s along it goes as
    // disc^(s + 1/2). The factor keeps that over the whole splat, whatever s.
    let s = surface.softness;
    let soft = pow(chord.disc, s) * (1.0 + 2.0 / 3.0 * s);
    // `in.x.w` is the volume of the particle over that of its splat.
    return passed * soft * in.x.w;
}
