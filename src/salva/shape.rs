//! From components and meshes to what the simulation takes.

use bevy::{
    mesh::{Indices, PrimitiveTopology},
    prelude::*,
};

use super::{
    SalvaError, SalvaShape,
    world::{Geometry, Triangle},
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

/// The shape of a boundary, or of a body.
pub(crate) fn geometry(
    shape: SalvaShape,
    scale: Mat3,
    mesh: Option<&Mesh>,
    is_body: bool,
) -> Result<Geometry, SalvaError> {
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
    match shape {
        SalvaShape::Cuboid { size } => Ok(Geometry::cuboid(half(size)?)),
        SalvaShape::Sphere { radius } => Ok(Geometry::sphere(length(radius)?)),
        SalvaShape::Capsule {
            radius,
            length: shaft,
        } => {
            // A shaft of no length makes a ball.
            let shaft = if shaft == 0.0 { 0.0 } else { length(shaft)? };
            Ok(Geometry::capsule(length(radius)?, 0.5 * shaft))
        }
        SalvaShape::Cylinder { radius, height } => {
            let cylinder = Geometry::cylinder(length(radius)?, 0.5 * length(height)?);
            cylinder.ok_or(SalvaError::Shape(shape))
        }
        SalvaShape::Tank { .. } | SalvaShape::Plane if is_body => Err(SalvaError::BodyShape),
        SalvaShape::Tank { size } => Geometry::tank(half(size)?).ok_or(SalvaError::Shape(shape)),
        SalvaShape::Plane => Ok(Geometry::plane()),
        SalvaShape::Mesh => {
            let faces = mesh.and_then(|mesh| triangles(mesh, scale));
            let faces = faces.ok_or(SalvaError::Mesh)?;
            let geometry = if is_body {
                Geometry::hull(&faces)
            } else {
                Geometry::mesh(faces)
            };
            geometry.ok_or(SalvaError::Mesh)
        }
    }
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
