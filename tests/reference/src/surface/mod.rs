//! Surfaces of bodies, as rays meet them.

mod cuboid;
mod figure;
mod half_space;
mod pool;
mod sphere;
mod union;

use glam::DVec3;

use crate::Ray;

pub use cuboid::Cuboid;
pub use figure::Figure;
pub use half_space::HalfSpace;
pub use pool::{RippledPool, Wave};
pub use sphere::Sphere;
pub use union::Union;
pub(crate) use union::keep_outermost;

/// A point where a ray goes through a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance from the ray's origin, m; negative behind it.
    pub t: f64,
    /// Unit normal, out of the body.
    pub normal: DVec3,
    /// Whether the ray comes into the body here; else it leaves.
    pub entering: bool,
    /// Which body this is, where a surface tells several apart; else 0.
    pub body: usize,
}

/// The surface of one body or of several.
pub trait Surface: Send + Sync {
    /// Appends the crossings of the ray in order of distance.
    ///
    /// Those behind the origin may be left out. Of each body they take turns: in, out, in, out.
    fn crossings(&self, ray: &Ray, out: &mut Vec<Crossing>);

    /// The body that a point is in.
    fn inside(&self, point: DVec3) -> Option<usize>;

    /// How far a point is from the surface and which way is out, where that is known.
    ///
    /// A surface that lies a little too deep everywhere still has the right normals in this sense,
    /// so that offset and roughness can be told apart.
    fn nearest(&self, _point: DVec3) -> Option<Nearest> {
        None
    }

    /// The simple bodies that it is the union of, for other programs; none where it has another form.
    fn figures(&self) -> Vec<Figure> {
        Vec::new()
    }
}

/// What a point is to the part of a surface that is nearest to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Distance, m; negative inside.
    pub distance: f64,
    /// Outward unit normal.
    pub normal: DVec3,
}

/// A crossing of body 0 whose direction follows from the normal.
fn crossing(ray: &Ray, t: f64, normal: DVec3) -> Crossing {
    Crossing {
        t,
        normal,
        entering: normal.dot(ray.direction) < 0.0,
        body: 0,
    }
}
