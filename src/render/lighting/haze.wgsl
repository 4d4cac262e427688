// What lies between the eye and the liquid: fog, and the air of an atmosphere.
#define_import_path bevy_fluid::render::haze

#import bevy_fluid::fog::{Fogged, fog_over, glow}
#ifdef ATMOSPHERE
#import bevy_fluid::render::aerial::aerial_over
#endif
#import bevy_fluid::render::frame::view
#import bevy_fluid::render::optics::{MAX_LIGHTS, lighting}

// What it does to light from a position in view space, which is seen at a place on screen (0 to 1).
fn haze_before(position: vec3<f32>, place: vec2<f32>) -> Fogged {
    let way = (view.world_from_view * vec4(position, 0.0)).xyz;
    let distance = length(way);
    let ray = way / max(distance, 1e-9);
    var around_lights = vec3(0.0);
    for (var i = 0u; i < MAX_LIGHTS; i += 1u) {
        let light = lighting.lights[i];
        around_lights += glow(lighting.fog, light.direction_to_light, light.illuminance, ray);
    }
    let fog = fog_over(lighting.fog, distance, around_lights * view.exposure);
#ifdef ATMOSPHERE
    // Bevy lays the air over what is fogged already.
    let air = aerial_over(place, distance, ray, view.exposure);
    return Fogged(fog.transmitted * air.transmitted, fog.added * air.transmitted + air.added);
#else
    return fog;
#endif
}
