//! What a camera sees of a surface: its nearest front and its farthest back.

use glam::DVec3;

use crate::{Camera, Crossing, Image, Ray, Surface};

/// Where a pixel's ray meets a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the pixel's ray from the near plane, m.
    pub t: f64,
    /// Distance from the eye along the axis of the view, m.
    pub view_depth: f64,
    /// Reverse device depth.
    pub device_depth: f64,
    /// Outward unit normal in world space.
    pub normal: DVec3,
}

/// The liquid along one pixel's ray, holes included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The nearest front. Where the ray starts inside: the near plane, its normal towards the eye.
    pub front: Hit,
    /// The farthest back.
    pub back: Hit,
}

/// Front and back for the middle of every pixel; `None` where the surface is not met.
///
/// The same pair of depths as the renderer keeps in one of its layers. Bodies must be bounded.
pub fn layers(camera: &Camera, surface: &dyn Surface) -> Image<Option<Span>> {
    Image::from_fn(camera.size, |pixel| {
        let ray = camera.pixel_ray(pixel);
        let mut crossings = Vec::new();
        surface.crossings(&ray, &mut crossings);
        crossings.retain(|crossing| crossing.t >= 0.0);
        let back = crossings.iter().rfind(|crossing| !crossing.entering)?;
        let near = Crossing {
            t: 0.0,
            normal: -ray.direction,
            entering: true,
            body: back.body,
        };
        let front = crossings.first().filter(|first| first.entering);
        Some(Span {
            front: hit(camera, &ray, front.unwrap_or(&near)),
            back: hit(camera, &ray, back),
        })
    })
}

fn hit(camera: &Camera, ray: &Ray, crossing: &Crossing) -> Hit {
    let view_depth = camera.view_depth(ray.at(crossing.t));
    Hit {
        t: crossing.t,
        view_depth,
        device_depth: camera.device_depth(view_depth),
        normal: crossing.normal,
    }
}
