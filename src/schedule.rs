//! The system sets a game can order its own systems against.

use bevy::prelude::*;

/// The stages of particles within a frame, in this order, in [`PostUpdate`].
///
/// Changes made to [`FluidParticles`](crate::particles::FluidParticles) anywhere before
/// [`FluidSystems::Shape`] are on screen in the same frame.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub enum FluidSystems {
    /// Settings out of range are logged and clamped.
    Check,
    /// Particles are created and destroyed.
    Emit,
    /// Particles move.
    Simulate,
    /// Changed particles are classified and turned into splats.
    Shape,
}

/// Every plugin that uses the sets may add this.
pub(crate) fn plugin(app: &mut App) {
    app.configure_sets(
        PostUpdate,
        (
            FluidSystems::Check,
            FluidSystems::Emit,
            FluidSystems::Simulate,
            FluidSystems::Shape,
        )
            .chain(),
    );
}
