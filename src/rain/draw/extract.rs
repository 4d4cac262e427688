//! Extraction of rain into the render world.

use bevy::{
    light::Skybox,
    prelude::*,
    render::{Extract, sync_component::SyncComponent, sync_world::RenderEntity},
};

use super::quads::RainQuads;
use crate::rain::{
    bake::{BakedStreaks, ReadyStreaks},
    clock::RainClock,
    settings::{Rain, RainShelter, is_place},
};
use crate::settings::Checked;

impl SyncComponent for Rain {
    type Target = (ExtractedRain, RainQuads);
}

/// A camera's rain. Cameras without rain, or with a rate of 0, lack this component.
#[doc(hidden)]
#[derive(Component, Clone)]
#[require(RainQuads)]
pub struct ExtractedRain {
    pub(crate) rain: Rain,
    pub(crate) clock: RainClock,
    pub(crate) streaks: ReadyStreaks,
    /// cd/m², from all directions.
    pub(crate) ambient: Vec3,
    pub(crate) environment: Option<EnvironmentMap>,
}

/// A cubemap of the distant surroundings.
#[derive(Clone, Copy)]
pub(crate) struct EnvironmentMap {
    pub(crate) image: AssetId<Image>,
    /// cd/m² per texel value.
    pub(crate) intensity: f32,
    pub(crate) rotation: Quat,
}

impl EnvironmentMap {
    /// Prefers the map for diffuse light to the sky itself, since a drop gathers light from a wide
    /// cone.
    fn of(light: Option<&EnvironmentMapLight>, skybox: Option<&Skybox>) -> Option<Self> {
        let from_light = light.map(|light| Self {
            image: light.diffuse_map.id(),
            intensity: light.intensity,
            rotation: light.rotation,
        });
        from_light.or_else(|| {
            let skybox = skybox?;
            Some(Self {
                image: skybox.image.as_ref()?.id(),
                intensity: skybox.brightness,
                rotation: skybox.rotation,
            })
        })
    }
}

pub(crate) fn extract_rain(
    cameras: Extract<
        Query<
            (
                RenderEntity,
                &Checked<Rain>,
                &RainClock,
                Option<&AmbientLight>,
                Option<&EnvironmentMapLight>,
                Option<&Skybox>,
            ),
            With<Camera3d>,
        >,
    >,
    streaks: Extract<Res<BakedStreaks>>,
    ambient: Extract<Res<GlobalAmbientLight>>,
    mut extracted: Query<&mut ExtractedRain>,
    mut commands: Commands,
) {
    for (entity, rain, clock, own_ambient, light, skybox) in &cameras {
        let known = extracted.get_mut(entity);
        let ready = streaks.ready().filter(|_| rain.rate > 0.0);
        let Some(streaks) = ready else {
            if known.is_ok() {
                commands
                    .entity(entity)
                    .remove::<<Rain as SyncComponent>::Target>();
            }
            continue;
        };
        let (color, brightness) = own_ambient.map_or((ambient.color, ambient.brightness), |own| {
            (own.color, own.brightness)
        });
        let new = ExtractedRain {
            rain: **rain,
            clock: *clock,
            streaks: streaks.clone(),
            ambient: color.to_linear().to_vec3() * brightness,
            environment: EnvironmentMap::of(light, skybox),
        };
        match known {
            Ok(mut known) => *known = new,
            Err(_) => {
                commands.entity(entity).insert(new);
            }
        }
    }
}

/// The boxes that keep rain off.
#[derive(Resource, Default)]
pub(crate) struct Shelters(pub(crate) Vec<(GlobalTransform, Vec3)>);

pub(crate) fn extract_shelters(
    shelters: Extract<Query<(&Checked<RainShelter>, &GlobalTransform)>>,
    mut extracted: ResMut<Shelters>,
) {
    extracted.0.clear();
    for (shelter, transform) in &shelters {
        if is_place(transform) {
            extracted.0.push((*transform, shelter.half_size));
        }
    }
}
