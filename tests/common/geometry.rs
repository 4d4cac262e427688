//! Rays, depths and ellipsoids in f64, in view space: what the GPU's f32 is held against.

use bevy::math::{Affine3A, DAffine3, DMat3, DVec2, DVec3, UVec2, Vec2, Vec3};
use bevy::prelude::Transform;
use bevy_fluid::shape::Splat;

use super::{Lens, View};

/// A ray from the near plane on, in view space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: DVec3,
    /// Unit length.
    pub(crate) direction: DVec3,
}

impl Ray {
    pub(crate) fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

impl View {
    /// The middle of a pixel.
    pub(crate) fn center(pixel: UVec2) -> DVec2 {
        pixel.as_dvec2() + 0.5
    }

    /// From a point on screen in pixels.
    pub(crate) fn ndc(&self, point: DVec2) -> DVec2 {
        (2.0 * point / self.size.as_dvec2() - 1.0) * DVec2::new(1.0, -1.0)
    }

    fn half_extent(&self) -> DVec2 {
        let aspect = f64::from(self.size.x) / f64::from(self.size.y);
        let half_height = match self.lens {
            Lens::Perspective { fov, .. } => (0.5 * f64::from(fov)).tan(),
            Lens::Orthographic { height, .. } => 0.5 * f64::from(height),
            Lens::Matrix(_) => panic!("a matrix has no one extent"),
        };
        DVec2::new(aspect * half_height, half_height)
    }

    /// The ray through a point on screen in pixels.
    pub(crate) fn ray(&self, point: DVec2) -> Ray {
        if let Lens::Matrix(clip_from_view) = self.lens {
            let view_from_clip = clip_from_view.as_dmat4().inverse();
            let [near, far] =
                [1.0, 0.0].map(|d| view_from_clip * self.ndc(point).extend(d).extend(1.0));
            // The far point may be at infinity (w = 0).
            let along = far.truncate() * near.w - near.truncate() * far.w;
            return Ray {
                origin: near.truncate() / near.w,
                direction: (along * near.w.signum()).normalize(),
            };
        }
        let across = self.ndc(point) * self.half_extent();
        match self.lens {
            Lens::Perspective { near, .. } => {
                let along = across.extend(-1.0);
                Ray {
                    origin: along * f64::from(near),
                    direction: along.normalize(),
                }
            }
            Lens::Orthographic { near, .. } => Ray {
                origin: across.extend(-f64::from(near)),
                direction: DVec3::NEG_Z,
            },
            Lens::Matrix(_) => unreachable!("done above"),
        }
    }

    /// View depth, positive forward, of a device depth.
    pub(crate) fn depth(&self, device: f32) -> f64 {
        let device = f64::from(device);
        match self.lens {
            Lens::Perspective { near, .. } => f64::from(near) / device,
            Lens::Orthographic { near, far, .. } => f64::from(far) - device * f64::from(far - near),
            Lens::Matrix(_) => panic!("depth differs from pixel to pixel"),
        }
    }

    /// The point in view space at a point on screen in pixels and a device depth.
    pub(crate) fn unproject(&self, point: DVec2, device: f32) -> DVec3 {
        if let Lens::Matrix(clip_from_view) = self.lens {
            let clip = self.ndc(point).extend(device.into()).extend(1.0);
            let at = clip_from_view.as_dmat4().inverse() * clip;
            return at.truncate() / at.w;
        }
        let z = self.depth(device);
        let across = self.ndc(point) * self.half_extent();
        match self.lens {
            Lens::Perspective { .. } => (across * z).extend(-z),
            Lens::Orthographic { .. } => across.extend(-z),
            Lens::Matrix(_) => unreachable!("done above"),
        }
    }

    /// Half of what is seen across and upwards at a view depth.
    pub(crate) fn half_extent_at(&self, depth: f64) -> DVec2 {
        match self.lens {
            Lens::Perspective { .. } => self.half_extent() * depth,
            Lens::Orthographic { .. } | Lens::Matrix(_) => self.half_extent(),
        }
    }

    /// Device depth of a point in view space.
    pub(crate) fn device(&self, at: DVec3) -> f32 {
        let device = match self.lens {
            Lens::Perspective { near, .. } => f64::from(near) / -at.z,
            Lens::Orthographic { near, far, .. } => (f64::from(far) + at.z) / f64::from(far - near),
            Lens::Matrix(clip_from_view) => {
                let clip = clip_from_view.as_dmat4() * at.extend(1.0);
                clip.z / clip.w
            }
        };
        device as f32
    }

