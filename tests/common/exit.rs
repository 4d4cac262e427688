//! Exit rays in the f64 of the tests.

use bevy::math::{DVec2, DVec3};
use bevy_fluid::render::{ExitRay, SearchStatus};
use fluid_stage::TextureData;

use super::View;

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
        let ray = ExitRay::unpack(exits.u32x4(x, y))?;
        let on_screen: DVec2 = ray.uv.as_dvec2() * view.size.as_dvec2();
        Some(Self {
            position: view.unproject(on_screen, ray.device_depth),
            direction: ray.direction.as_dvec3(),
            searches: ray.searches,
            interfaces: ray.interfaces,
            direct: ray.direct,
            spray_first: ray.spray_first,
        })
    }
}
