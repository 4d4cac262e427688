//! Debug views: intermediate results shown in place of the liquid.

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
    /// Number of interfaces that each ray met: 0 black, 1 blue, 2 green, 3 yellow, 4 red.
    Interfaces,
    /// How the searches ended. Green: all hit; blue: no further interface; yellow: the ray left the
    /// layer or the screen; red: nothing to search in; violet: total internal reflection; orange:
    /// out of evaluations; grey: met an opaque surface.
    Status,
    /// Class of the first surface: bulk blue, spray orange.
    Classes,
    /// Straight path length through the liquid at each pixel. Black: 0; white: the depth of the
    /// surface's bounding box, or where the fluid is opaque.
    Thickness,
    /// Final direction of each ray in view space, −1..=1 shown as 0..=1; half as bright where the
    /// ray ends at an opaque surface or goes straight on.
    ExitRay,
    /// Number of splats drawn at each pixel: violet 1, red 4, orange 16, white 64 and more. Needs a
    /// pass of its own.
    Overdraw,
}

impl FluidDebugView {
    /// All debug views.
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