    /// Where a point of view space is on screen in pixels, if it is before the eye.
    pub(crate) fn project(&self, at: DVec3) -> Option<DVec2> {
        let ndc = match self.lens {
            Lens::Perspective { .. } => at.truncate() / -at.z / self.half_extent(),
            Lens::Orthographic { .. } => at.truncate() / self.half_extent(),
            Lens::Matrix(clip_from_view) => {
                let clip = clip_from_view.as_dmat4() * at.extend(1.0);
                clip.truncate().truncate() / clip.w
            }
        };
        let pixel = (ndc * DVec2::new(0.5, -0.5) + 0.5) * self.size.as_dvec2();
        // A parallel view has no eye to be behind.
        let before = at.z < 0.0 || matches!(self.lens, Lens::Orthographic { .. });
        before.then_some(pixel)
    }

    fn view_from_world(&self) -> DAffine3 {
        affine(&self.pose).inverse()
    }
}

fn affine(transform: &Transform) -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        transform.scale.as_dvec3(),
        transform.rotation.as_dquat(),
        transform.translation.as_dvec3(),
    )
}

/// The unit sphere under an affine map to view space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ellipsoid {
    view_from_unit: DAffine3,
    unit_from_view: DAffine3,
}

impl Ellipsoid {
    /// A particle of a fluid that stands at `transform`.
    pub(crate) fn new(view: &View, transform: &Transform, position: Vec3, radius: f32) -> Self {
        let sphere = DAffine3::from_scale_rotation_translation(
            DVec3::splat(radius.into()),
            Default::default(),
            position.as_dvec3(),
        );
        let view_from_unit = view.view_from_world() * affine(transform) * sphere;
        Self {
            view_from_unit,
            unit_from_view: view_from_unit.inverse(),
        }
    }

    /// A splat of a fluid that stands at `transform`.
    pub(crate) fn of_splat(view: &View, transform: &Transform, splat: &Splat) -> Self {
        let unit = DAffine3 {
            matrix3: splat.matrix().as_dmat3(),
            translation: Vec3::from(splat.center).as_dvec3(),
        };
        let view_from_unit = view.view_from_world() * affine(transform) * unit;
        Self {
            view_from_unit,
            unit_from_view: view_from_unit.inverse(),
        }
    }

    /// Particles of one radius in world space.
    pub(crate) fn spheres(view: &View, positions: &[Vec3], radius: f32) -> Vec<Self> {
        let place = Transform::IDENTITY;
        let sphere = |&position| Self::new(view, &place, position, radius);
        positions.iter().map(sphere).collect()
    }

    pub(crate) fn center(&self) -> DVec3 {
        self.view_from_unit.translation
    }

    /// Distances along the ray at which it enters and leaves; negative before its origin.
    pub(crate) fn crossings(&self, ray: &Ray) -> Option<[f64; 2]> {
        self.scaled_crossings(ray, 1.0)
    }

    /// The same for the ellipsoid scaled about its centre.
    pub(crate) fn scaled_crossings(&self, ray: &Ray, scale: f64) -> Option<[f64; 2]> {
        let o = self.unit_from_view.transform_point3(ray.origin);
        let d = self.unit_from_view.transform_vector3(ray.direction);
        let (a, b, c) = (d.dot(d), o.dot(d), o.dot(o) - scale * scale);
        let disc = b * b - a * c;
        (disc >= 0.0).then(|| [-1.0, 1.0].map(|sign| (-b + sign * disc.sqrt()) / a))
    }

    /// Outward unit normal at a point of the surface.
    pub(crate) fn normal(&self, at: DVec3) -> DVec3 {
        let unit = self.unit_from_view.transform_point3(at);
        let inverse: DMat3 = self.unit_from_view.matrix3;
        (inverse.transpose() * unit).normalize()
    }
}

/// The unit vector of an octahedral code.
pub(crate) fn decode_normal(code: [f32; 2]) -> DVec3 {
    bevy_fluid::render::decode_normal(code).as_dvec3()
}

/// Degrees between two vectors, exact for small angles too.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}
