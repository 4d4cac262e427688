//! The settings and the status of the simulation.

use std::time::Duration;

use bevy::prelude::*;

use crate::settings::{Checked, SettingRange, Settings};

/// Settings of [`SalvaPlugin`](super::SalvaPlugin), which may be changed at any time.
///
/// Values out of range are logged once and clamped.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[require(Checked<Self>)]
pub struct SalvaSettings {
    /// Whether the simulation runs in the background or in lockstep. Default:
    /// [`SalvaMode::Background`].
    pub mode: SalvaMode,
    /// Whether the simulation is paused. Default: false. It is also paused while `Time` is.
    pub paused: bool,
    /// Acceleration of fluids and bodies. Unit: m/s², default: 9.81 downwards.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m/s²").open())]
    pub gravity: Vec3,
    /// Length of a step. Unit: s, range 0.001..=0.05, default 1/120. Shorter: calmer and stiffer,
    /// at a higher cost.
    #[reflect(@SettingRange::new(0.001, 0.05).unit("s").logarithmic())]
    pub step: f32,
    /// Maximum number of substeps. A step is divided when its fastest particle would move farther
    /// than 0.4 of a diameter at once. Range 1..=16, default 4.
    #[reflect(@SettingRange::new(1.0, 16.0))]
    pub max_substeps: u32,
    /// Maximum number of steps in one go. Time beyond them is dropped: after a hitch the liquid
    /// does not catch up. Range 1..=64, default 8.
    #[reflect(@SettingRange::new(1.0, 64.0).logarithmic())]
    pub max_steps: u32,
    /// Time that the simulation may take per frame, on its own threads. Unit: s as [`Duration`],
    /// default 12 ms. A step that has begun is finished, and its excess is deducted from the
    /// following frames. Lower: more time for other work, and liquid slows down sooner. Unused in
    /// [`SalvaMode::Lockstep`].
    #[reflect(@SettingRange::new(1e-4, 0.1).unit("s").logarithmic().open())]
    pub budget: Duration,
    /// Particles faster than this are treated as broken and removed. Unit: m/s, range 1..=10000,
    /// default 100.
    #[reflect(@SettingRange::new(1.0, 1e4).unit("m/s").logarithmic())]
    pub max_speed: f32,
    /// The least coordinates of a particle; particles outside are removed. Unit: m, default -1000
    /// each. A [`WorldShift`](crate::relocation::WorldShift) shifts them.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m").open())]
    pub low: Vec3,
    /// The greatest coordinates of a particle. Unit: m, default 1000 each. A shift moves them too.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m").open())]
    pub high: Vec3,
}

impl Settings for SalvaSettings {}

impl Default for SalvaSettings {
    fn default() -> Self {
        Self {
            mode: SalvaMode::default(),
            paused: false,
            gravity: Vec3::NEG_Y * 9.81,
            step: 1.0 / 120.0,
            max_substeps: 4,
            max_steps: 8,
            budget: Duration::from_millis(12),
            max_speed: 100.0,
            low: Vec3::splat(-1000.0),
            high: Vec3::splat(1000.0),
        }
    }
}

/// Whether the app waits for the simulation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SalvaMode {
    /// The app does not wait: steps are done on other threads, one core is left free where there
    /// are several, and the positions shown are interpolated between the last two finished states.
    /// On a slow machine the liquid moves in slow motion; frames take no longer.
    #[default]
    Background,
    /// The app waits in every update until the liquid has advanced by exactly the update's time, on
    /// one thread. Updates shorter than half a [`step`](SalvaSettings::step), as in slow motion, show
    /// parts of whole steps. Deterministic: equal updates give equal bits, on one machine. For tests and
    /// recordings.
    Lockstep,
}

/// Status of the simulation, written in every update.
#[derive(Resource, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct SalvaStatus {
    /// Simulated time over the app's time, smoothed over about ten batches of steps; 1 is real time.
    pub speed: f32,
    /// Computing time of one step, with its substeps. Unit: s as [`Duration`].
    pub step_time: Duration,
    /// Particles of all fluids in the last finished state.
    pub particles: usize,
    /// Simulated time of the last finished state. Unit: s.
    pub simulated: f64,
    /// Simulated time of the state shown. Unit: s.
    pub shown: f64,
    /// Whether steps are running at this moment.
    pub in_flight: bool,
    /// Particles removed so far because they were not finite or too fast.
    pub broken: u64,
    /// Whether the simulation has stopped because salva panicked, which is logged.
    pub stopped: bool,
}
