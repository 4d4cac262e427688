//! The Rust twin of `pack_exit` in `refract.wgsl`: the contents of
//! [`Layers::exits`](crate::render::Layers::exits).

use bevy::math::{Vec2, Vec3, vec2};

use super::SearchStatus;

/// The rest of a pixel's ray behind the last interface that it met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitRay {
    /// Start on screen, as fractions of the viewport from its upper left.
    pub uv: Vec2,
    /// Start in device depth (reverse z).
    pub device_depth: f32,
    /// Direction: a unit vector in view space.
    pub direction: Vec3,
    /// How the searches ended, in order.
    pub searches: [SearchStatus; 4],
    /// Number of interfaces met.
    pub interfaces: u32,
    /// Number of times the searches sampled a layer's depth; at most 255.
    pub evaluations: u32,
    /// Whether the background is the scene's colour on screen at `uv`.
    pub direct: bool,
    /// Whether the first interface belongs to the spray.
    pub spray_first: bool,
}

impl ExitRay {
    /// The ray of a texel; `None` where there is no liquid.
    pub fn unpack([uv, device_depth, direction, flags]: [u32; 4]) -> Option<Self> {
        let status = |shift: u32| SearchStatus::ALL[(flags >> shift) as usize & 7];
        let octahedral = halves(direction).map(|half| f32::from(half as i16) / 32767.0);
        (flags >> 31 == 1).then(|| Self {
            uv: Vec2::from(halves(uv).map(|half| f32::from(half) / 65535.0)),
            device_depth: f32::from_bits(device_depth),
            direction: decode_normal(octahedral),
            searches: [0, 4, 8, 12].map(status),
            interfaces: flags >> 16 & 7,
            evaluations: flags >> 21 & 255,
            direct: flags >> 19 & 1 == 1,
            spray_first: flags >> 20 & 1 == 1,
        })
    }
}

fn halves(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}

/// The unit vector of an octahedral code (Meyer et al. 2010), as stored in layers of normals.
pub fn decode_normal(code: [f32; 2]) -> Vec3 {
    let [x, y] = code;
    let z = 1.0 - x.abs() - y.abs();
    let fold = (-z).max(0.0);
    let unfold = |v: f32| if v >= 0.0 { v - fold } else { v + fold };
    vec2(unfold(x), unfold(y)).extend(z).normalize()
}

/// The octahedral code of a unit vector.
pub fn encode_normal(normal: Vec3) -> [f32; 2] {
    let p = normal.truncate() / normal.abs().element_sum();
    if normal.z >= 0.0 {
        return p.to_array();
    }
    let fold = |v: f32, other: f32| (1.0 - other.abs()) * if v >= 0.0 { 1.0 } else { -1.0 };
    [fold(p.x, p.y), fold(p.y, p.x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_of_normals_are_undone() {
        for i in 0..1000 {
            let z = 1.0 - (i as f32 + 0.5) / 500.0;
            let flat = Vec2::from_angle(2.4 * i as f32) * (1.0 - z * z).sqrt();
            let normal = flat.extend(z);
            let error = decode_normal(encode_normal(normal)).distance(normal);
            assert!(error < 1e-6, "{normal}: {error}");
        }
    }

    #[test]
    fn texels_without_liquid_have_no_ray() {
        assert_eq!(ExitRay::unpack([0; 4]), None);
        let ray = ExitRay::unpack([0x8000_ffff, 0.5_f32.to_bits(), 0, 0x80e2_0051]).unwrap();
        assert_eq!(
            ray.searches[..2],
            [SearchStatus::Hit, SearchStatus::TotalReflection]
        );
        assert_eq!((ray.interfaces, ray.evaluations, ray.direct), (2, 7, false));
        assert_eq!((ray.direction, ray.device_depth), (Vec3::Z, 0.5));
        assert!((ray.uv - vec2(1.0, 0.5)).length() < 1e-4);
    }
}
