//! Cameras as Bevy has them: pixels to rays, points to device depth.

use glam::{DAffine3, DMat4, DQuat, DVec2, DVec3, UVec2};

use crate::Ray;

/// How a camera projects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// `PerspectiveProjection` of Bevy: reverse depth, the far plane at infinity.
    Perspective {
        /// Vertical angle of view, radians.
        fov: f64,
        /// Distance of the near plane, m.
        near: f64,
    },
    /// `OrthographicProjection` of Bevy with `ScalingMode::FixedVertical`: reverse depth.
    Orthographic {
        /// What is seen from the bottom to the top, m.
        height: f64,
        /// Distance of the near plane, m; may be negative.
        near: f64,
        /// Distance of the far plane, m.
        far: f64,
    },
}

/// A camera that looks along its own −z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width and height in pixels.
    pub size: UVec2,
    /// The projection.
    pub lens: Lens,
    /// Where the camera stands; without scale.
    pub world_from_view: DAffine3,
}

impl Camera {
    /// From the origin along −z.
    pub fn new(size: UVec2, lens: Lens) -> Self {
        Self {
            size,
            lens,
            world_from_view: DAffine3::IDENTITY,
        }
    }

    /// The same camera at `eye`, looking at `target`, turned as `Transform::looking_at` of
    /// Bevy turns it with +y upwards.
    pub fn looking_at(self, eye: DVec3, target: DVec3) -> Self {
        let back = (eye - target).normalize();
        let right = DVec3::Y
            .cross(back)
            .try_normalize()
            .unwrap_or_else(|| DVec3::Y.any_orthonormal_vector());
        let axes = glam::DMat3::from_cols(right, back.cross(right), back);
        Self {
            world_from_view: DAffine3::from_rotation_translation(DQuat::from_mat3(&axes), eye),
            ..self
        }
    }

    /// From world space to view space.
    pub fn view_from_world(&self) -> DAffine3 {
        self.world_from_view.inverse()
    }

    /// The matrix that Bevy gives the GPU.
    pub fn clip_from_view(&self) -> DMat4 {
        let half = self.half_extent();
        match self.lens {
            Lens::Perspective { fov, near } => {
                DMat4::perspective_infinite_reverse_rh(fov, half.x / half.y, near)
            }
            // Near and far change places, which reverses the depth.
            Lens::Orthographic { near, far, .. } => {
                DMat4::orthographic_rh(-half.x, half.x, -half.y, half.y, far, near)
            }
        }
    }

    /// The ray through a point on screen, from the near plane on, in world space.
    pub fn ray(&self, point: DVec2) -> Ray {
        let across = self.ndc(point) * self.half_extent();
        let (origin, direction) = match self.lens {
            Lens::Perspective { near, .. } => (across.extend(-1.0) * near, across.extend(-1.0)),
            Lens::Orthographic { near, .. } => (across.extend(-near), DVec3::NEG_Z),
        };
        Ray::new(
            self.world_from_view.transform_point3(origin),
            self.world_from_view.transform_vector3(direction),
        )
    }

    /// The ray through the middle of a pixel.
    pub fn pixel_ray(&self, pixel: UVec2) -> Ray {
        self.ray(pixel.as_dvec2() + 0.5)
    }

    /// View depth (m, positive forward) of a point in world space.
    pub fn view_depth(&self, world: DVec3) -> f64 {
        -self.view_from_world().transform_point3(world).z
    }

    /// Device depth of a view depth: 1 at the near plane, 0 at the far one.
    pub fn device_depth(&self, view_depth: f64) -> f64 {
        match self.lens {
            Lens::Perspective { near, .. } => near / view_depth,
            Lens::Orthographic { near, far, .. } => (far - view_depth) / (far - near),
        }
    }

    /// View depth of a device depth; infinite for 0 in perspective.
    pub fn view_from_device(&self, device_depth: f64) -> f64 {
        match self.lens {
            Lens::Perspective { near, .. } => near / device_depth,
            Lens::Orthographic { near, far, .. } => far - device_depth * (far - near),
        }
    }

    /// Point on screen and view depth of a point in world space; `None` behind the eye.
    pub fn project(&self, world: DVec3) -> Option<(DVec2, f64)> {
        let view = self.view_from_world().transform_point3(world);
        let extent = self.half_extent_at(-view.z);
        if extent.y <= 0.0 {
            return None;
        }
        let ndc = view.truncate() / extent;
        let point = (ndc * DVec2::new(0.5, -0.5) + 0.5) * self.size.as_dvec2();
        Some((point, -view.z))
    }

    /// The point in world space at a point on screen and a view depth.
    pub fn unproject(&self, point: DVec2, view_depth: f64) -> DVec3 {
        let across = self.ndc(point) * self.half_extent_at(view_depth);
        self.world_from_view
            .transform_point3(across.extend(-view_depth))
    }

    /// The size of a pixel at a view depth, m.
    pub fn pixel_size(&self, view_depth: f64) -> f64 {
        2.0 * self.half_extent_at(view_depth).y / f64::from(self.size.y)
    }

    fn ndc(&self, point: DVec2) -> DVec2 {
        (2.0 * point / self.size.as_dvec2() - 1.0) * DVec2::new(1.0, -1.0)
    }

    /// Half of what is seen across and upwards, at 1 m in perspective.
    fn half_extent(&self) -> DVec2 {
        let aspect = f64::from(self.size.x) / f64::from(self.size.y);
        let half_height = match self.lens {
            Lens::Perspective { fov, .. } => (0.5 * fov).tan(),
            Lens::Orthographic { height, .. } => 0.5 * height,
        };
        DVec2::new(aspect * half_height, half_height)
    }

    fn half_extent_at(&self, view_depth: f64) -> DVec2 {
        match self.lens {
            Lens::Perspective { .. } => self.half_extent() * view_depth,
            Lens::Orthographic { .. } => self.half_extent(),
        }
    }
}
