//! Directional lights, for what is drawn without Bevy's materials.

use bevy::{camera::visibility::RenderLayers, pbr::ExtractedDirectionalLight, prelude::*};

/// Light from one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sun {
    pub(crate) direction_to_light: Vec3,
    /// lx, times the light's colour.
    pub(crate) illuminance: Vec3,
}

/// The brightest `N` suns that a view with these layers sees, and the sum of the illuminance of all.
/// Suns beyond those there are are dark.
pub(crate) fn suns_in_view<'a, const N: usize>(
    lights: impl Iterator<Item = (&'a ExtractedDirectionalLight, &'a RenderLayers)>,
    view: &RenderLayers,
) -> ([Sun; N], Vec3) {
    let mut suns = [Sun::default(); N];
    let mut sum = Vec3::ZERO;
    let brightness = |sun: &Sun| sun.illuminance.max_element();
    for (light, _) in lights.filter(|(_, layers)| layers.intersects(view)) {
        let sun = Sun {
            direction_to_light: light.transform.back().into(),
            illuminance: light.color.to_vec3() * light.illuminance,
        };
        sum += sun.illuminance;
        // In its place among the others; the last one drops out.
        let at = suns.partition_point(|other| brightness(other) >= brightness(&sun));
        if at < N {
            suns[at..].rotate_right(1);
            suns[at] = sun;
        }
    }
    (suns, sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(illuminance: f32) -> ExtractedDirectionalLight {
        ExtractedDirectionalLight {
            color: LinearRgba::WHITE,
            illuminance,
            transform: GlobalTransform::IDENTITY,
            shadow_maps_enabled: false,
            contact_shadows_enabled: false,
            volumetric: false,
            affects_lightmapped_mesh_diffuse: false,
            shadow_depth_bias: 0.0,
            shadow_normal_bias: 0.0,
            cascade_shadow_config: default(),
            cascades: default(),
            frusta: default(),
            soft_shadow_size: None,
            occlusion_culling: false,
            sun_disk_angular_size: 0.0,
            sun_disk_intensity: 0.0,
        }
    }

    #[test]
    fn the_brightest_in_view_count() {
        let lights = [3.0, 1.0, 8.0, 5.0, 9.0].map(light);
        let [here, elsewhere] = [0, 1].map(RenderLayers::layer);
        let layers = [&here, &here, &here, &here, &elsewhere];
        let (suns, sum) = suns_in_view::<2>(lights.iter().zip(layers), &here);
        assert_eq!(suns.map(|sun| sun.illuminance.x), [8.0, 5.0]);
        assert_eq!(sum.x, 17.0);
        let (suns, _) = suns_in_view::<2>(lights.iter().zip(layers), &elsewhere);
        assert_eq!(suns.map(|sun| sun.illuminance.x), [9.0, 0.0]);
    }
}
