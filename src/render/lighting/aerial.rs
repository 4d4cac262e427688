//! The atmosphere of a view.

use bevy::{
    pbr::{GpuAtmosphereSettings, resources::GpuAtmosphere},
    prelude::*,
    render::render_resource::ShaderType,
};

/// `Aerial` in `optics.wgsl`. The default is no atmosphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, ShaderType)]
pub(super) struct GpuAerial {
    up: Vec3,
    radius: f32,
    inner_radius: f32,
    outer_radius: f32,
    scale: f32,
    distance: f32,
    slices: f32,
}

impl GpuAerial {
    /// For an eye in the world.
    pub(super) fn new(
        atmosphere: &GpuAtmosphere,
        settings: &GpuAtmosphereSettings,
        eye: Vec3,
    ) -> Self {
        let eye = atmosphere.world_to_atmosphere.transform_point3(eye);
        Self {
            up: eye.try_normalize().unwrap_or(Vec3::Y),
            radius: eye.length().max(atmosphere.inner_radius),
            inner_radius: atmosphere.inner_radius,
            outer_radius: atmosphere.outer_radius,
            scale: atmosphere.world_to_atmosphere.x_axis.length(),
            distance: settings.aerial_view_lut_max_distance,
            slices: settings.aerial_view_lut_size.z as f32,
        }
    }
}
