//! Invalid media: validation and clamping.

use bevy::prelude::*;
use thiserror::Error;

use super::Medium;

/// Largest density (1/m) and emission (cd/m² per metre); larger values are clamped, so that squares
/// and products with lengths stay finite.
const LIMIT: f32 = 1e12;

/// Why a medium is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MediumError {
    /// A density is out of range.
    #[error("`{field}` is {value}; it must be from 0 to {LIMIT:e} (1/m)")]
    Density {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
    },
    /// A channel of a colour is out of range.
    #[error("`{field}` is {value} in {channel}; every channel must be from 0 to 1")]
    Color {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Red, green or blue.
        channel: &'static str,
    },
    /// A channel of the emission is out of range.
    #[error(
        "`emission` is {value} in {channel}; every channel must be from 0 to {LIMIT:e} (cd/m² per m)"
    )]
    Emission {
        /// Its value.
        value: f32,
        /// Red, green or blue.
        channel: &'static str,
    },
}

impl Medium {
    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// Returns an error that names the first field out of range and its value.
    pub fn validate(&self) -> Result<(), MediumError> {
        for (field, value) in [
            ("scattering_density", self.scattering_density),
            ("absorption_density", self.absorption_density),
        ] {
            // NaN is in no range.
            if !(0.0..=LIMIT).contains(&value) {
                return Err(MediumError::Density { field, value });
            }
        }
        for (field, color) in [
            ("scattering_color", self.scattering_color),
            ("absorption_color", self.absorption_color),
        ] {
            if let Some((channel, value)) = beyond(color, 1.0) {
                return Err(MediumError::Color {
                    field,
                    value,
                    channel,
                });
            }
        }
        match beyond(self.emission, LIMIT) {
            Some((channel, value)) => Err(MediumError::Emission { value, channel }),
            None => Ok(()),
        }
    }

    /// The nearest valid medium: values out of range are clamped, NaN counts as absent.
    pub fn clamped(&self) -> Self {
        let density = |value: f32| within(value, 0.0, LIMIT);
        let color = |color: LinearRgba, absent, limit| {
            let [r, g, b] = color.to_vec3().to_array().map(|v| within(v, absent, limit));
            LinearRgba::rgb(r, g, b)
        };
        Self {
            scattering_density: density(self.scattering_density),
            scattering_color: color(self.scattering_color, 1.0, 1.0),
            absorption_density: density(self.absorption_density),
            absorption_color: color(self.absorption_color, 1.0, 1.0),
            emission: color(self.emission, 0.0, LIMIT),
        }
    }
}

/// The first channel that is not in 0..=limit.
fn beyond(color: LinearRgba, limit: f32) -> Option<(&'static str, f32)> {
    ["red", "green", "blue"]
        .into_iter()
        .zip(color.to_vec3().to_array())
        .find(|(_, value)| !(0.0..=limit).contains(value))
}

fn within(value: f32, absent: f32, limit: f32) -> f32 {
    if value.is_nan() {
        absent
    } else {
        value.clamp(0.0, limit)
    }
}
