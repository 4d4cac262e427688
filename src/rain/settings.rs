//! Rain settings.

use bevy::{camera::Hdr, prelude::*};

use super::{
    clock::RainClock,
    drops::DragLaw,
    streaks::{DEFAULT_EXPOSURE, clamped_exposure},
};
use crate::range::SettingRange;

/// Makes a camera draw rain.
///
/// Values out of range are logged once and clamped.
///
/// Cameras with equal settings whose rain began at the same time show the same drops, until the
/// wind changes.
///
/// Rain is lit by the scene's directional lights (the four brightest that share a render layer with
/// the camera), by point and spot lights (the 32 brightest at the camera), and by the surroundings:
/// the ambient light, and the camera's environment map or sky box.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Hdr, RainClock)]
pub struct Rain {
    /// Rain rate. Unit: mm/h, range 0..=200, default 5. It may change from frame to frame; at 0 no
    /// work is done. Drops keep their sizes and speeds as others are added.
    #[reflect(@SettingRange::new(0.0, 200.0).unit("mm/h").logarithmic())]
    pub rate: f32,
    /// Distance from the camera up to which streaks are drawn; beyond it the background fades.
    /// Unit: m, range 1..=100, default 5 as in the rain paper. Higher: depth and motion in far
    /// lamplight; the cost grows with the logarithm of the distance beyond 2 m. Seen along
    /// their fall, streaks are points: from 8 m on they fade, as beyond `distance`.
    #[reflect(@SettingRange::new(1.0, 100.0).unit("m").logarithmic())]
    pub distance: f32,
    /// Distance up to which it rains: the background fades from [`distance`](Self::distance) to
    /// here. Unit: m, range 0..=100,000, default 500.
    #[reflect(@SettingRange::new(0.0, 1e5).unit("m").logarithmic())]
    pub extent: f32,
    /// Velocity of the air along x and z: drops drift with it. Unit: m/s, range −30..=30 each,
    /// default 0.
    #[reflect(@SettingRange::new(-30.0, 30.0).unit("m/s"))]
    pub wind: Vec2,
    /// Brightness of drops. Range 0..=100, default 1, the light that real drops scatter. Higher:
    /// streaks that are visible on a display of small dynamic range.
    #[reflect(@SettingRange::new(0.0, 100.0).logarithmic())]
    pub brightness: f32,
    /// How rain is drawn. Default [`RainMethod::Streaks`].
    pub method: RainMethod,
}

impl Rain {
    /// 1 mm/h.
    pub const DRIZZLE: Self = Self::falling(1.0);
    /// 5 mm/h.
    pub const RAIN: Self = Self::falling(5.0);
    /// 20 mm/h.
    pub const HEAVY: Self = Self::falling(20.0);
    /// 75 mm/h.
    pub const CLOUDBURST: Self = Self::falling(75.0);

    /// Rain of the given rate (mm/h), with defaults for the rest.
    pub const fn falling(rate: f32) -> Self {
        Self {
            rate,
            distance: 5.0,
            extent: 500.0,
            wind: Vec2::ZERO,
            brightness: 1.0,
            method: RainMethod::Streaks,
        }
    }
}

impl Default for Rain {
    fn default() -> Self {
        Self::RAIN
    }
}

/// How rain is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum RainMethod {
    /// Textures of streaks on billboards, one for each voxel of air (Yoshida et al.).
    #[default]
    Streaks,
    /// Every drop drawn individually: the reference for the other method. Slow: millions of drops
    /// within 10 m.
    PerDrop,
}

/// Inputs of the textures of streaks. The textures are redrawn in the background when this changes.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct RainStreaks {
    /// Exposure time: streaks are as long as the distance that drops fall in it.
    pub exposure: Exposure,
    /// How fast drops fall. Default [`DragLaw::GunnKinzer`].
    pub law: DragLaw,
    /// Random seed: different seeds give different drops. Any number, default 0.
    pub seed: u64,
}

/// An exposure time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Exposure {
    /// The frame time of the app, smoothed and within 1/240..=1/30 s, so that one frame's streak
    /// continues where the last one's ends. Textures are redrawn when it has changed by more than a
    /// quarter.
    #[default]
    FrameTime,
    /// A fixed time. Unit: s, range 1/10,000..=1/10.
    Seconds(
        #[reflect(@SettingRange::new(1e-4, 0.1).unit("s").logarithmic().start(1.0 / 60.0))] f32,
    ),
}

/// Longest exposure that follows the frame time. Unit: s.
pub(crate) const LONGEST_FRAME: f32 = 1.0 / 30.0;

impl Exposure {
    /// The exposure to draw with, for frames of `frame` seconds (if known) and current textures of
    /// the exposure `current` (if any).
    pub(crate) fn seconds(self, frame: Option<f32>, current: Option<f32>) -> f32 {
        match self {
            Self::Seconds(seconds) => clamped_exposure(seconds),
            Self::FrameTime => {
                let wanted = frame.or(current).unwrap_or(DEFAULT_EXPOSURE);
                let wanted = wanted.clamp(1.0 / 240.0, LONGEST_FRAME);
                match current {
                    Some(current) if (0.8..=1.25).contains(&(wanted / current)) => current,
                    _ => wanted,
                }
            }
        }
    }
}

/// A box that keeps rain off: it is dry inside and below it, along the fall of the drops.
///
/// The entity's `GlobalTransform` places the box; only the eight shelters nearest to a camera
/// count.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform)]
pub struct RainShelter {
    /// Half of the box's sides in the entity's space. Unit: m at a scale of 1, range 0..=100 and
    /// more, default 1 each.
    #[reflect(@SettingRange::new(0.0, 100.0).unit("m").open())]
    pub half_size: Vec3,
}

impl Default for RainShelter {
    fn default() -> Self {
        Self {
            half_size: Vec3::ONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposure_follows_frames_but_not_their_jitter() {
        let auto = Exposure::FrameTime;
        assert_eq!(auto.seconds(None, None), DEFAULT_EXPOSURE);
        assert_eq!(auto.seconds(Some(1.0), None), 1.0 / 30.0);
        assert_eq!(auto.seconds(Some(0.019), Some(1.0 / 60.0)), 1.0 / 60.0);
        assert_eq!(auto.seconds(Some(0.025), Some(1.0 / 60.0)), 0.025);
        assert_eq!(auto.seconds(None, Some(0.02)), 0.02);
        assert_eq!(Exposure::Seconds(0.002).seconds(Some(0.01), None), 0.002);
    }
}
