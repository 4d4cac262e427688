//! Cubemaps made on the CPU. Everything is computed by direction rather than by face, so that faces
//! meet without seams.

use bevy::{
    asset::RenderAssetUsages,
    image::ImageSampler,
    math::Vec3,
    prelude::Image,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
};
use half::f16;

const FACES: usize = 6;
/// Samples of a blur, spread evenly over a disc.
const BLUR_SAMPLES: usize = 24;

/// Six square faces of radiances in Bevy's order: +x, -x, +y, -y, and then -z before +z, for
/// cubemaps are left-handed and Bevy's world is not.
#[derive(Clone)]
pub(crate) struct Cubemap {
    side: usize,
    texels: Vec<Vec3>,
}

impl Cubemap {
    pub(crate) fn from_fn(side: usize, radiance: impl Fn(Vec3) -> Vec3) -> Self {
        let texels = (0..FACES * side * side)
            .map(|texel| radiance(direction(side, texel)))
            .collect();
        Self { side, texels }
    }

    /// Half as large and blurred over a disc somewhat larger than a texel of the result.
    pub(crate) fn halved(&self) -> Self {
        let side = self.side / 2;
        let radius = 3.0 / side as f32;
        Self::from_fn(side, |center| {
            let (right, up) = center.any_orthonormal_pair();
            let sample = |i| {
                // A sunflower's seeds.
                let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
                let reach = radius * ((i as f32 + 0.5) / BLUR_SAMPLES as f32).sqrt();
                self.nearest(center + reach * (right * cos + up * sin))
            };
            (0..BLUR_SAMPLES).map(sample).sum::<Vec3>() / BLUR_SAMPLES as f32
        })
    }

    /// The light that a matt surface facing each direction receives: the mean over its hemisphere,
    /// weighted by the cosine.
    pub(crate) fn diffused(&self, side: usize) -> Self {
        let lights: Vec<(Vec3, Vec3, f32)> = self
            .texels
            .iter()
            .enumerate()
            .map(|(texel, radiance)| {
                let to_texel = on_cube(self.side, texel);
                // Texels away from the middle of a face are farther off and seen at an angle.
                (to_texel.normalize(), *radiance, to_texel.length().powi(-3))
            })
            .collect();
        Self::from_fn(side, |normal| {
            let (sum, weights) = lights.iter().fold(
                (Vec3::ZERO, 0.0),
                |(sum, weights), (direction, radiance, solid_angle)| {
                    let weight = solid_angle * normal.dot(*direction).max(0.0);
                    (sum + weight * radiance, weights + weight)
                },
            );
            sum / weights
        })
    }

    fn nearest(&self, direction: Vec3) -> Vec3 {
        let d = direction;
        let a = d.abs();
        // The inverse of `on_cube`.
        let (face, u, v, major) = if a.x >= a.y && a.x >= a.z {
            (usize::from(d.x < 0.0), d.z * d.x.signum(), -d.y, a.x)
        } else if a.y >= a.z {
            (2 + usize::from(d.y < 0.0), d.x, -d.z * d.y.signum(), a.y)
        } else {
            (4 + usize::from(d.z > 0.0), -d.x * d.z.signum(), -d.y, a.z)
        };
        let index = |w: f32| {
            let place = (w / major + 1.0) / 2.0 * self.side as f32;
            (place as usize).min(self.side - 1)
        };
        self.texels[(face * self.side + index(v)) * self.side + index(u)]
    }
}

/// From the middle of the cube to the middle of a texel; the cube reaches from -1 to 1.
fn on_cube(side: usize, texel: usize) -> Vec3 {
    let place = |i: usize| (i as f32 + 0.5) / side as f32 * 2.0 - 1.0;
    let (u, v) = (place(texel % side), place(texel / side % side));
    match texel / (side * side) {
        0 => Vec3::new(1.0, -v, u),
        1 => Vec3::new(-1.0, -v, -u),
        2 => Vec3::new(u, 1.0, -v),
        3 => Vec3::new(u, -1.0, v),
        4 => Vec3::new(u, -v, -1.0),
        _ => Vec3::new(-u, -v, 1.0),
    }
}

fn direction(side: usize, texel: usize) -> Vec3 {
    on_cube(side, texel).normalize()
}

/// A sky of radiances by unit direction in world space, as Bevy's skyboxes and environment maps
/// take it: an `Rgba16Float` cube of `side` texels along a face, without mip levels.
pub fn sky_cubemap(side: usize, radiance: impl Fn(Vec3) -> Vec3) -> Image {
    cube_image(&[Cubemap::from_fn(side, radiance)], "sky")
}

/// An `Rgba16Float` cube with these mip levels, the largest first.
pub(crate) fn cube_image(levels: &[Cubemap], label: &'static str) -> Image {
    let side = levels[0].side as u32;
    // All levels of a face, then the next face.
    let data = (0..FACES)
        .flat_map(|face| levels.iter().map(move |level| (face, level)))
        .flat_map(|(face, level)| {
            let texels = level.side * level.side;
            &level.texels[face * texels..(face + 1) * texels]
        })
        .flat_map(|radiance| radiance.extend(1.0).to_array())
        .flat_map(|channel| f16::from_f32(channel).to_le_bytes())
        .collect();

    let mut image = Image::new_uninit(
        Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: FACES as u32,
        },
        TextureDimension::D2,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.data = Some(data);
    image.texture_descriptor.label = Some(label);
    image.texture_descriptor.mip_level_count = levels.len() as u32;
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::Cube),
        ..Default::default()
    });
    image.sampler = ImageSampler::linear();
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texel_is_found_in_its_own_direction() {
        let directions = Cubemap::from_fn(8, |direction| direction);
        for texel in &directions.texels {
            assert_eq!(directions.nearest(*texel), *texel);
        }
    }

    #[test]
    fn blurring_leaves_an_even_sky_even() {
        let even = Cubemap::from_fn(16, |_| Vec3::splat(0.5));
        for blurred in [even.halved(), even.diffused(4)] {
            for texel in blurred.texels {
                assert!((texel - 0.5).abs().max_element() < 1e-5, "{texel}");
            }
        }
    }
}
