//! Direct light.

use bevy::{
    light::{CascadeShadowConfigBuilder, light_consts::lux},
    prelude::*,
};

use super::Scenery;

impl Scenery<'_, '_> {
    /// A sun in the direction `to_sun`, slightly warm, at 10,000 lux, which suits Bevy's default
    /// exposure. Shadows, if `shadows` is set, are drawn up to `reach` from the camera.
    pub fn sun(&mut self, to_sun: Vec3, reach: f32, shadows: bool) -> Entity {
        // The builder requires bounds in order, whatever the reach.
        let reach = reach.max(0.01);
        let cascades = CascadeShadowConfigBuilder {
            num_cascades: 2,
            minimum_distance: reach / 200.0,
            first_cascade_far_bound: reach / 2.0,
            maximum_distance: reach,
            ..default()
        };
        self.commands
            .spawn((
                Name::new("sun"),
                DirectionalLight {
                    color: Color::srgb(1.0, 0.96, 0.88),
                    illuminance: lux::AMBIENT_DAYLIGHT,
                    shadow_maps_enabled: shadows,
                    ..default()
                },
                cascades.build(),
                Transform::default().looking_to(-to_sun, Vec3::Y),
            ))
            .id()
    }
}
