//! Rain settings.

use bevy::{camera::Hdr, ecs::entity::EntityHashSet, prelude::*};

use super::{
    clock::RainClock,
    drops::DragLaw,
    streaks::{DEFAULT_EXPOSURE, LONGEST_EXPOSURE, SHORTEST_EXPOSURE},
};
use crate::settings::{Checked, SettingRange, Settings};

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
#[require(Hdr, RainClock, Checked<Self>)]
pub struct Rain {
    /// Rain rate. Unit: mm/h, range 0..=200, default 5. It may change from frame to frame; at 0 no
    /// work is done; NaN counts as 0. Drops keep their sizes and speeds as others are added.
    #[reflect(@SettingRange::new(0.0, 200.0).unit("mm/h").logarithmic().initial(0.0))]
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

impl Settings for Rain {}

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
///
/// Values out of range are logged once and clamped.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Reflect)]
#[reflect(Resource, Default, Clone, PartialEq)]
#[require(Checked<Self>)]
pub struct RainStreakSettings {
    /// Exposure time: streaks are as long as the distance that drops fall in it.
    pub exposure: Exposure,
    /// How fast drops fall. Default [`DragLaw::GunnKinzer`].
    pub law: DragLaw,
    /// Random seed: different seeds give different drops. Any number, default 0.
    pub seed: u64,
}

impl Settings for RainStreakSettings {}

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
        #[reflect(@SettingRange::new(SHORTEST_EXPOSURE as f64, LONGEST_EXPOSURE as f64)
            .unit("s")
            .logarithmic()
            .initial(DEFAULT_EXPOSURE as f64))]
        f32,
    ),
}

/// Longest exposure that follows the frame time. Unit: s.
pub(crate) const LONGEST_FRAME: f32 = 1.0 / 30.0;

impl Exposure {
    /// The exposure to draw with, for frames of `frame` seconds (if known) and current textures of
    /// the exposure `current` (if any).
    pub(crate) fn seconds(self, frame: Option<f32>, current: Option<f32>) -> f32 {
        match self {
            Self::Seconds(seconds) => seconds,
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
/// The entity's `GlobalTransform` places the box, which may move. Of those that a camera sees, the
/// 64 count whose dry places, the boxes and what is below them, are nearest. A shelter whose
/// transform has no inverse keeps no rain off.
///
/// Values out of range are logged once and clamped.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Clone, PartialEq)]
#[require(Transform, Checked<Self>)]
pub struct RainShelter {
    /// Half of the box's sides in the entity's space. Unit: m at a scale of 1, range 0..=1e9, default
    /// 1 each; NaN counts as 0. The box may be as flat as a sheet.
    #[reflect(@SettingRange::new(0.0, 100.0).unit("m").valid(0.0, 1e9).initial(0.0))]
    pub half_size: Vec3,
}

impl Settings for RainShelter {}

/// Whether a shelter there has a volume, or a sheet's area.
pub(crate) fn is_place(transform: &GlobalTransform) -> bool {
    let determinant = transform.affine().matrix3.determinant();
    determinant.is_finite() && determinant.abs() > 1e-12
}

/// Logs shelters in places that have none, once.
pub(super) fn check_places(
    moved: Query<
        (Entity, &GlobalTransform),
        (
            With<RainShelter>,
            Or<(Changed<GlobalTransform>, Added<RainShelter>)>,
        ),
    >,
    mut gone: RemovedComponents<RainShelter>,
    mut warned: Local<EntityHashSet>,
) {
    for entity in gone.read() {
        warned.remove(&entity);
    }
    for (entity, transform) in &moved {
        if is_place(transform) {
            warned.remove(&entity);
        } else if warned.insert(entity) {
            let scale = transform.scale();
            warn!("shelter {entity} keeps no rain off: its scale is {scale}, without an inverse");
        }
    }
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
    #[test]
    fn presets_make_sense() {
        for (rain, rate) in [
            (Rain::DRIZZLE, 1.0),
            (Rain::RAIN, 5.0),
            (Rain::HEAVY, 20.0),
            (Rain::CLOUDBURST, 75.0),
        ] {
            assert_eq!(rain.validate(), Ok(()));
            assert_eq!(rain.clamped(), rain);
            assert_eq!(rain.rate, rate);
        }
    }

    #[test]
    fn what_makes_no_sense_is_named_and_clamped() {
        for (rate, expected) in [
            (-1.0, 0.0),
            (f32::NAN, 0.0),
            (1e6, 200.0),
            (f32::INFINITY, 200.0),
        ] {
            let rain = Rain::falling(rate);
            assert_eq!(rain.validate().unwrap_err().name, "Rain::rate");
            assert_eq!(rain.clamped(), Rain::falling(expected));
        }
        let mut odd = Rain {
            distance: f32::NEG_INFINITY,
            extent: f32::NAN,
            wind: vec2(f32::NAN, 1e9),
            brightness: -3.0,
            ..Rain::RAIN
        };
        let clamped = odd.clamped();
        assert_eq!((clamped.distance, clamped.extent), (1.0, 500.0));
        assert_eq!(clamped.wind, vec2(0.0, 30.0));
        assert_eq!(clamped.brightness, 0.0);
        // The invalid fields are named one after the other, until none is left.
        for (name, mend) in [
            (
                "distance",
                (|odd, clamped| odd.distance = clamped.distance) as fn(&mut Rain, Rain),
            ),
            ("extent", |odd, clamped| odd.extent = clamped.extent),
            ("wind.x", |odd, clamped| odd.wind.x = clamped.wind.x),
            ("wind.y", |odd, clamped| odd.wind.y = clamped.wind.y),
            ("brightness", |odd, clamped| {
                odd.brightness = clamped.brightness;
            }),
        ] {
            let error = odd.validate().unwrap_err();
            assert_eq!(error.name, format!("Rain::{name}"));
            mend(&mut odd, clamped);
        }
        assert_eq!(odd.validate(), Ok(()));
        assert_eq!(
            Rain::falling(1e6).validate().unwrap_err().to_string(),
            "`Rain::rate` is 1000000; it must be from 0 to 200 mm/h"
        );
    }

    #[test]
    fn exposures_are_named_and_clamped() {
        for (seconds, expected) in [
            (9.0, LONGEST_EXPOSURE),
            (-1.0, SHORTEST_EXPOSURE),
            (f32::NAN, DEFAULT_EXPOSURE),
        ] {
            let streaks = RainStreakSettings {
                exposure: Exposure::Seconds(seconds),
                ..default()
            };
            let error = streaks.validate().unwrap_err();
            assert_eq!(error.name, "RainStreakSettings::exposure");
            let expected = Exposure::Seconds(expected);
            assert_eq!(streaks.clamped().exposure, expected);
        }
        assert_eq!(RainStreakSettings::default().validate(), Ok(()));
    }
}
