//! Lights and surroundings of the main world.

use bevy::{
    light::Skybox,
    prelude::*,
    render::{Extract, sync_world::RenderEntity},
};

use super::{GpuDirectionalLight, MAX_LIGHTS};
use crate::settings::ScreenSpaceFluid;

/// A cubemap of the distant surroundings.
#[derive(Clone)]
pub(super) struct EnvironmentMap {
    pub(super) image: AssetId<Image>,
    /// The diffuse light by the normal of a matte surface.
    pub(super) diffuse: Option<AssetId<Image>>,
    /// cd/m² per texel value.
    pub(super) intensity: f32,
    pub(super) rotation: Quat,
}

/// The surroundings of the fluid in a view.
#[derive(Component, Clone, Default)]
pub(super) struct ViewSurroundings {
    pub(super) map: Option<EnvironmentMap>,
    /// The camera's own ambient light, cd/m².
    pub(super) ambient: Option<Vec3>,
}

pub(super) fn extract_surroundings(
    cameras: Extract<
        Query<
            (
                RenderEntity,
                Option<&EnvironmentMapLight>,
                Option<&Skybox>,
                Option<&AmbientLight>,
            ),
            (With<Camera3d>, With<ScreenSpaceFluid>),
        >,
    >,
    mut views: Query<&mut ViewSurroundings>,
    mut commands: Commands,
) {
    for (entity, light, skybox, ambient) in &cameras {
        let map = light
            .map(|light| EnvironmentMap {
                image: light.specular_map.id(),
                diffuse: Some(light.diffuse_map.id()),
                intensity: light.intensity,
                rotation: light.rotation,
            })
            .or_else(|| {
                let skybox = skybox?;
                Some(EnvironmentMap {
                    image: skybox.image.as_ref()?.id(),
                    // Like meshes, the medium is not lit by the sky box.
                    diffuse: None,
                    intensity: skybox.brightness,
                    rotation: skybox.rotation,
                })
            });
        let ambient = ambient.map(|light| luminance(light.color, light.brightness));
        let surroundings = ViewSurroundings { map, ambient };
        match views.get_mut(entity) {
            Ok(mut known) => *known = surroundings,
            Err(_) => {
                commands.entity(entity).insert(surroundings);
            }
        }
    }
}

/// The scene's distant lights.
#[derive(Resource, Default)]
pub(super) struct FluidLights {
    /// Unused slots are dark.
    pub(super) lights: [GpuDirectionalLight; MAX_LIGHTS],
    /// Mean over all directions of all directional lights, cd/m².
    mean: Vec3,
    /// Ambient light for cameras without their own, cd/m².
    ambient: Vec3,
}

impl FluidLights {
    /// The mean luminance over all directions, without environment maps; `ambient` is the camera's
    /// own.
    pub(super) fn even(&self, ambient: Option<Vec3>) -> Vec3 {
        self.mean + ambient.unwrap_or(self.ambient)
    }
}

fn luminance(color: Color, brightness: f32) -> Vec3 {
    color.to_linear().to_vec3() * brightness
}

pub(super) fn extract_lights(
    lights: Extract<Query<(&DirectionalLight, &GlobalTransform, &ViewVisibility)>>,
    ambient: Extract<Option<Res<GlobalAmbientLight>>>,
    mut extracted: ResMut<FluidLights>,
) {
    extracted.lights = default();
    extracted.mean = Vec3::ZERO;
    extracted.ambient = ambient
        .as_ref()
        .map_or(Vec3::ZERO, |light| luminance(light.color, light.brightness));
    let visible = lights.iter().filter(|(_, _, visibility)| visibility.get());
    for (slot, (light, transform, _)) in visible.enumerate() {
        let illuminance = luminance(light.color, light.illuminance);
        // The light from one direction, averaged over the sphere.
        extracted.mean += illuminance / (4.0 * core::f32::consts::PI);
        if let Some(slot) = extracted.lights.get_mut(slot) {
            *slot = GpuDirectionalLight {
                direction_to_light: transform.back().into(),
                illuminance,
            };
        }
    }
}
