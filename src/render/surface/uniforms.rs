//! The Rust twins of `types.wgsl`: the same fields under the same names.

use bevy::{prelude::*, render::render_resource::ShaderType};

use crate::{
    material::{FluidMaterial, Thickness},
    settings::{ScreenSpaceFluid, Search},
};

/// Transform and particle radius of a fluid.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuFluid {
    pub(crate) world_from_local: Mat4,
    pub(crate) radius: f32,
}

/// Appearance of a surface in a view, and how it is searched for, in view units.
#[derive(Clone, Copy, Default, PartialEq, ShaderType)]
pub(crate) struct GpuSurface {
    pub(crate) extinction: Vec3,
    pub(crate) refractive_index: f32,
    pub(crate) scattering: Vec3,
    pub(crate) perceptual_roughness: f32,
    pub(crate) emission: Vec3,
    pub(crate) radius: f32,
    pub(crate) behind: Vec4,
    pub(crate) softness: f32,
    pub(crate) coarse_samples: u32,
    pub(crate) contact: f32,
    pub(crate) sheet: f32,
}

/// Thickness of a sheet of one particle with its bumps, in radii.
pub(super) const SHEET: f32 = 2.5;

impl GpuSurface {
    /// A surface of particles of `radius` in the world, for a view whose metres are `view_scale`
    /// times the world's.
    pub(crate) fn new(
        material: &FluidMaterial,
        settings: &ScreenSpaceFluid,
        radius: f32,
        view_scale: f32,
        exposure: f32,
    ) -> Self {
        let medium = &material.medium;
        let radius = radius * view_scale;
        Self {
            extinction: medium.extinction() / view_scale,
            refractive_index: material.refractive_index,
            scattering: medium.scattered() / view_scale,
            perceptual_roughness: material.perceptual_roughness,
            emission: medium.emission.to_vec3() * exposure / view_scale,
            radius,
            behind: Vec4::ZERO,
            softness: match material.thickness {
                Thickness::Layers => 0.0,
                Thickness::Accumulated { softness } => softness,
            },
            coarse_samples: match settings.search {
                Search::Secant => 0,
                Search::Bracketed { coarse_samples } => coarse_samples,
            },
            contact: settings.contact * radius,
            sheet: 0.0,
        }
    }
}
