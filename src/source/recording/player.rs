//! The component that plays a recording.

use std::mem::{Discriminant, discriminant};

use bevy::{ecs::entity::EntityHashMap, prelude::*};
use thiserror::Error;

use super::{asset::FluidRecording, cache::LoadedFrames, frame::is_radius};
use crate::{range::SettingRange, source::particles::FluidParticles};

const MAX_RATE: f32 = 100.0;
const CACHES: [usize; 2] = [2, 1024];

/// Plays a [`FluidRecording`] into the [`FluidParticles`] on its entity: positions, and velocities
/// and ids if the files have them. Velocities are those of playback: at half the rate, half as
/// fast.
///
/// Frames are loaded in the background, ahead of playback. A late frame does not block the program:
/// the current one stays, and the clock goes on. The clock starts with the first frame shown.
/// `FluidParticles` changes only when the frame or the moment shown does.
///
/// A frame that cannot be read is logged once, by name, and skipped like a missing number. The
/// radius is the file's; else [`radius`](Self::radius), else the recording's, else that of
/// `FluidParticles`.
///
/// Every player has its own frames: two players of one recording read its files twice, each at its
/// own time.
///
/// Values out of range are logged once and clamped; a radius that is not a positive number is
/// ignored.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(FluidParticles, LoadedFrames)]
pub struct RecordingPlayer {
    /// The recording to play.
    pub recording: Handle<FluidRecording>,
    /// Playback time; set it to seek. Unit: s from the first frame. Finite, default 0.
    /// It is kept between 0 and the recording's [`end`](FluidRecording::end), or, when repeating,
    /// below its [`duration`](FluidRecording::duration).
    #[reflect(@SettingRange::new(0.0, 600.0).unit("s").open())]
    pub time: f64,
    /// Seconds of recorded time per second. Range −100..=100, default 1. Higher: faster; 0:
    /// stopped; negative: backwards.
    #[reflect(@SettingRange::new(-100.0, 100.0))]
    pub rate: f32,
    /// Whether the clock is paused. Default: false.
    pub paused: bool,
    /// Whether playback starts over at the end, or at the start when played backwards. Default:
    /// false: it stops there.
    pub repeat: bool,
    /// Interpolation between two frames. Default: [`Interpolation::Velocity`].
    pub interpolation: Interpolation,
    /// Maximum number of frames in memory, loading ones included. Range 2..=1024, default 8.
    /// Higher: smoother with slow files and fast playback.
    #[reflect(@SettingRange::new(2.0, 1024.0).unit("frames").logarithmic())]
    pub cache: usize,
    /// Radius if the files have none. Unit: m, > 0. Default: none.
    #[reflect(@SettingRange::new(1e-3, 1.0).unit("m").logarithmic().open().start(0.025))]
    pub radius: Option<f32>,
}

/// Interpolation of particles between two frames.
///
/// Particles are matched by their ids. If a frame has none, the nearer of the two frames is shown.
/// A particle in only one of the frames is shown in the half of the time that is nearer to that
/// frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Interpolation {
    /// No interpolation: the earlier frame.
    None,
    /// Linear interpolation: every particle moves on a line.
    Linear,
    /// Cubic (Hermite) interpolation of the frames' positions and velocities; linear if the files
    /// have no velocities.
    #[default]
    Velocity,
}

impl Default for RecordingPlayer {
    fn default() -> Self {
        Self {
            recording: Handle::default(),
            time: 0.0,
            rate: 1.0,
            paused: false,
            repeat: false,
            interpolation: Interpolation::default(),
            cache: 8,
            radius: None,
        }
    }
}

/// Which setting of a player is out of range.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlayerError {
    /// The rate is out of range.
    #[error("`RecordingPlayer::rate` is {0}; it must be from -100 to 100")]
    Rate(f32),
    /// The time is not finite.
    #[error("`RecordingPlayer::time` is {0}; it must be finite")]
    Time(f64),
    /// The size of the cache is out of range.
    #[error("`RecordingPlayer::cache` is {0}; it must be from 2 to 1024")]
    Cache(usize),
    /// The radius is not a positive number.
    #[error("`RecordingPlayer::radius` is {0}; it must be a positive number")]
    Radius(f32),
}

impl RecordingPlayer {
    /// Plays from the start, once.
    pub fn new(recording: Handle<FluidRecording>) -> Self {
        Self {
            recording,
            ..default()
        }
    }

    /// The same, repeating.
    pub fn repeating(self) -> Self {
        Self {
            repeat: true,
            ..self
        }
    }

    /// Seeks to a time, in seconds from the first frame: the same as setting [`time`](Self::time).
    pub fn seek(&mut self, time: f64) {
        self.time = time;
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), PlayerError> {
        // NaN is in no range.
        if !(-MAX_RATE..=MAX_RATE).contains(&self.rate) {
            return Err(PlayerError::Rate(self.rate));
        }
        if !self.time.is_finite() {
            return Err(PlayerError::Time(self.time));
        }
        if !(CACHES[0]..=CACHES[1]).contains(&self.cache) {
            return Err(PlayerError::Cache(self.cache));
        }
        match self.radius {
            Some(radius) if !is_radius(radius) => Err(PlayerError::Radius(radius)),
            _ => Ok(()),
        }
    }

    /// The clamped rate; the default for NaN.
    pub(super) fn clamped_rate(&self) -> f64 {
        if self.rate.is_nan() {
            return 1.0;
        }
        self.rate.clamp(-MAX_RATE, MAX_RATE).into()
    }

    /// The time, or the recording's start if it is not finite.
    pub(super) fn clamped_time(&self) -> f64 {
        if self.time.is_finite() {
            self.time
        } else {
            0.0
        }
    }

    /// The radius, if it is valid.
    pub(super) fn sound_radius(&self) -> Option<f32> {
        self.radius.filter(|&radius| is_radius(radius))
    }

    pub(super) fn clamped_cache(&self) -> usize {
        self.cache.clamp(CACHES[0], CACHES[1])
    }
}

/// Logs invalid settings, once for each field.
pub(super) fn check_players(
    changed: Query<(Entity, &RecordingPlayer), Changed<RecordingPlayer>>,
    mut gone: RemovedComponents<RecordingPlayer>,
    mut said: Local<EntityHashMap<Discriminant<PlayerError>>>,
) {
    for entity in gone.read() {
        said.remove(&entity);
    }
    for (entity, player) in &changed {
        let Err(error) = player.validate() else {
            said.remove(&entity);
            continue;
        };
        let field = discriminant(&error);
        if said.insert(entity, field) != Some(field) {
            let instead = match error {
                PlayerError::Radius(_) => "without it",
                _ => "with the nearest value in range",
            };
            warn!("fluid {entity}: {error}; it is played {instead}");
        }
    }
}
