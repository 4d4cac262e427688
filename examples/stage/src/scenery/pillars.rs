//! A row of coloured pillars, distinguished by colour when seen through the liquid.

use bevy::{math::bounding::Aabb3d, prelude::*};

use super::Scenery;

/// Bands of a banded pillar, its own colour first and last.
const BANDS: u32 = 9;
const BAND: Color = Color::srgb(0.93, 0.92, 0.88);

impl Scenery<'_, '_> {
    /// `count` pillars in a row along x, behind the box as seen from +z, wider and higher than it.
    /// Every second one is banded.
    pub fn pillars(&mut self, box_in_front: Aabb3d, count: u32) {
        let (min, max) = (Vec3::from(box_in_front.min), Vec3::from(box_in_front.max));
        let size = max - min;
        let height = 1.35 * size.y;
        let spacing = 1.5 * size.x / count as f32;
        let radius = 0.24 * spacing;
        let whole = self.meshes.add(Cylinder::new(radius, height));
        let band = self
            .meshes
            .add(Cylinder::new(radius, height / BANDS as f32));
        let white = self.materials.add(paint(BAND));

        for pillar in 0..count {
            let colour = Color::hsl(360.0 * pillar as f32 / count as f32, 0.85, 0.45);
            let colour = self.materials.add(paint(colour));
            let x = (min.x + max.x) / 2.0 + (pillar as f32 + 0.5 - count as f32 / 2.0) * spacing;
            let z = min.z - 0.3 * size.z - radius;
            let is_banded = pillar % 2 == 1;
            let parts = if is_banded { BANDS } else { 1 };
            for part in 0..parts {
                let y = min.y + (part as f32 + 0.5) * height / parts as f32;
                self.commands.spawn((
                    Name::new(format!("pillar {pillar}")),
                    Mesh3d(if is_banded {
                        band.clone()
                    } else {
                        whole.clone()
                    }),
                    MeshMaterial3d(if part % 2 == 0 {
                        colour.clone()
                    } else {
                        white.clone()
                    }),
                    Transform::from_xyz(x, y, z),
                ));
            }
        }
    }
}

fn paint(colour: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        perceptual_roughness: 0.6,
        ..default()
    }
}
