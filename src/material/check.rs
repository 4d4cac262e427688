//! Invalid materials: validation, logging and clamping.

use bevy::prelude::*;
use thiserror::Error;

use super::{FluidMaterial, Thickness};
use crate::{
    complaints::{AboutField, Complaints},
    medium::MediumError,
    schedule::FluidSystems,
};

const REFRACTIVE_INDICES: [f32; 2] = [0.2, 5.0];
const ROUGHNESSES: [f32; 2] = [0.03, 1.0];
const SOFTNESSES: [f32; 2] = [0.0, 8.0];

/// Why a material is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MaterialError {
    /// A field of the medium is out of range.
    #[error("`FluidMaterial::medium`: {0}")]
    Medium(#[from] MediumError),
    /// A field of the material itself is out of range.
    #[error("`FluidMaterial::{field}` is {value}; it must be from {min} to {max}")]
    Range {
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Smallest value allowed.
        min: f32,
        /// Largest value allowed.
        max: f32,
    },
}

impl FluidMaterial {
    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// Returns an error that names the first field out of range and its value.
    pub fn validate(&self) -> Result<(), MaterialError> {
        self.medium.validate()?;
        let softness = match self.thickness {
            Thickness::Layers => 0.0,
            Thickness::Accumulated { softness } => softness,
        };
        for (field, value, [min, max]) in [
            (
                "refractive_index",
                self.refractive_index,
                REFRACTIVE_INDICES,
            ),
            (
                "perceptual_roughness",
                self.perceptual_roughness,
                ROUGHNESSES,
            ),
            ("thickness.softness", softness, SOFTNESSES),
        ] {
            // NaN is in no range.
            if !(min..=max).contains(&value) {
                return Err(MaterialError::Range {
                    field,
                    value,
                    min,
                    max,
                });
            }
        }
        Ok(())
    }

    /// The nearest valid material: values out of range are clamped, NaN is replaced by the default.
    pub fn clamped(&self) -> Self {
        let within = |value: f32, [min, max]: [f32; 2], absent: f32| {
            if value.is_nan() {
                absent
            } else {
                value.clamp(min, max)
            }
        };
        let default = Self::default();
        Self {
            refractive_index: within(
                self.refractive_index,
                REFRACTIVE_INDICES,
                default.refractive_index,
            ),
            medium: self.medium.clamped(),
            perceptual_roughness: within(
                self.perceptual_roughness,
                ROUGHNESSES,
                default.perceptual_roughness,
            ),
            thickness: match self.thickness {
                Thickness::Layers => Thickness::Layers,
                Thickness::Accumulated { softness } => Thickness::Accumulated {
                    softness: within(softness, SOFTNESSES, 1.0),
                },
            },
        }
    }
}

impl AboutField for MaterialError {
    fn field(&self) -> &'static str {
        match self {
            Self::Medium(MediumError::Density { field, .. } | MediumError::Color { field, .. }) => {
                field
            }
            Self::Medium(MediumError::Emission { .. }) => "emission",
            Self::Range { field, .. } => field,
        }
    }
}

fn check_materials(
    changed: Query<(Entity, &FluidMaterial), Changed<FluidMaterial>>,
    mut gone: RemovedComponents<FluidMaterial>,
    mut complaints: Local<Complaints>,
) {
    for entity in gone.read() {
        complaints.forget(entity);
    }
    for (entity, material) in &changed {
        if let Some(error) = complaints.of(entity, material.validate()) {
            warn!("fluid {entity}: {error}; it is drawn with the nearest value in range");
        }
    }
}

pub(crate) fn plugin(app: &mut App) {
    app.add_systems(PostUpdate, check_materials.after(FluidSystems::Simulate));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_make_sense() {
        for preset in [
            FluidMaterial::WATER,
            FluidMaterial::CLEAR_WATER,
            FluidMaterial::INK,
            FluidMaterial::MILK,
            FluidMaterial::HONEY,
            FluidMaterial::SMOKE,
            FluidMaterial::FIRE,
        ] {
            assert_eq!(preset.validate(), Ok(()));
            assert_eq!(preset.clamped(), preset);
        }
    }

    #[test]
    fn bad_fields_are_named_and_clamped() {
        let cases: [(&str, fn(&mut FluidMaterial, f32)); 4] = [
            ("FluidMaterial::refractive_index", |m, v| {
                m.refractive_index = v;
            }),
            ("FluidMaterial::perceptual_roughness", |m, v| {
                m.perceptual_roughness = v;
            }),
            ("FluidMaterial::thickness.softness", |m, v| {
                m.thickness = Thickness::Accumulated { softness: v };
            }),
            ("FluidMaterial::medium`: `scattering_density", |m, v| {
                m.medium.scattering_density = v;
            }),
        ];
        for (field, set) in cases {
            for value in [-1.0, f32::NAN, f32::INFINITY] {
                let mut bad = FluidMaterial::SMOKE;
                set(&mut bad, value);
                let error = bad.validate().unwrap_err().to_string();
                assert!(
                    error.contains(field) && error.contains(&value.to_string()),
                    "{error}"
                );
                assert_eq!(bad.clamped().validate(), Ok(()));
            }
        }
    }

    #[test]
    fn a_complaint_is_made_once() {
        let mut complaints = Complaints::default();
        let [a, b] = [1, 2].map(|i| Entity::from_raw_u32(i).unwrap());
        let mut bad = FluidMaterial::WATER;
        bad.medium.absorption_density = f32::NAN;
        assert!(complaints.of(a, bad.validate()).is_some());
        assert!(complaints.of(a, bad.validate()).is_none(), "said already");
        bad.medium.absorption_density = -1.0;
        assert!(
            complaints.of(a, bad.validate()).is_none(),
            "of the same field"
        );
        assert!(complaints.of(b, bad.validate()).is_some(), "another fluid");
        bad.medium.absorption_density = 1.0;
        assert!(complaints.of(a, bad.validate()).is_none(), "mended");
        bad.medium.absorption_density = -1.0;
        assert!(complaints.of(a, bad.validate()).is_some(), "bad again");
    }
}
