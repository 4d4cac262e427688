//! Exit rays, decoded as `pack_exit` in `refract.wgsl` packs them.

use bevy::math::{DVec2, DVec3};
use bevy_fluid::render::SearchStatus;
use fluid_stage::TextureData;

use super::{View, decode_normal};

/// What is left of a pixel's ray, in view space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit {
    pub(crate) position: DVec3,
    pub(crate) direction: DVec3,
    /// How the searches ended, in order.
    pub(crate) searches: [SearchStatus; 4],
    /// How many interfaces were crossed.
    pub(crate) interfaces: u32,
    /// Whether the background is what is on screen at `position`.
    pub(crate) direct: bool,
    /// Whether the first interface belongs to the spray.
    pub(crate) spray_first: bool,
}

impl Exit {
    /// `None` where there is no liquid.
    pub(crate) fn at(view: &View, exits: &TextureData, x: u32, y: u32) -> Option<Self> {
        let [uv, depth, direction, flags] = exits.u32x4(x, y);
        if flags >> 31 == 0 {
            return None;
        }
        let [u, v] = halves(uv).map(|half| f64::from(half) / 65535.0);
        let octahedral = halves(direction).map(|half| f32::from(half as i16) / 32767.0);
        Some(Self {
            position: view.unproject(
                DVec2::new(u, v) * view.size.as_dvec2(),
                f32::from_bits(depth),
            ),
            direction: decode_normal(octahedral),
            searches: [0, 4, 8, 12].map(|shift| status(flags >> shift)),
            interfaces: flags >> 16 & 7,
            direct: flags >> 19 & 1 == 1,
            spray_first: flags >> 20 & 1 == 1,
        })
    }
}

fn halves(word: u32) -> [u16; 2] {
    [word as u16, (word >> 16) as u16]
}

/// The status in the lowest four bits.
fn status(bits: u32) -> SearchStatus {
    SearchStatus::ALL[(bits & 15) as usize]
}
