//! The surroundings of the main world.

use bevy::{
    light::Skybox,
    prelude::*,
    render::{Extract, sync_world::RenderEntity},
};

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
    /// Ambient light: the camera's own, or the scene's. Unit: cd/m².
    pub(super) ambient: Vec3,
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
    scene_ambient: Extract<Option<Res<GlobalAmbientLight>>>,
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
        let own = ambient.map(|light| (light.color, light.brightness));
        let scene = scene_ambient.as_ref();
        let ambient = own.or_else(|| scene.map(|light| (light.color, light.brightness)));
        let ambient = ambient.map_or(Vec3::ZERO, |(color, brightness)| {
            color.to_linear().to_vec3() * brightness
        });
        let surroundings = ViewSurroundings { map, ambient };
        match views.get_mut(entity) {
            Ok(mut known) => *known = surroundings,
            Err(_) => {
                commands.entity(entity).insert(surroundings);
            }
        }
    }
}
