//! The Rust twins of `types.wgsl`: the same fields under the same names.

use bevy::{prelude::*, render::render_resource::ShaderType};
use bytemuck::{Pod, Zeroable};

use crate::fog::GpuFog;

/// Sizes of voxels: see [`lattice::LEVELS`](super::lattice::LEVELS).
pub(crate) const LEVEL_COUNT: usize = 4;
/// Maximum number of point and spot lights for a view's rain: those brightest at the camera.
pub(crate) const MAX_LIGHTS: usize = 32;
/// Maximum number of directional lights for rain.
pub(crate) const MAX_SUNS: usize = 4;
/// Maximum number of shelters in a view: those nearest to the camera.
pub(crate) const MAX_SHELTERS: usize = 64;
/// Half-spaces whose intersection is dry: above each of a box's slabs, and at its six sides as seen
/// along the fall.
pub(crate) const DRY_PLANES: usize = 9;
/// Terminal velocities in steps of 0.1 mm, four to a vector.
pub(crate) const SPEED_VECTORS: usize = 16;

#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuRainLevel {
    pub(crate) weights: Vec4,
    pub(crate) size: f32,
    pub(crate) inverse_size: f32,
    pub(crate) start: f32,
    pub(crate) end: f32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, ShaderType)]
pub(crate) struct GpuRainLight {
    pub(crate) position: Vec3,
    pub(crate) inverse_range_squared: f32,
    pub(crate) intensity: Vec3,
    pub(crate) spot_scale: f32,
    pub(crate) direction: Vec3,
    pub(crate) spot_offset: f32,
}

#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuRainSun {
    pub(crate) direction: Vec3,
    pub(crate) illuminance: Vec3,
}

#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub(crate) struct GpuShelter {
    pub(crate) planes: [Vec4; DRY_PLANES],
}

#[derive(Clone, Copy, ShaderType)]
pub(crate) struct GpuShelters {
    pub(crate) count: u32,
    pub(crate) places: [GpuShelter; MAX_SHELTERS],
}

impl Default for GpuShelters {
    fn default() -> Self {
        Self {
            count: 0,
            places: [GpuShelter::default(); MAX_SHELTERS],
        }
    }
}

#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuRain {
    pub(crate) axis: Vec3,
    pub(crate) distance: f32,
    pub(crate) forward: Vec3,
    pub(crate) perspective: u32,
    pub(crate) ambient: Vec3,
    pub(crate) environment_intensity: f32,
    pub(crate) environment_from_world: Mat3,
    pub(crate) extinction: f32,
    pub(crate) extent: f32,
    pub(crate) brightness: f32,
    pub(crate) sun_count: u32,
    pub(crate) fallen_tiles: i32,
    pub(crate) fallen: f32,
    pub(crate) drops_end: f32,
    pub(crate) drops_reach: f32,
    pub(crate) drops: f32,
    pub(crate) exposure: f32,
    pub(crate) seconds: f32,
    pub(crate) wind: Vec2,
    pub(crate) drift: Vec2,
    pub(crate) mean_speed: f32,
    pub(crate) seed: u32,
    pub(crate) view_scale: Vec2,
    pub(crate) speeds: [Vec4; SPEED_VECTORS],
    pub(crate) levels: [GpuRainLevel; LEVEL_COUNT],
    pub(crate) lights: [GpuRainLight; MAX_LIGHTS],
    pub(crate) suns: [GpuRainSun; MAX_SUNS],
    pub(crate) shelters: GpuShelters,
    pub(crate) fog: GpuFog,
}

/// A voxel with rain in it, of streaks or of drops: `Voxel` of `types.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuQuad {
    pub(crate) center: Vec3,
    pub(crate) size: f32,
    pub(crate) radius: f32,
    pub(crate) fraction: f32,
    pub(crate) tile: i32,
    pub(crate) hash: u32,
    pub(crate) lamps: u32,
    pub(crate) level: u32,
    pub(crate) shelters: [u32; MAX_SHELTERS / 32],
}
