//! From components and meshes to the simulation's geometry.

use bevy::{
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};

use super::{
    SalvaError, SalvaShape,
    world::{Geometry, Recipe, Triangle},
};
use crate::source::solid::SolidShape;

/// An entity's place without its scale, and the scale, shear included, by itself.
pub(crate) fn split(transform: &GlobalTransform) -> Result<(Isometry3d, Mat3), SalvaError> {
    let affine = transform.affine();
    let (_, rotation, translation) = transform.to_scale_rotation_translation();
    if !affine.is_finite() || !rotation.is_finite() {
        return Err(SalvaError::Transform);
    }
    let scale = Mat3::from_quat(rotation.inverse()) * Mat3::from(affine.matrix3);
    Ok((Isometry3d::new(translation, rotation), scale))
}

/// The recipe for the shape of a boundary or of a body.
pub(crate) fn recipe(
    shape: SalvaShape,
    scale: Mat3,
    mesh: Option<&Mesh>,
    is_body: bool,
) -> Result<Recipe, SalvaError> {
    let factors = vec3(
        scale.x_axis.length(),
        scale.y_axis.length(),
        scale.z_axis.length(),
    );
    let refused = SalvaError::Shape(shape);
    let geometry = match shape {
        SalvaShape::Tank { .. } | SalvaShape::Solid(SolidShape::Ground) if is_body => {
            return Err(SalvaError::BodyShape);
        }
        SalvaShape::Tank { half_size } => {
            Geometry::tank(sound(half_size * factors).ok_or(refused)?)
        }
        SalvaShape::Solid(solid) => solid_geometry(solid.scaled(factors)),
        SalvaShape::Mesh => {
            let faces = mesh.and_then(|mesh| triangles(mesh, scale));
            let faces = faces.ok_or(SalvaError::Mesh)?;
            let recipe = if is_body { Recipe::Hull } else { Recipe::Mesh };
            return Ok(recipe(faces));
        }
    };
    geometry.map(Recipe::Made).ok_or(refused)
}

/// None where a size is not finite and above 0.
fn solid_geometry(solid: SolidShape) -> Option<Geometry> {
    match solid {
        SolidShape::Ground => Some(Geometry::plane()),
        SolidShape::Sphere { radius } => {
            sound(Vec3::splat(radius)).map(|_| Geometry::sphere(radius))
        }
        SolidShape::Cuboid { half_size } => sound(half_size).map(Geometry::cuboid),
        SolidShape::Capsule {
            radius,
            half_length,
        } => {
            // A shaft of no length makes a ball.
            sound(vec3(radius, radius, radius + half_length))?;
            (half_length >= 0.0).then(|| Geometry::capsule(radius, half_length))
        }
        SolidShape::Cylinder {
            radius,
            half_height,
        } => {
            sound(vec3(radius, radius, half_height))?;
            Geometry::cylinder(radius, half_height)
        }
    }
}

fn sound(size: Vec3) -> Option<Vec3> {
    (size.is_finite() && size.cmpgt(Vec3::ZERO).all()).then_some(size)
}

/// The triangles of a mesh, scaled. A scale that mirrors turns them round again.
fn triangles(mesh: &Mesh, scale: Mat3) -> Option<Vec<Triangle>> {
    if mesh.primitive_topology() != PrimitiveTopology::TriangleList {
        return None;
    }
    let positions = mesh.try_attribute(Mesh::ATTRIBUTE_POSITION).ok()?;
    let positions = positions.as_float3()?;
    let corner = |i: usize| positions.get(i).map(|&corner| scale * Vec3::from(corner));
    let indices: Vec<usize> = match mesh.try_indices_option().ok()? {
        Some(indices) => Indices::iter(indices).collect(),
        None => (0..positions.len()).collect(),
    };
    let is_mirrored = scale.determinant() < 0.0;
    let faces = indices.chunks_exact(3).map(|face| {
        let [a, b, c] = [corner(face[0])?, corner(face[1])?, corner(face[2])?];
        Some(if is_mirrored { [a, c, b] } else { [a, b, c] })
    });
    let faces: Option<Vec<_>> = faces.collect();
    faces.filter(|faces| !faces.is_empty())
}
