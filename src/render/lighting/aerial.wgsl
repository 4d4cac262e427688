// Aerial perspective: what Bevy's atmosphere does to light on its way to the eye, from the tables
// that Bevy makes for the view (Bruneton and Neyret 2008, section 4).
#define_import_path bevy_fluid::render::aerial

#import bevy_fluid::fog::Fogged
#import bevy_fluid::render::optics::{environment_sampler, lighting}

// By place on screen and distance: the logarithm of the light that is scattered into the eye.
@group(2) @binding(4) var inscattering_table: texture_3d<f32>;
// By height and direction: the fraction of light that comes in from outside the atmosphere.
@group(2) @binding(5) var transmittance_table: texture_2d<f32>;

// Leg of a right triangle, without the loss of digits by squares of a planet's radius.
fn leg(hypotenuse: f32, other: f32) -> f32 {
    return sqrt(max((hypotenuse - other) * (hypotenuse + other), 0.0));
}

// `cosine` is that of the angle between a ray and the vertical.
fn transmitted_from_outside(radius: f32, cosine: f32) -> vec3<f32> {
    let outer = lighting.aerial.outer_radius;
    let at_ground = leg(outer, lighting.aerial.inner_radius);
    let to_horizon = leg(radius, lighting.aerial.inner_radius);
    let across = radius * sqrt(max(1.0 - cosine * cosine, 0.0));
    let distance = max(leg(outer, across) - radius * cosine, 0.0);
    let shortest = outer - radius;
    let longest = to_horizon + at_ground;
    let uv = vec2((distance - shortest) / (longest - shortest), to_horizon / at_ground);
    return textureSampleLevel(transmittance_table, environment_sampler, uv, 0.0).rgb;
}

// Over `distance` metres along a ray of unit length through a place on screen (0 to 1).
fn aerial_over(place: vec2<f32>, distance: f32, ray: vec3<f32>, exposure: f32) -> Fogged {
    let t = distance * lighting.aerial.scale;
    let radius = lighting.aerial.radius;
    let cosine = dot(ray, lighting.aerial.up);
    let radius_there = sqrt(max(t * (t + 2.0 * radius * cosine) + radius * radius, 0.0));
    let cosine_there = clamp((radius * cosine + t) / radius_there, -1.0, 1.0);
    let across = radius * sqrt(max(1.0 - cosine * cosine, 0.0));
    let meets_ground = cosine < 0.0 && across < lighting.aerial.inner_radius;
    // Both ends of the path from the same side, of which the ground is not in the way.
    let sign = select(1.0, -1.0, meets_ground);
    let here = transmitted_from_outside(radius, sign * cosine);
    let there = transmitted_from_outside(radius_there, sign * cosine_there);
    let ratio = select(here / there, there / here, meets_ground);

    // A slice holds the light up to its far side.
    let slices = lighting.aerial.slices;
    let depth = saturate(t / lighting.aerial.distance - 0.5 / slices);
    let table = textureSampleLevel(
        inscattering_table, environment_sampler, vec3(place, depth), 0.0,
    );
    let first = saturate(t / lighting.aerial.distance * slices);
    return Fogged(min(ratio, vec3(1.0)), exp(table.rgb) * (first * exposure));
}
