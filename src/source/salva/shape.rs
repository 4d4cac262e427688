//! From components and meshes to the simulation's geometry.

use bevy::{
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};

use super::{
    SalvaError, SalvaShape,
    world::{Geometry, Recipe, Triangle},
};

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
    let greatest = factors.max_element();
    let length = |length: f32| {
        let length = length * greatest;
        let is_sound = length.is_finite() && length > 0.0;
        is_sound.then_some(length).ok_or(SalvaError::Shape(shape))
    };
    let half = |size: Vec3| {
        let half = 0.5 * size * factors;
        let is_sound = half.is_finite() && half.cmpgt(Vec3::ZERO).all();
        is_sound.then_some(half).ok_or(SalvaError::Shape(shape))
    };
    let geometry = match shape {
        SalvaShape::Cuboid { size } => Some(Geometry::cuboid(half(size)?)),
        SalvaShape::Sphere { radius } => Some(Geometry::sphere(length(radius)?)),
        SalvaShape::Capsule {
            radius,
            length: shaft,
        } => {
            // A shaft of no length makes a ball.
            let shaft = if shaft == 0.0 { 0.0 } else { length(shaft)? };
            Some(Geometry::capsule(length(radius)?, 0.5 * shaft))
        }
        SalvaShape::Cylinder { radius, height } => {
            Geometry::cylinder(length(radius)?, 0.5 * length(height)?)
        }
        SalvaShape::Tank { .. } | SalvaShape::Plane if is_body => {
            return Err(SalvaError::BodyShape);
        }
        SalvaShape::Tank { size } => Geometry::tank(half(size)?),
        SalvaShape::Plane => Some(Geometry::plane()),
        SalvaShape::Mesh => {
            let faces = mesh.and_then(|mesh| triangles(mesh, scale));
            let faces = faces.ok_or(SalvaError::Mesh)?;
            let recipe = if is_body { Recipe::Hull } else { Recipe::Mesh };
            return Ok(recipe(faces));
        }
    };
    geometry.map(Recipe::Made).ok_or(SalvaError::Shape(shape))
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
