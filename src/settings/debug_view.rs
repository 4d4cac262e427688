//! What can be looked at in place of the liquid.

use bevy::prelude::*;

/// Shows an intermediate result of a camera with [`ScreenSpaceFluid`](super::ScreenSpaceFluid) in
/// place of the liquid.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
#[reflect(Component, Clone, PartialEq)]
pub enum FluidDebugView {
    /// Depth of the bulk's front layer, near is bright.
    BulkFront,
    /// Depth of the bulk's back layer.
    BulkBack,
    /// Depth of the spray's front layer.
    SprayFront,
    /// Depth of the spray's back layer.
    SprayBack,
    /// The first interface's normal in view space, −1..=1 shown as 0..=1.
    Normals,
    /// How many interfaces each ray met: 0 black, 1 blue, 2 green, 3 yellow, 4 red.
    Interfaces,
    /// How the searches ended: green all hit, blue no further interface, yellow the ray left the
    /// layer or the screen, red nothing to search in, violet total reflection, orange the
    /// evaluations ran out, grey an opaque surface was met.
    Status,
    /// Bulk blue, spray orange.
    Classes,
    /// The straight way through the liquid at each pixel: black 0, white as far as the body's box
    /// is deep, and where nothing is seen through it.
    Thickness,
    /// Where each ray goes in the end: its direction in view space, −1..=1 shown as 0..=1, half as
    /// bright where it ends at an opaque surface or goes straight on.
    ExitRay,
    /// How many splats are drawn at each pixel: violet 1, red 4, orange 16, white 64 and more.
    /// It takes a pass of its own.
    Overdraw,
}

impl FluidDebugView {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::BulkFront,
        Self::BulkBack,
        Self::SprayFront,
        Self::SprayBack,
        Self::Normals,
        Self::Interfaces,
        Self::Status,
        Self::Classes,
        Self::Thickness,
        Self::ExitRay,
        Self::Overdraw,
    ];
}
