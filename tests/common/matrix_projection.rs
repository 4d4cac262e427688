//! A camera's projection that is any matrix at all.

use bevy::{
    camera::{CameraProjection, SubCameraView},
    math::Vec3A,
    prelude::*,
};

/// Clip from view, whatever the size of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fixed(pub(super) Mat4);

impl CameraProjection for Fixed {
    fn get_clip_from_view(&self) -> Mat4 {
        self.0
    }

    fn get_clip_from_view_for_sub(&self, _: &SubCameraView) -> Mat4 {
        self.0
    }

    fn update(&mut self, _: f32, _: f32) {}

    fn far(&self) -> f32 {
        1000.0
    }

    fn get_frustum_corners(&self, z_near: f32, z_far: f32) -> [Vec3A; 8] {
        // Asked for by shadows only; these cameras have none.
        [z_near, z_near, z_near, z_near, z_far, z_far, z_far, z_far].map(|z| Vec3A::NEG_Z * z)
    }
}
