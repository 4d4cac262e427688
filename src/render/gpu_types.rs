//! The Rust twins of `types.wgsl`: the same fields under the same names.

use bevy::{prelude::*, render::render_resource::ShaderType};

/// Directional lights that give highlights; further ones are left out.
pub(crate) const MAX_LIGHTS: usize = 4;

/// Where a fluid stands.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuFluid {
    pub(crate) world_from_local: Mat4,
}

/// A light that gives highlights.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuDirectionalLight {
    pub(crate) direction_to_light: Vec3,
    pub(crate) illuminance: Vec3,
}

/// What a body looks like in a view.
#[derive(Clone, Copy, Default, ShaderType)]
pub(crate) struct GpuBody {
    pub(crate) environment_from_world: Mat3,
    pub(crate) clear_color: Vec3,
    pub(crate) environment_intensity: f32,
    pub(crate) extinction: Vec3,
    pub(crate) refractive_index: f32,
    pub(crate) lights: [GpuDirectionalLight; MAX_LIGHTS],
    pub(crate) light_count: u32,
    pub(crate) perceptual_roughness: f32,
    pub(crate) radius: f32,
    pub(crate) window_radii: f32,
    pub(crate) range: f32,
    pub(crate) bound: f32,
    pub(crate) flow_step: f32,
    pub(crate) coarse_samples: u32,
    pub(crate) contact: f32,
}

/// How a search for the next interface ended, as stored per ray (`STATUS_…` in `types.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum SearchStatus {
    /// No search was made.
    None = 0,
    /// The interface was found.
    Hit = 1,
    /// The ray meets no further interface.
    NoBracket = 2,
    /// The ray left the layer's silhouette before it crossed the layer.
    LeftLayer = 3,
    /// There was no valid sample to search in.
    Invalid = 4,
    /// The ray was totally reflected at the interface that was found.
    TotalReflection = 5,
    /// The evaluations ran out before the tolerance was reached.
    Budget = 6,
    /// An opaque surface was met first.
    Opaque = 7,
}

impl SearchStatus {
    /// All, in the order of their numbers.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Hit,
        Self::NoBracket,
        Self::LeftLayer,
        Self::Invalid,
        Self::TotalReflection,
        Self::Budget,
        Self::Opaque,
    ];
}
