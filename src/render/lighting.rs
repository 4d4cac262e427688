//! The light that falls on a body, for its uniform.

use bevy::{
    prelude::*,
    render::{render_asset::RenderAssets, texture::GpuImage},
};

use super::{
    extract::{FluidLights, ViewSurroundings},
    gpu_types::GpuBody,
};

/// The cubemaps of a body.
#[derive(Clone, Copy)]
pub(crate) struct Cubemaps {
    /// The distant surroundings.
    pub(crate) environment: Option<AssetId<Image>>,
    /// The light that falls on a matte surface.
    pub(crate) diffuse: Option<AssetId<Image>>,
}

/// The light on the bodies of a view.
pub(crate) struct Lighting<'a> {
    pub(crate) surroundings: &'a ViewSurroundings,
    pub(crate) lights: &'a FluidLights,
    pub(crate) images: &'a RenderAssets<GpuImage>,
    pub(crate) clear_color: Color,
    pub(crate) exposure: f32,
}

impl Lighting<'_> {
    /// Sets everything about light in a body's uniform.
    pub(crate) fn shine_on(&self, body: &mut GpuBody, emission: LinearRgba) -> Cubemaps {
        body.lights = self.lights.lights;
        body.clear_color = self.clear_color.to_linear().to_vec3();
        body.even_light = self.lights.even(self.surroundings.ambient) * self.exposure;
        body.emission = emission.to_vec3() * self.exposure;
        let map = self.surroundings.map.as_ref();
        let environment = map
            .map(|map| map.image.id())
            .filter(|id| self.is_cubemap(*id));
        let diffuse = map
            .and_then(|map| Some(map.diffuse.as_ref()?.id()))
            .filter(|id| self.is_cubemap(*id));
        if let Some(map) = map {
            // Cubemaps are left-handed.
            body.environment_from_world =
                Mat3::from_diagonal(vec3(1.0, 1.0, -1.0)) * Mat3::from_quat(map.rotation.inverse());
            let intensity = map.intensity * self.exposure;
            body.environment_intensity = if environment.is_some() {
                intensity
            } else {
                0.0
            };
            body.diffuse_intensity = if diffuse.is_some() { intensity } else { 0.0 };
        }
        Cubemaps {
            environment,
            diffuse,
        }
    }

    fn is_cubemap(&self, id: AssetId<Image>) -> bool {
        self.images
            .get(id)
            .is_some_and(|image| image.texture.depth_or_array_layers() == 6)
    }
}
