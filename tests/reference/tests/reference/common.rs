//! What several tests need.

use fluid_reference::{Crossing, Image, Ray, Surface};
use glam::{DVec3, UVec2};

/// Numbers from −1 to 1, the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        // xorshift64* (Vigna 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub(crate) fn point(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    /// From outside of everything through a point near the origin.
    pub(crate) fn ray(&mut self) -> Ray {
        let origin = self.point().normalize() * 5.0;
        Ray::new(origin, self.point() - origin)
    }
}

pub(crate) fn crossings(surface: &dyn Surface, ray: &Ray) -> Vec<Crossing> {
    let mut out = Vec::new();
    surface.crossings(ray, &mut out);
    out
}

/// A square image.
pub(crate) fn image<T: Send>(side: u32, value: impl Fn(UVec2) -> T + Sync) -> Image<T> {
    Image::from_fn(UVec2::splat(side), value)
}
