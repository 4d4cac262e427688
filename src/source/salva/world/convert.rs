//! The one place where Bevy's vectors meet salva's (nalgebra) and rapier's (another glam).

use bevy::prelude::*;
use salva3d::rapier::math::{Pose, Rotation};

/// salva's vector.
pub(crate) type LiquidVector = salva3d::math::Vector<f32>;
/// rapier's vector.
pub(crate) type RigidVector = salva3d::rapier::math::Vector;

pub(crate) fn liquid(v: Vec3) -> LiquidVector {
    LiquidVector::new(v.x, v.y, v.z)
}

pub(crate) fn from_liquid(v: &LiquidVector) -> Vec3 {
    vec3(v.x, v.y, v.z)
}

pub(crate) fn rigid(v: Vec3) -> RigidVector {
    v.to_array().into()
}

pub(crate) fn from_rigid(v: RigidVector) -> Vec3 {
    v.to_array().into()
}

pub(crate) fn pose(at: Isometry3d) -> Pose {
    let [x, y, z, w] = at.rotation.to_array();
    Pose::from_parts(
        rigid(at.translation.into()),
        Rotation::from_xyzw(x, y, z, w),
    )
}

pub(crate) fn from_pose(pose: &Pose) -> Isometry3d {
    Isometry3d::new(
        from_rigid(pose.translation),
        Quat::from_array(pose.rotation.to_array()),
    )
}
