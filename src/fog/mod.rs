//! Bevy's distance fog, for what is drawn without Bevy's materials.

use bevy::{
    pbr::{DistanceFog, FogFalloff},
    prelude::*,
    render::render_resource::ShaderType,
    shader::load_shader_library,
};

/// `Fog` in `fog.wgsl`. The default is no fog.
#[derive(Clone, Copy, Debug, Default, PartialEq, ShaderType)]
pub(crate) struct GpuFog {
    color: Vec4,
    glow: Vec4,
    extinction: Vec3,
    glow_exponent: f32,
    inscattering: Vec3,
    falloff: u32,
}

impl GpuFog {
    pub(crate) fn new(fog: Option<&DistanceFog>) -> Self {
        let Some(fog) = fog else {
            return Self::default();
        };
        let (falloff, extinction, inscattering) = match fog.falloff {
            FogFalloff::Linear { start, end } => {
                let range = vec3(start, end.max(start + 1e-6), 0.0);
                (0, range, Vec3::ZERO)
            }
            FogFalloff::Exponential { density } => (1, Vec3::splat(density), Vec3::splat(density)),
            FogFalloff::Atmospheric {
                extinction,
                inscattering,
            } => (1, extinction, inscattering),
            FogFalloff::ExponentialSquared { density } => {
                (2, Vec3::splat(density), Vec3::splat(density))
            }
        };
        Self {
            color: fog.color.to_linear().to_vec4(),
            glow: fog.directional_light_color.to_linear().to_vec4(),
            extinction,
            glow_exponent: fog.directional_light_exponent,
            inscattering,
            falloff,
        }
    }
}

/// Loads the shader library, for whoever is added first.
pub(crate) struct FogShaderPlugin;

impl FogShaderPlugin {
    pub(crate) fn add(app: &mut App) {
        if !app.is_plugin_added::<Self>() {
            app.add_plugins(Self);
        }
    }
}

impl Plugin for FogShaderPlugin {
    fn build(&self, app: &mut App) {
        load_shader_library!(app, "fog.wgsl");
    }
}
