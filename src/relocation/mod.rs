//! What is put elsewhere without a motion: the whole world, or one thing in it.
//!
//! Emitted particles, live simulation, rain and the paths of whatever moves are kept in the world's
//! space. A move that is no motion has to be told: [`WorldShift`] for everything at once,
//! [`Teleport`] for an entity. Without it, particles and drops stay behind, and what jumps throws
//! others about.
//!
//! # A floating origin
//!
//! Far from the origin `f32` is coarse (1 mm at 10 km), so large worlds are moved back under the
//! camera now and then. Write the message where the transforms are changed:
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_fluid::prelude::*;
//!
//! fn recentre(
//!     camera: Single<&GlobalTransform, With<Camera3d>>,
//!     mut roots: Query<&mut Transform, Without<ChildOf>>,
//!     mut shifts: MessageWriter<WorldShift>,
//! ) {
//!     // Whole metres, which `f32` adds without rounding.
//!     let way = -camera.translation().round();
//!     if way.length() > 1000.0 {
//!         for mut root in &mut roots {
//!             root.translation += way;
//!         }
//!         shifts.write(WorldShift(way));
//!     }
//! }
//! # bevy::ecs::system::assert_is_system(recentre);
//! ```
//!
//! The picture stays the same. Carried along are the particles of every fluid in
//! [`ParticleSpace::World`](crate::particles::ParticleSpace::World), the paths of emitters and
//! colliders, simulated liquids, boundaries, bodies and the bounds of the simulation
//! (`SalvaSettings::low` and `high`), and the places of all raindrops. What has a `Transform` is
//! moved by the program: fluids in their entity's space, nozzles, bodies, shelters, cameras.
//!
//! Where another crate keeps the origin, a system compares the origin's cell with that of the frame
//! before and writes the way between them.
//!
//! # A teleport
//!
//! ```
//! use bevy::prelude::*;
//! use bevy_fluid::prelude::*;
//!
//! #[derive(Component)]
//! struct Player;
//!
//! fn respawn(
//!     player: Single<(Entity, &mut Transform), With<Player>>,
//!     mut teleports: MessageWriter<Teleport>,
//! ) {
//!     let (player, mut place) = player.into_inner();
//!     let way = Vec3::ZERO - place.translation;
//!     place.translation += way;
//!     // What hangs on the player jumps too. Its particles stay where they are ...
//!     teleports.write(Teleport::of(player));
//!     // ... or come along.
//!     teleports.write(Teleport::of(player).carrying(way));
//! }
//! # bevy::ecs::system::assert_is_system(respawn);
//! ```
//!
//! | what jumps | alone | [carrying](Teleport::carrying) its particles |
//! | --- | --- | --- |
//! | a `ParticleEmitter` | emits at its new place only, not along the way | they are moved along, velocities too |
//! | a `ParticleCollider`, a `SalvaBoundary` | has no velocity: it pushes out what it is put over, and throws nothing | the same |
//! | a `SalvaFluid` | its liquid stays | its liquid is moved along: for a tank, as its child or told beside it |
//! | a camera with `Rain` | nothing is needed: drops are fixed in the world | the same |
//!
//! A `SalvaBody` jumps, to rest, whenever its transform is written, but for a shift of the world. A
//! move faster than [`TeleportSettings::speed`] is a jump without a message, alone.
//!
//! # When
//!
//! A message belongs to a change of transforms in the same system, or in the same frame on the same
//! side of [`FluidSystems`](crate::FluidSystems). It may be written in any schedule; in
//! [`PostUpdate`], before [`FluidSystems::Check`](crate::FluidSystems::Check) or after
//! [`FluidSystems::Simulate`](crate::FluidSystems::Simulate).

mod messages;
mod news;

use bevy::{
    ecs::{schedule::IntoScheduleConfigs, system::ScheduleSystem},
    prelude::*,
};

pub use self::messages::{Teleport, TeleportSettings, WorldShift};
pub(crate) use self::news::{Relocated, SpeedLimit, Teleports};
use crate::{
    schedule::{self, Relocations},
    settings::check,
};

/// Reads the messages. Each plugin that keeps something in the world's space adds it.
struct RelocationPlugin;

impl Plugin for RelocationPlugin {
    fn build(&self, app: &mut App) {
        schedule::order(app);
        check::<TeleportSettings>(app);
        app.add_message::<WorldShift>()
            .add_message::<Teleport>()
            .register_type::<TeleportSettings>()
            .init_resource::<TeleportSettings>()
            .init_resource::<Relocated>()
            .configure_sets(
                PostUpdate,
                (
                    // Each by its own reading.
                    (Relocations::Shift, Relocations::ShiftAgain)
                        .distributive_run_if(news::is_shifted),
                    (Relocations::Teleport, Relocations::TeleportAgain)
                        .distributive_run_if(news::is_teleported),
                ),
            )
            .add_systems(
                PostUpdate,
                (
                    news::read.in_set(Relocations::Read),
                    news::read.in_set(Relocations::ReadAgain),
                ),
            );
    }
}

/// Adds what the other functions here need.
pub(crate) fn plugin(app: &mut App) {
    if !app.is_plugin_added::<RelocationPlugin>() {
        app.add_plugins(RelocationPlugin);
    }
}

/// Adds a system that runs when the world is shifted, by [`Relocated::shift`].
pub(crate) fn on_shift<M>(
    app: &mut App,
    system: impl IntoScheduleConfigs<ScheduleSystem, M> + Copy,
) {
    plugin(app);
    app.add_systems(
        PostUpdate,
        (
            system.in_set(Relocations::Shift),
            system.in_set(Relocations::ShiftAgain),
        ),
    );
}

/// Adds a system that runs when there are [`Teleports`].
pub(crate) fn on_teleport<M>(
    app: &mut App,
    system: impl IntoScheduleConfigs<ScheduleSystem, M> + Copy,
) {
    plugin(app);
    app.add_systems(
        PostUpdate,
        (
            system.in_set(Relocations::Teleport),
            system.in_set(Relocations::TeleportAgain),
        ),
    );
}
