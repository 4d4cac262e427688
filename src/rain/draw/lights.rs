//! The scene's lights, for rain.

use bevy::{
    camera::visibility::RenderLayers,
    pbr::{ExtractedDirectionalLight, ExtractedPointLight},
    prelude::*,
};

use super::{
    gpu_types::{GpuRainLight, GpuRainSun, MAX_LIGHTS, MAX_SUNS},
    lattice::Eye,
};
use crate::suns::suns_in_view;

/// Point and spot lights near a view, the brightest first.
#[derive(Default)]
pub(crate) struct NearLights {
    lights: Vec<NearLight>,
}

struct NearLight {
    gpu: GpuRainLight,
    range: f32,
    /// Half the angle of a spot light's cone; π for a point light.
    angle: f32,
    brightness: f32,
}

impl NearLights {
    /// Collects the lights that a view with these layers sees and that reach the visible volume;
    /// the first [`MAX_LIGHTS`] count.
    pub(crate) fn gather<'a>(
        &mut self,
        lights: impl Iterator<Item = (&'a ExtractedPointLight, &'a RenderLayers)>,
        view: &RenderLayers,
        place: Vec3,
        eye: &Eye,
    ) {
        self.lights.clear();
        self.lights.extend(lights.filter_map(|(light, layers)| {
            let position = light.transform.translation() - place;
            let away = position.length();
            let seen = layers.intersects(view)
                && eye.is_reached_from(position, light.range)
                && light.range > 0.0
                && light.intensity > 0.0;
            seen.then(|| {
                let gpu = gpu_light(light, position);
                NearLight {
                    gpu,
                    range: light.range,
                    angle: light
                        .spot_light_angles
                        .map_or(core::f32::consts::PI, |(_, outer)| outer),
                    brightness: gpu.intensity.max_element() / away.max(0.1).powi(2),
                }
            })
        }));
        self.lights
            .sort_unstable_by(|a, b| b.brightness.total_cmp(&a.brightness));
        self.lights.truncate(MAX_LIGHTS);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.lights.is_empty()
    }

    pub(crate) fn gpu(&self) -> [GpuRainLight; MAX_LIGHTS] {
        core::array::from_fn(|i| self.lights.get(i).map_or_else(default, |light| light.gpu))
    }

    /// A bit for each light that reaches a ball.
    pub(crate) fn reaching(&self, center: Vec3, radius: f32) -> u32 {
        self.lights.iter().enumerate().fold(0, |bits, (i, light)| {
            bits | (u32::from(light.reaches(center, radius)) << i)
        })
    }
}

impl NearLight {
    fn reaches(&self, center: Vec3, radius: f32) -> bool {
        let way = center - self.gpu.position;
        let away = way.length();
        if away > self.range + radius {
            return false;
        }
        if away <= radius {
            return true;
        }
        // The ball as seen from the light.
        let half_angle = (radius / away).asin();
        let off = (way.dot(self.gpu.direction) / away).clamp(-1.0, 1.0).acos();
        off <= self.angle + half_angle
    }
}

/// As in Bevy's own lighting: see `spot_light` in `bevy_pbr`'s `pbr_lighting.wgsl`.
fn gpu_light(light: &ExtractedPointLight, position: Vec3) -> GpuRainLight {
    let (spot_scale, spot_offset) = light
        .spot_light_angles
        .map_or((0.0, 1.0), |(inner, outer)| {
            let scale = 1.0 / (inner.cos() - outer.cos()).max(1e-4);
            (scale, -outer.cos() * scale)
        });
    GpuRainLight {
        position,
        inverse_range_squared: 1.0 / (light.range * light.range),
        intensity: light.color.to_vec3() * light.intensity,
        spot_scale,
        direction: light.transform.forward().into(),
        spot_offset,
    }
}

/// The brightest suns that a view with these layers sees, and their number.
pub(crate) fn suns<'a>(
    lights: impl Iterator<Item = (&'a ExtractedDirectionalLight, &'a RenderLayers)>,
    view: &RenderLayers,
) -> ([GpuRainSun; MAX_SUNS], u32) {
    let (suns, _) = suns_in_view(lights, view);
    let lit = suns.iter().filter(|sun| sun.illuminance != Vec3::ZERO);
    let count = lit.count() as u32;
    let suns = suns.map(|sun| GpuRainSun {
        direction: -sun.direction_to_light,
        illuminance: sun.illuminance,
    });
    (suns, count)
}
