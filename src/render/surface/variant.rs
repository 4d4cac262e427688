//! Variants of surfaces.

use bevy::render::render_resource::TextureFormat;

use super::plan::Plan;
use crate::settings::{FluidDebugView, ScreenSpaceFluid};

/// All that decides which pipelines a surface needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Variant {
    pub(crate) plan: Plan,
    pub(crate) settings: ScreenSpaceFluid,
    pub(crate) debug_view: Option<FluidDebugView>,
    /// Of the camera's target.
    pub(crate) format: TextureFormat,
    pub(crate) samples: u32,
    /// Whether the opaque scene's depth is known.
    pub(crate) scene_depth: bool,
    /// Whether the view has fog, and an atmosphere.
    pub(crate) fog: bool,
    pub(crate) atmosphere: bool,
    /// Whether there are other surfaces, which may be visible through this one.
    pub(crate) several: bool,
}

impl Variant {
    /// Whether pipelines of this variant can draw where `other` is wanted: to the same target, with
    /// the same bind groups.
    pub(crate) fn fits(&self, other: &Self) -> bool {
        (self.debug_view, self.format, self.samples)
            == (other.debug_view, other.format, other.samples)
    }
}
