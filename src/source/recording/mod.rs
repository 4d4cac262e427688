//! Particle files: read, played and written. Feature `recordings`.
//!
//! - [`ParticleFrame`] is the content of one file, `.vtk`, `.bgeo`, `.ply` or `.xyz`, and an asset.
//! - [`FluidRecording`] is a numbered sequence of them, found by a pattern
//!   (`FluidRecording::load(&asset_server, "frames/dam_####.vtk")`) or described by a `.fluid.ron`
//!   (`asset_server.load("frames/dam.fluid.ron")`).
//! - [`RecordingPlayer`] on a fluid plays one: its frames are loaded in the background, and only as
//!   many as its cache may hold.
//! - [`RecordingWriter`] on a fluid records one.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_fluid::{prelude::*, recording::{FluidRecording, RecordingPlayer, RecordingWriter}};
//!
//! fn play(mut commands: Commands, assets: Res<AssetServer>) {
//!     let recording = FluidRecording::load(&assets, "frames/dam_####.vtk");
//!     commands.spawn((RecordingPlayer::new(recording).repeating(), FluidMaterial::WATER));
//! }
//!
//! fn record(mut commands: Commands, fluid: Single<Entity, With<FluidParticles>>) {
//!     commands.entity(*fluid).insert(RecordingWriter::new("frames/dam_####.vtk"));
//! }
//! ```
//!
//! Whatever is in a file, reading it is at worst an error that names the file, never a panic.
//!
//! A player reads assets, a writer writes to the file system: a player's patterns are asset paths,
//! a writer's are file system paths; absolute paths are the same for both.

mod asset;
mod cache;
mod error;
mod files;
mod format;
mod frame;
mod frame_file;
mod interpolate;
mod loader;
mod notes;
mod pattern;
mod playback;
mod player;
mod playhead;
mod writer;

use bevy::prelude::*;

pub use self::{
    asset::{FluidRecording, RecordingSettings},
    cache::LoadedFrames,
    error::RecordingError,
    format::ParticleFormat,
    frame::{FrameError, ParticleFrame},
    loader::{FluidRecordingLoader, ParticleFrameLoader},
    pattern::FramePattern,
    player::{Interpolation, RecordingPlayer},
    writer::{RecordingWriter, WrittenFrames},
};
use crate::{
    needs::need_time,
    schedule::{FluidSystems, Movers},
    settings::check,
};

/// Plays and writes recordings. Part of [`FluidPlugins`](crate::FluidPlugins); it also works without
/// the others, as in a program that records and draws nothing. Players need Bevy's `AssetPlugin`,
/// writers do not.
///
/// Players run in [`FluidSystems::Simulate`]; writers run after it.
#[derive(Clone, Copy, Debug, Default)]
pub struct RecordingPlugin;

impl Plugin for RecordingPlugin {
    fn build(&self, app: &mut App) {
        check::<RecordingPlayer>(app);
        check::<RecordingWriter>(app);
        add_assets(app);
        app.register_type::<RecordingPlayer>()
            .register_type::<RecordingSettings>()
            .register_type::<RecordingWriter>()
            .add_systems(
                PostUpdate,
                (
                    (
                        playback::play.run_if(resource_exists::<Assets<FluidRecording>>),
                        playback::miss_assets
                            .run_if(not(resource_exists::<Assets<FluidRecording>>)),
                    )
                        .chain()
                        .in_set(Movers::Recordings),
                    writer::record
                        .after(FluidSystems::Simulate)
                        .before(FluidSystems::Shape),
                ),
            );
    }

    fn finish(&self, app: &mut App) {
        need_time(app, "RecordingPlugin");
        // `AssetPlugin` may have been added since.
        add_assets(app);
    }
}

/// Adds what a player reads, if there is an asset server and it has not been added.
fn add_assets(app: &mut App) {
    let world = app.world();
    let is_added = world.contains_resource::<Assets<FluidRecording>>();
    if world.contains_resource::<AssetServer>() && !is_added {
        app.init_asset::<ParticleFrame>()
            .init_asset::<FluidRecording>()
            .register_asset_reflect::<ParticleFrame>()
            .init_asset_loader::<ParticleFrameLoader>()
            .init_asset_loader::<FluidRecordingLoader>();
    }
}
