//! What a user sets.

use bevy::{camera::Hdr, prelude::*};

use super::{check::clamped_exposure, clock::RainClock, drops::DragLaw};
use crate::range::SettingRange;

/// Makes a camera see rain. Values that make no sense are named in the log
/// once, and clamped.
///
/// Cameras with equal settings that began together see the same drops, until the wind changes.
///
/// The scene's directional lights (the four brightest that share a render layer with the camera),
/// point and spot lights (the 32 brightest at the camera) light it, and what is all around: the
/// ambient light, and the camera's environment map or sky box.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Hdr, RainClock)]
pub struct Rain {
    /// How much it rains. Unit: mm/h, range 0..=200, default 5. It may change from frame to frame;
    /// at 0 nothing is done. Drops keep their sizes and speeds as others join them.
    #[reflect(@SettingRange::new(0.0, 200.0).unit("mm/h").logarithmic())]
    pub rate: f32,
    /// How far from the camera streaks are drawn; beyond it the background fades. Unit: m, range
    /// 1..=100, default 5 as in the rain paper. Higher: depth and motion in far lamplight; the cost
    /// grows with its logarithm beyond 2 m. Straight up or down, streaks are points: from 8 m on they
    /// fade like what is beyond the distance.
    #[reflect(@SettingRange::new(1.0, 100.0).unit("m").logarithmic())]
    pub distance: f32,
    /// How far it rains: the background fades over the way from [`distance`](Self::distance) to
    /// here. Unit: m, range 0..=100,000, default 500.
    #[reflect(@SettingRange::new(0.0, 1e5).unit("m").logarithmic())]
    pub extent: f32,
    /// Velocity of the air along x and z: drops drift with it. Unit: m/s, range −30..=30 each,
    /// default 0.
    #[reflect(@SettingRange::new(-30.0, 30.0).unit("m/s"))]
    pub wind: Vec2,
    /// How bright drops are. Range 0..=100, default 1, which is what water scatters. Higher:
    /// streaks that show on a display of small range.
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

    /// Rain of some rate (mm/h), the rest as by default.
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
    /// Every drop by itself: the truth that the other is measured against. Slow: millions of
    /// drops within 10 m.
    PerDrop,
}

/// What the textures of streaks are made from. They are drawn anew, in the background, when this
/// changes.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
pub struct RainStreaks {
    /// How long the shutter is open: streaks are as long as drops fall in this time.
    pub exposure: Exposure,
    /// How fast drops fall. Default [`DragLaw::GunnKinzer`].
    pub law: DragLaw,
    /// Other seeds, other drops. Any number, default 0.
    pub seed: u64,
}

/// An exposure time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub enum Exposure {
    /// As long as the app's frames take, smoothed and within 1/240..=1/30 s, so that one frame's
    /// streak goes on where the last one's ends. Textures are drawn anew when it has changed by
    /// more than a quarter.
    #[default]
    FrameTime,
    /// Unit: s, range 1/10,000..=1/10.
    Seconds(
        #[reflect(@SettingRange::new(1e-4, 0.1).unit("s").logarithmic().start(1.0 / 60.0))] f32,
    ),
}

/// Before frames have taken any time. Unit: s.
pub(crate) const DEFAULT_EXPOSURE: f32 = 1.0 / 60.0;

/// Exposures that follow the frames' length are of this at most. Unit: s.
pub(crate) const LONGEST_FRAME: f32 = 1.0 / 30.0;

impl Exposure {
    /// The exposure to draw with when frames take `frame` seconds (if that is known) and textures
    /// of `current` are there (if any are).
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

/// A box that keeps rain off: inside it and below it, as seen along the fall of the drops, it is
/// dry. The entity's `GlobalTransform` places it; of all shelters the eight nearest to a camera
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
