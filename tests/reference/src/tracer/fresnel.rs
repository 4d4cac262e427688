//! A ray at an interface.

use glam::DVec3;

/// What a smooth interface between two dielectrics does to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// The fraction of unpolarised light that is reflected (Fresnel's equations).
    pub reflectance: f64,
    /// Unit direction of what is reflected.
    pub reflected: DVec3,
    /// Unit direction of what goes on (Snell's law); `None` under total reflection.
    pub refracted: Option<DVec3>,
}

/// A ray meets an interface whose unit normal faces it. `eta`: refractive index on the ray's side
/// over that beyond.
///
/// A normal that does not face the ray, as interpolated ones at an outline may not, is turned
/// until the ray grazes it.
pub fn meet(direction: DVec3, normal: DVec3, eta: f64) -> Meeting {
    let away = (normal.dot(direction) + 1e-9).max(0.0);
    let normal = (normal - away * direction).normalize();
    let cos_in = -direction.dot(normal);
    let reflected = (direction + 2.0 * cos_in * normal).normalize();
    let cos_out_squared = 1.0 - eta * eta * (1.0 - cos_in * cos_in);
    if cos_out_squared <= 0.0 {
        return Meeting {
            reflectance: 1.0,
            reflected,
            refracted: None,
        };
    }
    let cos_out = cos_out_squared.sqrt();
    let across = (eta * cos_in - cos_out) / (eta * cos_in + cos_out);
    let along = (eta * cos_out - cos_in) / (eta * cos_out + cos_in);
    Meeting {
        reflectance: 0.5 * (across * across + along * along),
        reflected,
        refracted: Some((eta * direction + (eta * cos_in - cos_out) * normal).normalize()),
    }
}
