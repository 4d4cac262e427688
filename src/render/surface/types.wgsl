#define_import_path bevy_fluid::render::types

// An ellipsoid: center + scale · axes · u for |u| = 1, in the fluid's space.
// `axes` holds six f16 of a symmetric matrix: xx, xy, xz, yy, yz, zz.
struct Splat {
    center: vec3<f32>,
    scale: f32,
    axes: vec3<u32>,
    particle: u32,
}

// Transform and particle radius of a fluid.
struct GpuFluid {
    world_from_local: mat4x4<f32>,
    // Particle radius in the fluid's space.
    radius: f32,
}

// Appearance of a surface in a view, and how it is searched for. Lengths are in view units: metres
// times the camera's scale.
struct GpuSurface {
    // 1/m.
    extinction: vec3<f32>,
    refractive_index: f32,
    // Medium: scattering colour times density, 1/m.
    scattering: vec3<f32>,
    perceptual_roughness: f32,
    // Medium: emission per metre, exposed.
    emission: vec3<f32>,
    // Particle radius.
    radius: f32,
    // Centre of the next surface behind this one in view space, and 1; 0: there is none.
    behind: vec4<f32>,
    // Accumulated thickness: density (1 − q²)^softness within a splat.
    softness: f32,
    // Search: evenly spaced samples before the bracket.
    coarse_samples: u32,
    // How far behind the liquid an opaque surface is wetted.
    contact: f32,
    // Thickness of a sheet of one particle; 0: there are none, as droplets are of the bulk.
    sheet: f32,
}

// Depth layers hold (device depth of the front, −device depth of the back), so that one `max` blend
// serves both. These mean "nothing here".
const NO_FRONT: f32 = 0.0;
const NO_BACK: f32 = -2.0;
// A front at the near plane: the ray starts inside the liquid.
const INSIDE_FRONT: f32 = 1.0;

// How a search ended.
const STATUS_NONE: u32 = 0u;
const STATUS_HIT: u32 = 1u;
const STATUS_NO_BRACKET: u32 = 2u;
const STATUS_LEFT_LAYER: u32 = 3u;
const STATUS_INVALID: u32 = 4u;
const STATUS_TOTAL_REFLECTION: u32 = 5u;
const STATUS_BUDGET: u32 = 6u;
// The ray met an opaque surface on its way.
const STATUS_OPAQUE: u32 = 7u;
