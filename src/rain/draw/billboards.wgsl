// Streaks of the drops in a voxel, on a billboard that is aligned with the fall and faces the eye.

#import bevy_fluid::rain::draw::common::{
    clip_from_relative, in_fog, is_sheltered, lamplight, metres_per_pixel, over, pcg, rain,
    ray_to, scene_view_depth, streak_sampler, streaks, surroundings, uniform_of,
}
#import bevy_fluid::rain::draw::types::{GpuRainLevel, STEEPEST, STREAK_TEXELS, VARIANTS, Voxel}

struct Varying {
    @builtin(position) clip: vec4<f32>,
    @location(0) position: vec3<f32>,
    // Place in the textures, from the voxel's own tile on. Unit: m.
    @location(1) place: vec2<f32>,
    @location(2) light: vec3<f32>,
    @location(3) @interpolate(flat) inverse_radius: f32,
    @location(4) @interpolate(flat) tile: i32,
    @location(5) @interpolate(flat) hash: u32,
    @location(6) @interpolate(flat) lamps: u32,
    @location(7) @interpolate(flat) level: u32,
    @location(8) @interpolate(flat) shelters: vec2<u32>,
}

// Opacities below this change no pixel.
const LEAST: f32 = 1e-6;
// Drops seen more steeply than this are lit as if they were nearer to their billboard, and so by
// the lamps that reach it (see `lattice.rs`).
const LEAST_ACROSS: f32 = 0.7;

@vertex
fn vertex(@builtin(vertex_index) corner: u32, quad: Voxel) -> Varying {
    var out: Varying;
    let ray = select(rain.forward, quad.center, rain.perspective == 1u);
    let side = normalize(cross(rain.axis, ray));
    let at = vec2(f32(corner & 1u), f32(corner >> 1u)) * quad.size;
    out.position = quad.center + side * (at.x - 0.5 * quad.size)
        + rain.axis / rain.axis.y * (at.y - 0.5 * quad.size);
    out.clip = clip_from_relative(out.position);
    // Every column has its own place in the textures.
    out.place = at + vec2(f32(quad.hash & 31u) / 32.0, quad.fraction + rain.fallen);
    out.light = surroundings(ray_to(out.position));
    out.inverse_radius = 1.0 / quad.radius;
    out.tile = quad.tile + rain.fallen_tiles;
    out.hash = quad.hash;
    out.lamps = quad.lamps;
    out.level = quad.level;
    out.shelters = quad.shelters;
    return out;
}

// Tiles beside and above each other show different drops, without a period.
fn hash_of_tile(in: Varying) -> u32 {
    let tile = vec2<i32>(floor(in.place)) + vec2(0, in.tile);
    return (u32(tile.y) * 0x9E3779B1u) ^ (u32(tile.x) * 0x85EBCA77u) ^ in.hash;
}

// Opacity of the drops in a whole cubic voxel.
fn opacity_of_streaks(in: Varying, mip: f32) -> f32 {
    let variant = (hash_of_tile(in) >> 27u) % VARIANTS;
    let texel = textureSampleLevel(
        streaks, streak_sampler, vec2(in.place.x, -in.place.y), variant, mip,
    );
    return dot(texel, rain.levels[in.level].weights);
}

// How much of a voxel at a distance lies in its level, up to `end`.
fn within(level: GpuRainLevel, at: f32, end: f32) -> f32 {
    let low = max(at - 0.5 * level.size, level.start);
    return max(min(at + 0.5 * level.size, min(level.end, end)) - low, 0.0);
}

// Length of the ray that a voxel at a distance represents. Voxels across an end of the level are
// not drawn, which halves the fill there; their mirror images within the level count for them.
// Parallel rays all meet the same voxels: there they fade at the ends, and only those that the near
// plane cuts off are mirrored.
fn part_of_voxel(level: GpuRainLevel, at: f32, end: f32) -> f32 {
    let whole = within(level, at, end);
    let mirrored = whole + within(level, 2.0 * level.start - at, end)
        + within(level, 2.0 * level.end - at, end);
    let is_inside = at >= level.start && at < level.end;
    let faded = whole + within(level, -at, end);
    return mix(faded, select(0.0, mirrored, is_inside), f32(rain.perspective));
}

// Position on the ray of the visible drop, between two distances across the fall: every stretch of
// a column of texels, as long as a streak, has its own depth and falls with it. If all drops were
// on the billboard, a lamp's cone would appear as a disc, its cross section with the billboard.
fn drop_position(in: Varying, ray: vec3<f32>, across: f32, at: f32, ends: vec2<f32>, mip: f32) -> vec3<f32> {
#ifdef LAMPS_OR_SHELTERS
    let column = pcg(hash_of_tile(in) ^ u32(in.place.x * STREAK_TEXELS.x * exp2(-round(mip))));
    let stretch = fract(in.place.y) / (rain.mean_speed * rain.exposure) + uniform_of(column);
    let there = mix(ends.x, ends.y, uniform_of(pcg(column ^ u32(stretch))));
    return in.position + ray * ((there - at) / max(across, LEAST_ACROSS));
#else
    return in.position;
#endif
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4<f32> {
    let view_depth = dot(in.position, rain.forward);
    // Distances across the fall, along which voxels are counted.
    let square = dot(in.position, in.position);
    let ray = select(rain.forward, in.position * inverseSqrt(square), rain.perspective == 1u);
    let along = dot(ray, rain.axis);
    let across = sqrt(max(1.0 - along * along, 0.0));
    let inverse_steepness = 1.0 / max(across, STEEPEST);
    let distance = across * select(view_depth, sqrt(square), rain.perspective == 1u);
    // The part of the voxel that is in front of the scene, within the level's range and in sight.
    let level = rain.levels[in.level];
    let scene = distance * scene_view_depth(in.clip.xy) / max(view_depth, 1e-4);
    let end = min(rain.distance * across, scene);
    let part = part_of_voxel(level, distance, end);
    if part <= 0.0 {
        discard;
    }
    let texels = max(STREAK_TEXELS.x, STREAK_TEXELS.y * inverse_steepness);
    let mip = log2(max(texels * metres_per_pixel(view_depth), 1.0));
    // Off the billboard's middle, rays meet fewer billboards at an angle than straight ahead.
    let facing = select(1.0, min(distance * in.inverse_radius, 4.0), rain.perspective == 1u);
    let counts = part * level.inverse_size * facing * rain.axis.y * inverse_steepness;
    let opacity = min(opacity_of_streaks(in, mip) * counts, 1.0);
    let ends = vec2(distance - 0.5 * level.size, min(distance + 0.5 * level.size, end));
    let drop = drop_position(in, ray, across, distance, ends, mip);
    if opacity < LEAST || is_sheltered(drop, in.shelters) {
        discard;
    }
    return over(in_fog(in.light + lamplight(drop, ray, in.lamps), drop, ray), opacity);
}
