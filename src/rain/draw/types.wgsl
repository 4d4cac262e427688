#define_import_path bevy_fluid::rain::draw::types

#import bevy_fluid::fog::Fog

// Positions are relative to the eye, in metres along the world's axes.

struct GpuRainLevel {
    // Weights of the four densities in a voxel.
    weights: vec4<f32>,
    // Side of its voxels.
    size: f32,
    inverse_size: f32,
    // Range of distances from the eye, across the fall, that its voxels represent.
    start: f32,
    end: f32,
}

struct GpuRainLight {
    position: vec3<f32>,
    inverse_range_squared: f32,
    // cd times the light's colour.
    intensity: vec3<f32>,
    spot_scale: f32,
    // Direction of a spot light.
    direction: vec3<f32>,
    spot_offset: f32,
}

struct GpuRainSun {
    // Direction in which its light travels.
    direction: vec3<f32>,
    // lx times the light's colour.
    illuminance: vec3<f32>,
}

// Inside and below a box along the fall, it is dry.
struct GpuShelter {
    // Half-spaces whose intersection that is, with normals to the inside.
    planes: array<vec4<f32>, DRY_PLANES>,
}

// The nearest first.
struct GpuShelters {
    count: u32,
    places: array<GpuShelter, 64>,
}

struct GpuRain {
    // Direction from which drops of mean speed fall: unit length, y > 0.
    axis: vec3<f32>,
    distance: f32,
    // View direction.
    forward: vec3<f32>,
    // 0: the rays of the view are parallel.
    perspective: u32,
    // Radiance in all directions, cd/m².
    ambient: vec3<f32>,
    // cd/m² per texel of the environment map; 0: there is none.
    environment_intensity: f32,
    environment_from_world: mat3x3<f32>,
    // 1/m.
    extinction: f32,
    extent: f32,
    brightness: f32,
    sun_count: u32,
    // How far the drops of the textures have fallen: whole metres, and the rest.
    fallen_tiles: i32,
    fallen: f32,
    // Individually drawn drops: largest distance across the fall, and largest distance overall.
    drops_end: f32,
    drops_reach: f32,
    // Number of drops per cubic metre.
    drops: f32,
    exposure: f32,
    // How long they have fallen; `drift` is how far the air has moved meanwhile.
    seconds: f32,
    wind: vec2<f32>,
    drift: vec2<f32>,
    // The speed for which columns of drops lean.
    mean_speed: f32,
    // Different seeds give different drops.
    seed: u32,
    // How long the view's y and z axes are in the world.
    view_scale: vec2<f32>,
    // Terminal velocities by diameter, in steps of SPEED_STEP.
    speeds: array<vec4<f32>, 16>,
    levels: array<GpuRainLevel, 4>,
    lights: array<GpuRainLight, 32>,
    suns: array<GpuRainSun, 4>,
    shelters: GpuShelters,
    fog: Fog,
}

const DRY_PLANES: u32 = 9u;
const VARIANTS: u32 = 8u;
// Texels along a metre, across the fall and along it.
const STREAK_TEXELS: vec2<f32> = vec2(512.0, 512.0);
// mm.
const SPEED_STEP: f32 = 0.1;
// Larger drops break up. Unit: mm.
const LARGEST: f32 = 6.0;
// Sine of the angle between a ray and the fall below which streaks are points and their opacity no
// longer grows.
const STEEPEST: f32 = 0.15;

// A voxel of rain as passed to the vertex shaders, of streaks and of drops alike.
struct Voxel {
    @location(0) center: vec3<f32>,
    @location(1) size: f32,
    // Distance of the centre from the eye, across the fall.
    @location(2) radius: f32,
    // Height of the lower edge: whole metres, and the rest.
    @location(3) fraction: f32,
    @location(4) tile: i32,
    @location(5) hash: u32,
    // A bit for each light that reaches it.
    @location(6) lamps: u32,
    @location(7) level: u32,
    // A bit for each shelter that may keep some of it dry.
    @location(8) shelters: vec2<u32>,
}
