// Streaks of all classes in a voxel, on a billboard that stands along the fall and faces the eye.

#import bevy_fluid::rain::draw::common::{
    clip_from_relative, is_sheltered, lamplight, over, pixels_per_metre, rain, ray_to,
    scene_view_depth, streak_sampler, streaks, surroundings, view,
}
#import bevy_fluid::rain::draw::types::{
    CLASSES, MERGED_FROM, STREAK_TEXELS, VARIANTS, Voxel,
}

struct Varying {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    // Along the billboard, and up from its lower edge. Unit: m.
    @location(1) place: vec2<f32>,
    @location(2) light: vec3<f32>,
    // Of the billboard's plane, sideways.
    @location(3) @interpolate(flat) side: vec2<f32>,
    @location(4) @interpolate(flat) radius: f32,
    @location(5) @interpolate(flat) base: f32,
    @location(6) @interpolate(flat) fraction: f32,
    @location(7) @interpolate(flat) tile: i32,
    @location(8) @interpolate(flat) hash: u32,
    @location(9) @interpolate(flat) lamps: u32,
    @location(10) @interpolate(flat) level: u32,
}

// Opacities below this change no pixel.
const LEAST: f32 = 1e-6;
// Seen along the fall, streaks are points: their opacity grows no more from here on.
const STEEPEST: f32 = 0.15;

@vertex
fn vertex(@builtin(vertex_index) corner: u32, quad: Voxel) -> Varying {
    var out: Varying;
    let ray = select(rain.forward, quad.center, rain.perspective == 1u);
    let side = normalize(cross(rain.axis, ray));
    let at = vec2(f32(corner & 1u), f32(corner >> 1u)) * quad.size;
    out.place = vec2(at.x - 0.5 * quad.size, at.y);
    out.position = quad.center + side * out.place.x
        + rain.axis / rain.axis.y * (at.y - 0.5 * quad.size);
    out.clip = clip_from_relative(out.position);
    out.light = surroundings(ray_to(out.position));
    out.side = side.xz;
    out.radius = quad.radius;
    out.base = quad.base;
    out.fraction = quad.fraction;
    out.tile = quad.tile;
    out.hash = quad.hash;
    out.lamps = quad.lamps;
    out.level = quad.level;
    return out;
}

// Opacity of a cubic voxel's drops, before what of it counts.
fn opacity_of_streaks(in: Varying, mip: f32) -> f32 {
    var opacity = 0.0;
    let merged = in.level >= MERGED_FROM;
    let end = select(CLASSES - 1u, CLASSES, merged);
    for (var i = select(0u, CLASSES - 1u, merged); i < end; i += 1u) {
        let weights = rain.weights[in.level][i];
        let drops = rain.classes[i];
        // Every column has its own place in the textures, for each class.
        let bits = in.hash >> (i * 5u);
        let across = in.place.x + f32(bits & 15u) / 16.0
            + dot(drops.lean, in.side) * (in.base + in.place.y);
        let up = in.place.y + in.fraction + drops.fallen;
        let tile = vec2(floor(across), floor(up));
        let row = u32(i32(tile.y) + in.tile + drops.fallen_tiles);
        // Tiles beside and above each other show different variants, without a period.
        let chance = (row * 0x9E3779B1u) ^ (u32(i32(tile.x)) * 0x85EBCA77u);
        let variant = ((chance >> 27u) ^ bits) % VARIANTS;
        let texel = textureSampleLevel(
            streaks, streak_sampler, vec2(across, -up), i * VARIANTS + variant, mip,
        );
        opacity += dot(texel, weights);
    }
    return opacity;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let ray = ray_to(in.position);
    let view_depth = dot(in.position, rain.forward);
    // Distances across the fall, along which voxels are counted.
    let along = dot(ray, rain.axis);
    let steepness = max(sqrt(max(1.0 - along * along, 0.0)), STEEPEST);
    let reach = length(in.position - dot(in.position, rain.axis) * rain.axis);
    let distance = select(dot(in.position, rain.forward) * steepness, reach, rain.perspective == 1u);
    // The part of the voxel that is before the scene, within the level's range and in sight.
    let level = rain.levels[in.level];
    let scene = distance * scene_view_depth(in.clip.xy) / max(view_depth, 1e-4);
    let end = min(min(level.end, rain.distance * steepness), scene);
    let part = min(distance + 0.5 * level.size, end) - max(distance - 0.5 * level.size, level.start);
    if part <= 0.0 {
        discard;
    }
    // Near the eye, fewer billboards are met at an angle than straight ahead.
    let facing = select(1.0, min(distance / in.radius, 4.0), rain.perspective == 1u);
    let counts = part / level.size * facing * level.gain * rain.axis.y / steepness;

    let texels = max(STREAK_TEXELS.x, STREAK_TEXELS.y / steepness);
    let mip = log2(max(texels / pixels_per_metre(view_depth), 1.0));
    let opacity = min(opacity_of_streaks(in, mip) * counts, 1.0);
    if opacity < LEAST || is_sheltered(in.position) {
        discard;
    }
    return over(in.light + lamplight(in.position, ray, in.lamps), opacity);
}
