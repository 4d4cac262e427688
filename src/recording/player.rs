//! The component that plays a recording.

use std::mem::{Discriminant, discriminant};

use bevy::{ecs::entity::EntityHashMap, prelude::*};
use thiserror::Error;

use super::{asset::FluidRecording, cache::LoadedFrames, frame::is_radius};
use crate::{particles::FluidParticles, range::SettingRange};

const MAX_RATE: f32 = 100.0;
const CACHES: [usize; 2] = [2, 1024];

/// Plays a [`FluidRecording`] into the [`FluidParticles`] beside it.
///
/// Frames are loaded in the background, ahead of where it plays to. One that is not there in time
/// does not hold the program up: the one that is shown stays, and the clock goes on. The clock
/// starts with the first frame shown. `FluidParticles` changes only when what is shown does.
///
/// A frame that cannot be read is named in the log, once, and skipped like a number that is left
/// out. The radius is the file's; else [`radius`](Self::radius), else the recording's, else the one
/// that `FluidParticles` has.
///
/// Every player has frames of its own: two that play one recording read its files twice, each at its
/// own time.
///
/// Values out of their range are said once and played as the nearest in range; a radius that is not
/// a positive number counts as not given.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(FluidParticles, LoadedFrames)]
pub struct RecordingPlayer {
    /// What is played.
    pub recording: Handle<FluidRecording>,
    /// Where in the recording it is; set it to seek. Unit: s from the first frame. Finite, default 0.
    /// It is kept between 0 and the recording's [`end`](FluidRecording::end), or, where it repeats,
    /// below its [`duration`](FluidRecording::duration).
    #[reflect(@SettingRange::new(0.0, 600.0).unit("s").open())]
    pub time: f64,
    /// Seconds of recorded time per second. Range −100..=100, default 1. Higher: faster; 0 stands
    /// still; negative: backwards.
    #[reflect(@SettingRange::new(-100.0, 100.0))]
    pub rate: f32,
    /// Whether the clock stands still. Default: false.
    pub paused: bool,
    /// Whether it starts over at its end, or ahead of its start when played backwards. Default:
    /// false: it stays there.
    pub repeat: bool,
    /// What is shown between two frames. Default: [`Interpolation::Velocity`].
    pub interpolation: Interpolation,
    /// The most frames that are held in memory, loading ones included. Range 2..=1024, default 8.
    /// Higher: slow files and fast play are better served.
    #[reflect(@SettingRange::new(2.0, 1024.0).unit("frames").logarithmic())]
    pub cache: usize,
    /// Radius where the files do not hold it. Unit: m, > 0. Default: none.
    #[reflect(@SettingRange::new(1e-3, 1.0).unit("m").logarithmic().open().start(0.025))]
    pub radius: Option<f32>,
}

/// What is shown between two frames.
///
/// Particles are followed by their ids. Where a frame has none, nobody knows who is who, and the
/// nearer of the two frames is shown. A particle that only one of the frames has is shown in the
/// half of the time that is nearer to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Interpolation {
    /// The frame before.
    None,
    /// Every particle moves on a line.
    Linear,
    /// Every particle moves on the cubic that has the frames' positions and velocities (Hermite);
    /// on a line where the files hold no velocities.
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

/// Which setting of a player makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlayerError {
    /// The rate is out of range.
    #[error("`RecordingPlayer::rate` is {0}; it must be from -100 to 100")]
    Rate(f32),
    /// The time is no number.
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

    /// The same, over and over.
    pub fn repeating(self) -> Self {
        Self {
            repeat: true,
            ..self
        }
    }

    /// Goes to a time, in seconds from the first frame: the same as setting [`time`](Self::time).
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

    /// The rate, or the nearest in range; the default's where it is no number.
    pub(super) fn clamped_rate(&self) -> f64 {
        if self.rate.is_nan() {
            return 1.0;
        }
        self.rate.clamp(-MAX_RATE, MAX_RATE).into()
    }

    /// The time, or the recording's start where it is none.
    pub(super) fn clamped_time(&self) -> f64 {
        if self.time.is_finite() {
            self.time
        } else {
            0.0
        }
    }

    /// The radius, if particles can have it.
    pub(super) fn sound_radius(&self) -> Option<f32> {
        self.radius.filter(|&radius| is_radius(radius))
    }

    pub(super) fn clamped_cache(&self) -> usize {
        self.cache.clamp(CACHES[0], CACHES[1])
    }
}

/// Says what makes no sense, once for each field.
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
