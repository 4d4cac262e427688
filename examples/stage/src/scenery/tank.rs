//! A tank of glass, open above and below.

use bevy::{light::NotShadowCaster, math::bounding::Aabb3d, prelude::*};

use super::Scenery;

/// Thickness of the walls over the longest side of the tank.
const THICKNESS: f32 = 0.012;
const GLASS: Color = Color::srgba(0.72, 0.9, 0.9, 0.07);
/// Colour of the edges, where one looks along the glass rather than through it: green from its
/// iron.
const EDGE: Color = Color::srgba(0.55, 0.8, 0.76, 0.45);

impl Scenery<'_, '_> {
    /// Walls around the four sides of `inside`, the space for the liquid, with visible edges.
    pub fn tank(&mut self, inside: Aabb3d) {
        let (min, max) = (Vec3::from(inside.min), Vec3::from(inside.max));
        let (center, size) = ((min + max) / 2.0, max - min);
        let thickness = THICKNESS * size.max_element();
        let glass = self.materials.add(clear(GLASS));
        let edge = self.materials.add(clear(EDGE));
        // To the middle of the glass.
        let reach = (size + thickness) / 2.0;

        for side in [-1.0, 1.0] {
            let wall_x = Vec3::new(thickness, size.y, size.z);
            let wall_z = Vec3::new(size.x, size.y, thickness);
            self.pane(&glass, wall_x, center + side * reach.x * Vec3::X);
            self.pane(&glass, wall_z, center + side * reach.z * Vec3::Z);

            let rim = center + reach.y * Vec3::Y;
            let rim_x = Vec3::new(thickness, thickness, size.z + 2.0 * thickness);
            let rim_z = Vec3::new(size.x, thickness, thickness);
            self.pane(&edge, rim_x, rim + side * reach.x * Vec3::X);
            self.pane(&edge, rim_z, rim + side * reach.z * Vec3::Z);

            for other in [-1.0, 1.0] {
                let corner = reach * Vec3::new(side, 0.0, other);
                self.pane(
                    &edge,
                    Vec3::new(thickness, size.y, thickness),
                    center + corner,
                );
            }
        }
    }

    fn pane(&mut self, material: &Handle<StandardMaterial>, size: Vec3, at: Vec3) {
        self.commands.spawn((
            Name::new("glass"),
            Mesh3d(self.meshes.add(Cuboid::from_size(size))),
            MeshMaterial3d(material.clone()),
            Transform::from_translation(at),
            NotShadowCaster,
        ));
    }
}

fn clear(colour: Color) -> StandardMaterial {
    StandardMaterial {
        base_color: colour,
        alpha_mode: AlphaMode::Blend,
        perceptual_roughness: 0.1,
        ..default()
    }
}
