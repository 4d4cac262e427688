//! How the simulation runs, and how it is doing.

use std::time::Duration;

use bevy::prelude::*;

use crate::range::SettingRange;

/// How [`SalvaPlugin`](super::SalvaPlugin) simulates. May be changed at any time.
///
/// What is out of its range is said once, and moved to the nearest end.
#[derive(Resource, Clone, Debug, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct SalvaSettings {
    /// On which thread, and who waits for whom. Default: [`SalvaMode::Background`].
    pub mode: SalvaMode,
    /// Whether time stands still. Default: false. It also does while `Time` is paused.
    pub paused: bool,
    /// Acceleration of everything. Unit: m/s², default: 9.81 downwards.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m/s²").open())]
    pub gravity: Vec3,
    /// Time in a step. Unit: s, range 0.001..=0.05, default 1/120. Shorter: calmer, stiffer,
    /// dearer.
    #[reflect(@SettingRange::new(0.001, 0.05).unit("s").logarithmic())]
    pub step: f32,
    /// Into how many substeps a step is divided at most, when its fastest particle would move
    /// farther than 0.4 of a diameter in one. Range 1..=16, default 4.
    #[reflect(@SettingRange::new(1.0, 16.0))]
    pub max_substeps: u32,
    /// Steps done in one go at most. What a frame owes beyond them is dropped: after a hitch the
    /// liquid does not catch up. Range 1..=64, default 8.
    #[reflect(@SettingRange::new(1.0, 64.0).logarithmic())]
    pub max_steps: u32,
    /// How much of each frame's time the simulation may take, on its own threads. Unit: s as
    /// [`Duration`], default 12 ms. A step that has begun is finished, and paid back in the
    /// following frames. Less: more of the machine is left for others, and liquid gets slow
    /// sooner. Unused in [`SalvaMode::Lockstep`].
    #[reflect(@SettingRange::new(1e-4, 0.1).unit("s").logarithmic().open())]
    pub budget: Duration,
    /// Particles faster than this are taken for broken and removed. Unit: m/s, range 1..=10000,
    /// default 100.
    #[reflect(@SettingRange::new(1.0, 1e4).unit("m/s").logarithmic())]
    pub max_speed: f32,
    /// The least coordinates a particle may have; those outside are removed. Unit: m,
    /// default -1000 each.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m").open())]
    pub low: Vec3,
    /// The greatest coordinates a particle may have. Unit: m, default 1000 each.
    #[reflect(@SettingRange::new(-1e3, 1e3).unit("m").open())]
    pub high: Vec3,
}

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

/// Who waits for whom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum SalvaMode {
    /// Nobody: steps are done on other threads, one core is left alone where there are several,
    /// and what is shown lies between the last two finished states. On a slow machine the liquid
    /// moves in slow motion; frames take no longer.
    #[default]
    Background,
    /// The app waits in every update until the liquid has moved on by just the update's time, on
    /// one thread: equal updates give equal bits, on one machine. For tests and recordings.
    Lockstep,
}

/// How the simulation is doing. Written in every update.
#[derive(Resource, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct SalvaStatus {
    /// Simulated time over the app's time, smoothed over about ten goes; 1 is real time.
    pub speed: f32,
    /// How long one step takes, with its substeps. Unit: s as [`Duration`].
    pub step_time: Duration,
    /// Particles of all fluids in the last finished state.
    pub particles: usize,
    /// Time that the last finished state stands for. Unit: s.
    pub simulated: f64,
    /// Time that what is shown stands for. Unit: s.
    pub shown: f64,
    /// Whether steps are being done at this moment.
    pub in_flight: bool,
    /// Particles removed so far because they were not finite or too fast.
    pub broken: u64,
    /// Whether the simulation has come to an end because salva panicked. That is logged.
    pub stopped: bool,
}
