//! What a user sets.

use bevy::{camera::Hdr, prelude::*};

use super::{
    clock::RainClock,
    drops::DragLaw,
    streaks::{LONGEST_EXPOSURE, SHORTEST_EXPOSURE},
};
use crate::range::SettingRange;

/// Makes a camera see rain. Values that make no sense are clamped and said once.
///
/// Cameras with equal settings that began together see the same drops.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Hdr, RainClock)]
pub struct Rain {
    /// How much it rains. Unit: mm/h, range 0..=200, default 5. It may change from frame to frame;
    /// at 0 nothing is done.
    #[reflect(@SettingRange::new(0.0, 200.0).unit("mm/h").logarithmic())]
    pub rate: f32,
    /// How far from the camera streaks are drawn; beyond it the background fades. Unit: m, range
    /// 1..=100, default 5 as in the rain paper. Higher: depth and motion in far lamplight; the cost
    /// grows with its logarithm beyond 2 m.
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

    /// These settings within their ranges, and whether all were.
    pub(crate) fn sane(&self) -> (Self, bool) {
        let sane = Self {
            rate: within(self.rate, 0.0, 200.0, 0.0),
            distance: within(self.distance, 1.0, 100.0, 5.0),
            extent: within(self.extent, 0.0, 1e5, 500.0),
            wind: vec2(
                within(self.wind.x, -30.0, 30.0, 0.0),
                within(self.wind.y, -30.0, 30.0, 0.0),
            ),
            brightness: within(self.brightness, 0.0, 100.0, 1.0),
            method: self.method,
        };
        (sane, sane == *self)
    }
}

/// `value` clamped, or `fallback` for what is not a number.
fn within(value: f32, low: f32, high: f32, fallback: f32) -> f32 {
    if value.is_nan() {
        fallback
    } else {
        value.clamp(low, high)
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
    /// Other seeds, other drops. Default 0.
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

impl Exposure {
    /// The exposure to draw with when frames take `frame` seconds (if that is known) and textures
    /// of `current` are there (if any are).
    pub(crate) fn seconds(self, frame: Option<f32>, current: Option<f32>) -> f32 {
        match self {
            Self::Seconds(seconds) => within(
                seconds,
                SHORTEST_EXPOSURE,
                LONGEST_EXPOSURE,
                DEFAULT_EXPOSURE,
            ),
            Self::FrameTime => {
                let wanted = frame.or(current).unwrap_or(DEFAULT_EXPOSURE);
                let wanted = within(wanted, 1.0 / 240.0, 1.0 / 30.0, DEFAULT_EXPOSURE);
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
    /// Half of the box's sides in the entity's space. Default 1 each.
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
    fn presets_are_sane() {
        for (rain, rate) in [
            (Rain::DRIZZLE, 1.0),
            (Rain::RAIN, 5.0),
            (Rain::HEAVY, 20.0),
            (Rain::CLOUDBURST, 75.0),
        ] {
            assert_eq!(rain.sane(), (rain, true));
            assert_eq!(rain.rate, rate);
        }
    }

    #[test]
    fn what_makes_no_sense_is_clamped() {
        for (rate, expected) in [
            (-1.0, 0.0),
            (f32::NAN, 0.0),
            (1e6, 200.0),
            (f32::INFINITY, 200.0),
        ] {
            let (sane, was) = Rain::falling(rate).sane();
            assert_eq!((sane.rate, was), (expected, false));
        }
        let odd = Rain {
            distance: f32::NEG_INFINITY,
            wind: vec2(f32::NAN, 1e9),
            brightness: -3.0,
            ..Rain::RAIN
        };
        let (sane, _) = odd.sane();
        assert_eq!(
            (sane.distance, sane.wind, sane.brightness),
            (1.0, vec2(0.0, 30.0), 0.0)
        );
    }

    #[test]
    fn exposure_follows_frames_but_not_their_jitter() {
        let auto = Exposure::FrameTime;
        assert_eq!(auto.seconds(None, None), DEFAULT_EXPOSURE);
        assert_eq!(auto.seconds(Some(1.0), None), 1.0 / 30.0);
        assert_eq!(auto.seconds(Some(0.019), Some(1.0 / 60.0)), 1.0 / 60.0);
        assert_eq!(auto.seconds(Some(0.025), Some(1.0 / 60.0)), 0.025);
        assert_eq!(auto.seconds(None, Some(0.02)), 0.02);
        assert_eq!(
            Exposure::Seconds(f32::NAN).seconds(Some(0.01), None),
            DEFAULT_EXPOSURE
        );
        assert_eq!(Exposure::Seconds(9.0).seconds(None, None), LONGEST_EXPOSURE);
    }
}
