//! The component that plays a recording.

use bevy::prelude::*;

use super::{asset::FluidRecording, cache::LoadedFrames, frame::is_radius};
use crate::{
    settings::{Checked, SettingError, SettingRange, Settings},
    shape::RADIUS,
    source::particles::FluidParticles,
};

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
#[require(FluidParticles, LoadedFrames, Checked<Self>)]
pub struct RecordingPlayer {
    /// The recording to play.
    pub recording: Handle<FluidRecording>,
    /// Playback time; set it to seek. Unit: s from the first frame. Finite, default 0.
    /// It is kept between 0 and the recording's [`end`](FluidRecording::end), or, when repeating,
    /// below its [`duration`](FluidRecording::duration).
    #[reflect(@SettingRange::new(0.0, 600.0).unit("s").valid(f64::MIN, f64::MAX))]
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
    /// Radius if the files have none. Unit: m, range 1e-9..=1e9, default: none.
    #[reflect(@RADIUS.initial(0.025))]
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
}

impl Settings for RecordingPlayer {
    fn mend(&mut self) -> Result<(), SettingError> {
        // What is no length is next to none.
        let Some(radius) = self.radius.take_if(|radius| !is_radius(*radius)) else {
            return Ok(());
        };
        let name = "RecordingPlayer::radius";
        Err(SettingError::new(name, radius, "a positive number"))
    }
}
