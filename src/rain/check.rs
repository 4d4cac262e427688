//! Invalid rain: validation, logging and clamping.

use bevy::prelude::*;
use thiserror::Error;

use super::{
    settings::{Exposure, Rain, RainShelter, RainStreaks},
    streaks::{DEFAULT_EXPOSURE, LONGEST_EXPOSURE, SHORTEST_EXPOSURE},
};
use crate::{
    complaints::{AboutField, Complaints},
    limits::Limited,
};

/// Why rain settings are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RainError {
    /// A field is out of range.
    #[error("`{owner}::{field}` is {value}; it must be from {min} to {max}")]
    Range {
        /// `Rain` or `RainStreaks`.
        owner: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Smallest value allowed.
        min: f32,
        /// Largest value allowed.
        max: f32,
    },
    /// A shelter's box is invalid.
    #[error("`RainShelter::half_size` is {half_size} at a scale of {scale}: not a box")]
    Shelter {
        /// Half of its sides in the entity's space.
        half_size: Vec3,
        /// The scale of its `GlobalTransform`.
        scale: Vec3,
    },
}

impl RainError {
    fn check(owner: &'static str, limited: &Limited) -> Result<(), Self> {
        if limited.is_inside() {
            return Ok(());
        }
        Err(Self::Range {
            owner,
            field: limited.name,
            value: *limited.value,
            min: limited.min,
            max: limited.max,
        })
    }
}

impl AboutField for RainError {
    fn field(&self) -> &'static str {
        match self {
            Self::Range { field, .. } => field,
            Self::Shelter { .. } => "half_size",
        }
    }
}

impl Rain {
    fn fields(&mut self) -> [Limited<'_>; 6] {
        let absent = Self::RAIN;
        [
            // NaN means no rain.
            Limited::new("rate", &mut self.rate, [0.0, 200.0], 0.0),
            Limited::new(
                "distance",
                &mut self.distance,
                [1.0, 100.0],
                absent.distance,
            ),
            Limited::new("extent", &mut self.extent, [0.0, 1e5], absent.extent),
            Limited::new("wind.x", &mut self.wind.x, [-30.0, 30.0], 0.0),
            Limited::new("wind.y", &mut self.wind.y, [-30.0, 30.0], 0.0),
            Limited::new(
                "brightness",
                &mut self.brightness,
                [0.0, 100.0],
                absent.brightness,
            ),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// Returns an error that names the first field out of range and its value.
    pub fn validate(&self) -> Result<(), RainError> {
        let mut rain = *self;
        rain.fields()
            .iter()
            .try_for_each(|field| RainError::check("Rain", field))
    }

    /// The nearest valid settings: values out of range are clamped, a NaN rate becomes 0, and any
    /// other NaN is replaced by the default.
    pub fn clamped(&self) -> Self {
        let mut clamped = *self;
        clamped.fields().iter_mut().for_each(Limited::clamp);
        clamped
    }
}

impl RainStreaks {
    /// Checks the exposure time against its documented range.
    ///
    /// # Errors
    /// Returns an error that names the exposure time's value if it is out of range.
    pub fn validate(&self) -> Result<(), RainError> {
        match self.exposure {
            Exposure::FrameTime => Ok(()),
            Exposure::Seconds(mut seconds) => {
                let exposures = [SHORTEST_EXPOSURE, LONGEST_EXPOSURE];
                let limited = Limited::new("exposure", &mut seconds, exposures, DEFAULT_EXPOSURE);
                RainError::check("RainStreaks", &limited)
            }
        }
    }
}

impl RainShelter {
    /// Checks that the box and its transform are valid. The box may be as flat as a sheet.
    ///
    /// # Errors
    /// Returns an error if the size is not finite or the transform is not invertible.
    pub fn validate(&self, transform: &GlobalTransform) -> Result<(), RainError> {
        let determinant = transform.affine().matrix3.determinant();
        if self.half_size.is_finite() && determinant.is_finite() && determinant.abs() > 1e-12 {
            return Ok(());
        }
        Err(RainError::Shelter {
            half_size: self.half_size,
            scale: transform.scale(),
        })
    }
}

pub(crate) fn check_rain(
    changed: Query<(Entity, &Rain), Changed<Rain>>,
    streaks: Res<RainStreaks>,
    mut gone: RemovedComponents<Rain>,
    mut complaints: Local<Complaints>,
) {
    for entity in gone.read() {
        complaints.forget(entity);
    }
    for (entity, rain) in &changed {
        if let Some(error) = complaints.of(entity, rain.validate()) {
            warn!("camera {entity}: {error}; the nearest value in range is taken");
        }
    }
    if streaks.is_changed()
        && let Some(error) = complaints.of(Entity::PLACEHOLDER, streaks.validate())
    {
        warn!("{error}; the nearest value in range is taken");
    }
}

pub(crate) fn check_shelters(
    changed: Query<
        (Entity, &RainShelter, &GlobalTransform),
        Or<(Changed<RainShelter>, Changed<GlobalTransform>)>,
    >,
    mut gone: RemovedComponents<RainShelter>,
    mut complaints: Local<Complaints>,
) {
    for entity in gone.read() {
        complaints.forget(entity);
    }
    for (entity, shelter, transform) in &changed {
        if let Some(error) = complaints.of(entity, shelter.validate(transform)) {
            warn!("shelter {entity}: {error}; it keeps no rain off");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rain::streaks::clamped_exposure;

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
            assert_eq!(rain.validate().unwrap_err().field(), "rate");
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
        let mut named = Vec::new();
        while let Err(error) = odd.validate() {
            let name = error.field();
            named.push(name);
            odd.fields()
                .iter_mut()
                .filter(|field| field.name == name)
                .for_each(Limited::clamp);
        }
        assert_eq!(
            named,
            ["distance", "extent", "wind.x", "wind.y", "brightness"]
        );
        assert_eq!(
            Rain::falling(1e6).validate().unwrap_err().to_string(),
            "`Rain::rate` is 1000000; it must be from 0 to 200"
        );
    }

    #[test]
    fn exposures_are_named_and_clamped() {
        for (seconds, expected) in [
            (9.0, LONGEST_EXPOSURE),
            (-1.0, SHORTEST_EXPOSURE),
            (f32::NAN, DEFAULT_EXPOSURE),
        ] {
            let streaks = RainStreaks {
                exposure: Exposure::Seconds(seconds),
                ..default()
            };
            assert_eq!(streaks.validate().unwrap_err().field(), "exposure");
            assert_eq!(clamped_exposure(seconds), expected);
        }
        assert_eq!(RainStreaks::default().validate(), Ok(()));
    }
}
