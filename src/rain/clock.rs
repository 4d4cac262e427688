//! How far drops have fallen.

use bevy::{
    math::{DVec2, DVec3, Vec2},
    prelude::*,
};

/// When a camera moves this far up or down, the height about which columns lean changes. Unit: m.
const REACH: f64 = 32.0;

/// After this time, individually drawn drops restart, so that 32-bit floats stay precise. Unit: s.
const PERIOD: f64 = 256.0;

/// The state of a camera's rain, advanced by `Time`.
///
/// Neither a jump of the camera nor a change of settings makes drops jump at the camera's height,
/// and a [`WorldShift`](crate::relocation::WorldShift) takes all drops along.
/// When the wind changes, so does the lean of columns: the farther above or below the camera, the
/// farther they swing.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct RainClock {
    /// How far the drops of the textures have fallen. Unit: m.
    pub(crate) fallen: f64,
    /// How long individually drawn drops have fallen, and how far the air has moved in that time.
    /// Unit: s, m.
    pub(crate) seconds: f64,
    pub(crate) drift: DVec2,
    /// How far drops of mean speed move sideways (x, z) while they fall a metre.
    pub(crate) lean: Vec2,
    /// Offset of the columns of drops at `height` from their places in the lattice. Unit: m.
    pub(crate) anchor: DVec2,
    /// Unit: m.
    pub(crate) height: f64,
    /// Where the lattice's origin is in the world, which may have been shifted. Unit: m.
    pub(crate) origin: DVec3,
    /// Whether `lean` has been set.
    pub(crate) has_begun: bool,
}

impl RainClock {
    /// `speed` is the drops' mean speed; the camera's height is in the lattice.
    pub(crate) fn advance(&mut self, seconds: f64, wind: Vec2, speed: f64, camera_height: f64) {
        self.fallen += speed * seconds;
        self.seconds += seconds;
        self.drift += wind.as_dvec2() * seconds;
        if self.seconds > PERIOD {
            (self.seconds, self.drift) = default();
        }
        let lean = wind / speed.max(0.1) as f32;
        if !self.has_begun {
            (self.lean, self.has_begun) = (lean, true);
        }
        if (camera_height - self.height).abs() > REACH && camera_height.is_finite() {
            self.anchor -= self.lean.as_dvec2() * (camera_height - self.height);
            self.height = camera_height;
        }
        // At the camera's height, columns stay where they are.
        self.anchor += (lean - self.lean).as_dvec2() * (camera_height - self.height);
        self.lean = lean;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Place of a column at some height.
    fn place(clock: &RainClock, height: f64) -> DVec2 {
        clock.anchor - clock.lean.as_dvec2() * (height - clock.height)
    }

    /// Place of a drop of some speed that began at the origin: the place of its column, which is
    /// fixed at any height, plus its offset (see `drops.wgsl`).
    fn drop_place(clock: &RainClock, speed: f64, mean: f64) -> DVec2 {
        place(clock, -speed * clock.seconds) + clock.drift * (1.0 - speed / mean)
    }

    #[test]
    fn drops_fall_at_the_mean_speed() {
        let mut clock = RainClock::default();
        for _ in 0..60 {
            clock.advance(1.0 / 60.0, Vec2::ZERO, 5.0, 0.0);
        }
        assert!((clock.fallen - 5.0).abs() < 1e-9);
    }

    /// The wind carries every drop at the wind's speed, however fast the drop falls.
    #[test]
    fn drops_drift_with_the_wind() {
        let (wind, mean) = (vec2(3.0, -1.0), 5.0);
        for speed in [0.5, 5.0, 9.0] {
            let mut clock = RainClock::default();
            clock.advance(0.0, wind, mean, 0.0);
            for _ in 0..30 {
                clock.advance(0.1, wind, mean, 0.0);
            }
            let went = drop_place(&clock, speed, mean);
            assert!(
                (went - 3.0 * wind.as_dvec2()).length() < 1e-5,
                "{speed}: {went}"
            );
        }
    }

    #[test]
    fn a_change_of_wind_moves_no_column_before_the_camera() {
        let mut clock = RainClock::default();
        for (height, winds) in [
            (20.0, [vec2(3.0, 0.0), vec2(-4.0, 2.0)]),
            (900.0, [vec2(1.0, 1.0), vec2(0.0, 5.0)]),
        ] {
            clock.advance(0.0, clock.lean * 5.0, 5.0, height);
            let before = place(&clock, height);
            for wind in winds {
                clock.advance(0.0, wind, 5.0, height);
                assert!((place(&clock, height) - before).length() < 1e-4);
            }
        }
    }

    /// Cameras that began together are among the same columns.
    #[test]
    fn a_cameras_height_places_no_column() {
        let [low, high] = [2.0, 900.0].map(|height| {
            let mut clock = RainClock::default();
            clock.advance(0.1, vec2(5.0, -2.0), 5.0, height);
            place(&clock, 5.0)
        });
        assert!((low - high).length() < 1e-4, "{low}, {high}");
    }

    #[test]
    fn a_jump_of_the_camera_moves_no_column() {
        let mut clock = RainClock::default();
        clock.advance(0.0, vec2(5.0, -2.0), 5.0, 0.0);
        let before = place(&clock, 1000.0);
        clock.advance(0.0, vec2(5.0, -2.0), 5.0, 1000.0);
        assert!((place(&clock, 1000.0) - before).length() < 1e-4);
    }
}
