//! A sky by formula: blue above, pale at the horizon, soft clouds, a glow around the sun.

use std::iter;

use bevy::{
    light::{EnvironmentMapLight, Skybox},
    prelude::*,
};

use super::{
    Scenery,
    cubemap::{Cubemap, cube_image},
};

const ZENITH: Vec3 = Vec3::new(0.08, 0.24, 0.66);
const HORIZON: Vec3 = Vec3::new(0.74, 0.90, 1.06);
const CLOUD: Vec3 = Vec3::new(1.35, 1.36, 1.40);
const GLOW: Vec3 = Vec3::new(1.0, 0.86, 0.62);
const GROUND: Vec3 = Vec3::new(0.32, 0.31, 0.28);
/// Unit: cd/m² for a radiance of 1. With Bevy's default exposure (EV100 9.7) 1000 is where white
/// begins; tone mapping needs more.
const BRIGHTNESS: f32 = 1600.0;

/// Texels along a face, and the mip levels for rougher and rougher reflections.
const SIDE: usize = 256;
const LEVELS: usize = 7;
const DIFFUSE_SIDE: usize = 8;

/// A sky as background and as light.
#[derive(Debug, Clone)]
pub struct Sky {
    /// `Rgba16Float` cube; its mip levels are blurred for rough reflections.
    pub image: Handle<Image>,
    /// `Rgba16Float` cube for diffuse light.
    pub diffuse: Handle<Image>,
    /// Unit: cd/m² for a texel of 1.
    pub brightness: f32,
}

impl Sky {
    /// The sky as a background, for a camera.
    pub fn skybox(&self) -> Skybox {
        Skybox {
            image: Some(self.image.clone()),
            brightness: self.brightness,
            ..default()
        }
    }

    /// The sky as light and reflection, for a camera.
    pub fn light(&self) -> EnvironmentMapLight {
        EnvironmentMapLight {
            diffuse_map: self.diffuse.clone(),
            specular_map: self.image.clone(),
            intensity: self.brightness,
            ..default()
        }
    }

    /// The sky as background, light and reflection, for a camera.
    pub fn bundle(&self) -> impl Bundle + use<> {
        (self.skybox(), self.light())
    }
}

impl Scenery<'_, '_> {
    /// Builds the sky, with its sun in the direction `to_sun`; takes some tenths of a second.
    pub fn sky(&mut self, to_sun: Vec3) -> Sky {
        let to_sun = to_sun.normalize_or(Vec3::Y);
        let sharp = Cubemap::from_fn(SIDE, |direction| radiance(direction, to_sun));
        let levels: Vec<Cubemap> = iter::successors(Some(sharp), |level| Some(level.halved()))
            .take(LEVELS)
            .collect();
        // Sixteen texels a face are plenty to light a matt surface.
        let diffuse = levels[4].diffused(DIFFUSE_SIDE);
        Sky {
            image: self.images.add(cube_image(&levels, "sky")),
            diffuse: self.images.add(cube_image(&[diffuse], "sky_diffuse")),
            brightness: BRIGHTNESS,
        }
    }
}

fn radiance(direction: Vec3, to_sun: Vec3) -> Vec3 {
    let up = direction.y;
    let clear = ZENITH.lerp(HORIZON, (1.0 - up.max(0.0)).powi(4));
    let cover = clouds(direction);
    // The disc itself is left to the directional light, which would otherwise shine twice.
    let towards_sun = direction.dot(to_sun).max(0.0);
    let glow =
        0.22 * towards_sun.powi(10) + 0.8 * towards_sun.powi(350) + 8.0 * towards_sun.powi(5000);
    let sky = clear.lerp(CLOUD, cover) + GLOW * glow * (1.0 - 0.6 * cover);
    // The ground pales towards the horizon as the sky does.
    let ground = GROUND.lerp(HORIZON, 0.8 * (1.0 + up.min(0.0)).powi(7));
    ground.lerp(sky, smoothstep(-0.012, 0.012, up))
}

/// How much of the sky is cloud in this direction, 0 to 1: noise on a plane above, so that clouds
/// shrink towards the horizon, where they fade.
fn clouds(direction: Vec3) -> f32 {
    let up = direction.y;
    if up <= 0.0 {
        return 0.0;
    }
    let place = Vec2::new(direction.x, direction.z) / (up + 0.18) * 1.6;
    let octaves = (0..5).map(|octave| {
        let scale = 2_f32.powi(octave);
        noise(place * scale + 17.0 * octave as f32) / (2.0 * scale)
    });
    0.85 * smoothstep(0.48, 0.78, octaves.sum()) * smoothstep(0.0, 0.25, up)
}

/// Smooth noise between 0 and 1, one random value at each whole place.
fn noise(place: Vec2) -> f32 {
    let corner = place.floor();
    let at = |x: i32, y: i32| hash(corner.x as i32 + x, corner.y as i32 + y);
    let t = place - corner;
    let t = t * t * (3.0 - 2.0 * t);
    let lower = at(0, 0).lerp(at(1, 0), t.x);
    let upper = at(0, 1).lerp(at(1, 1), t.x);
    lower.lerp(upper, t.y)
}

fn hash(x: i32, y: i32) -> f32 {
    let mut bits = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    for _ in 0..2 {
        bits = (bits ^ bits >> 15).wrapping_mul(0x2C1B_3C6D);
    }
    (bits >> 8) as f32 / (1 << 24) as f32
}

fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
