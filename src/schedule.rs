//! The system sets a game can order its own systems against.

use bevy::{app::AnimationSystems, prelude::*};

/// The stages of particles within a frame, in this order, in [`PostUpdate`].
///
/// Changes made to [`FluidParticles`](crate::particles::FluidParticles) anywhere before
/// [`FluidSystems::Shape`] are on screen in the same frame.
///
/// Particles are emitted and moved after animation (`AnimationSystems`) and before transforms are
/// propagated (`TransformSystems::Propagate`): so a floating body, and what hangs on it, is seen
/// where the simulation has moved it in this frame. The places of nozzles, colliders and boundaries
/// are computed from their `Transform`s and those of their parents, and so are those of this frame
/// too; what moves them in [`PostUpdate`] belongs before [`FluidSystems::Emit`], and what changes
/// settings before [`FluidSystems::Check`]. Only a nozzle on a
/// floating body follows it a frame behind.
///
/// Moves that are no motion are told by [`relocation`](crate::relocation)'s messages, which are read
/// in [`FluidSystems::Check`] and once more when transforms are propagated.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub enum FluidSystems {
    /// Messages of [`relocation`](crate::relocation) are taken in; then settings out of range are
    /// logged and clamped.
    Check,
    /// Emitters emit, except into a simulation.
    Emit,
    /// Particles and floating bodies move: recordings first, then the live simulation, which takes
    /// in what its emitters emit, then emitters' own particles.
    Simulate,
    /// Changed particles that a camera sees are classified and turned into splats.
    Shape,
}

/// Who moves particles in [`FluidSystems::Simulate`], in this order: emitters' particles collide
/// with what the simulation has moved.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) enum Movers {
    Recordings,
    Simulation,
    Emitters,
}

/// When what has been put elsewhere without a motion is moved along, in this order: in
/// [`FluidSystems::Check`], and again after [`FluidSystems::Simulate`], as transforms may be changed
/// at any time before they are propagated.
#[derive(SystemSet, Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub(crate) enum Relocations {
    /// Messages are read.
    Read,
    /// The world is shifted.
    Shift,
    /// Single things are teleported.
    Teleport,
    /// Settings are checked, those that have been shifted too.
    Checked,
    /// As part of `TransformSystems::Propagate`: after all that is ordered before it, before all
    /// that is ordered after it. What is written later is on screen with the next frame's
    /// transforms.
    ReadAgain,
    ShiftAgain,
    TeleportAgain,
}

/// Orders the sets. Each plugin that needs them does so, as it may be the only one.
pub(crate) fn order(app: &mut App) {
    app.configure_sets(
        PostUpdate,
        (
            (
                Relocations::Read,
                Relocations::Shift,
                Relocations::Teleport,
                Relocations::Checked,
            )
                .chain()
                .in_set(FluidSystems::Check),
            (
                FluidSystems::Check.after(AnimationSystems),
                FluidSystems::Emit,
                FluidSystems::Simulate.before(TransformSystems::Propagate),
                Relocations::ReadAgain.in_set(TransformSystems::Propagate),
                Relocations::ShiftAgain,
                Relocations::TeleportAgain,
                FluidSystems::Shape,
            )
                .chain(),
            (Movers::Recordings, Movers::Simulation, Movers::Emitters)
                .chain()
                .in_set(FluidSystems::Simulate),
        ),
    );
}
