//! Invalid settings: how they are logged and clamped.

use bevy::prelude::*;
use thiserror::Error;

use super::{SalvaBody, SalvaBoundary, SalvaFluid, SalvaSettings, SalvaShape};
use crate::{complaints::AboutField, limits::Limited, source::solid::SolidShape};

const MAX_SUBSTEPS: u32 = 16;
const MAX_STEPS: u32 = 64;

/// Why a component is not simulated as it is set.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SalvaError {
    /// A field is out of its range.
    #[error("`{field}` is {value}; it must be from {min} to {max}")]
    Range {
        /// Component and field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Smallest value allowed.
        min: f32,
        /// Largest value allowed.
        max: f32,
    },
    /// A vector is not finite.
    #[error("`{field}` is {value}; it must be finite")]
    Vector {
        /// Component and field.
        field: &'static str,
        /// Its value.
        value: Vec3,
    },
    /// The radius of a fluid's particles is not finite and positive.
    #[error("`FluidParticles::radius` is {0}; it must be finite and above 0")]
    Radius(f32),
    /// The radius differs from that of the other fluids.
    #[error("its particles' radius is {own}, but that of all simulated fluids is {others}")]
    OtherRadius {
        /// Radius in the world's space, m.
        own: f32,
        /// Radius of the fluid that came first, m.
        others: f32,
    },
    /// There is no `Mesh3d` with triangles in the main world, or a body's hull has no volume.
    #[error(
        "there is no `Mesh3d` with triangles in the main world, or a body's hull has no volume"
    )]
    Mesh,
    /// A size is not finite and positive.
    #[error("`SalvaShape` {0:?} (scaled) is invalid: sizes must be finite and above 0")]
    Shape(SalvaShape),
    /// A body's shape is hollow or endless.
    #[error("a body cannot be a `SalvaShape::Tank` or the `SolidShape::Ground`")]
    BodyShape,
    /// The transform is not finite.
    #[error("its transform is not finite")]
    Transform,
    /// A surface needs more particles than can be simulated.
    #[error(
        "its surface is too large for particles of this radius: liquid collides with its shell only"
    )]
    Surface,
}

impl AboutField for SalvaError {
    fn field(&self) -> &'static str {
        match self {
            Self::Range { field, .. } | Self::Vector { field, .. } => field,
            Self::Radius(_) | Self::OtherRadius { .. } => "radius",
            Self::Mesh => "mesh",
            Self::Shape(_) | Self::BodyShape => "shape",
            Self::Transform => "transform",
            Self::Surface => "surface",
        }
    }
}

impl SalvaError {
    fn check(limited: &Limited) -> Result<(), Self> {
        if limited.is_inside() {
            return Ok(());
        }
        Err(Self::Range {
            field: limited.name,
            value: *limited.value,
            min: limited.min,
            max: limited.max,
        })
    }
}

fn finite(field: &'static str, value: Vec3) -> Result<(), SalvaError> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(SalvaError::Vector { field, value })
    }
}

fn or_zero(value: Vec3) -> Vec3 {
    if value.is_finite() { value } else { Vec3::ZERO }
}

impl SalvaFluid {
    #[rustfmt::skip]
    fn fields(&mut self) -> [Limited<'_>; 6] {
        [
            Limited::new("SalvaFluid::density", &mut self.density, [1.0, 1e5], Self::WATER.density),
            Limited::new("SalvaFluid::viscosity", &mut self.viscosity, [0.0, 10.0], Self::WATER.viscosity),
            Limited::new("SalvaFluid::wall_viscosity", &mut self.wall_viscosity, [0.0, 10.0], Self::WATER.wall_viscosity),
            Limited::new("SalvaFluid::drag", &mut self.drag, [0.0, 1e3], 0.0),
            Limited::new("SalvaFluid::surface_tension", &mut self.surface_tension, [0.0, 10.0], 0.0),
            Limited::new("SalvaFluid::adhesion", &mut self.adhesion, [0.0, 10.0], 0.0),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), SalvaError> {
        let mut own = *self;
        own.fields().iter().try_for_each(SalvaError::check)?;
        finite("SalvaFluid::velocity", self.velocity)
    }

    /// This fluid, clamped to its ranges. Values that are not a number are replaced by the default.
    pub fn clamped(&self) -> Self {
        let mut own = *self;
        own.fields().iter_mut().for_each(Limited::clamp);
        own.velocity = or_zero(own.velocity);
        own
    }
}

impl SalvaBoundary {
    #[rustfmt::skip]
    fn fields(&mut self) -> [Limited<'_>; 2] {
        [
            Limited::new("SalvaBoundary::friction", &mut self.friction, [0.0, 10.0], 0.5),
            Limited::new("SalvaBoundary::restitution", &mut self.restitution, [0.0, 1.0], 0.0),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), SalvaError> {
        let mut own = *self;
        own.fields().iter().try_for_each(SalvaError::check)
    }

    /// This boundary, clamped to its ranges. Values that are not a number are replaced by the
    /// default.
    pub fn clamped(&self) -> Self {
        let mut own = *self;
        own.fields().iter_mut().for_each(Limited::clamp);
        own
    }
}

impl SalvaBody {
    #[rustfmt::skip]
    fn fields(&mut self) -> [Limited<'_>; 3] {
        [
            Limited::new("SalvaBody::density", &mut self.density, [20.0, 1e5], 500.0),
            Limited::new("SalvaBody::friction", &mut self.friction, [0.0, 10.0], 0.5),
            Limited::new("SalvaBody::restitution", &mut self.restitution, [0.0, 1.0], 0.2),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), SalvaError> {
        if matches!(
            self.shape,
            SalvaShape::Tank { .. } | SalvaShape::Solid(SolidShape::Ground)
        ) {
            return Err(SalvaError::BodyShape);
        }
        let mut own = *self;
        own.fields().iter().try_for_each(SalvaError::check)?;
        finite("SalvaBody::velocity", self.velocity)?;
        finite("SalvaBody::angular_velocity", self.angular_velocity)
    }

    /// This body, clamped to its ranges. Values that are not a number are replaced by the default.
    /// The shape stays as it is.
    pub fn clamped(&self) -> Self {
        let mut own = *self;
        own.fields().iter_mut().for_each(Limited::clamp);
        own.velocity = or_zero(own.velocity);
        own.angular_velocity = or_zero(own.angular_velocity);
        own
    }
}

impl SalvaSettings {
    #[rustfmt::skip]
    fn fields(&mut self) -> [Limited<'_>; 2] {
        let default = Self::default();
        [
            Limited::new("SalvaSettings::step", &mut self.step, [0.001, 0.05], default.step),
            Limited::new("SalvaSettings::max_speed", &mut self.max_speed, [1.0, 1e4], default.max_speed),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), SalvaError> {
        let mut own = self.clone();
        own.fields().iter().try_for_each(SalvaError::check)?;
        for (name, count, max) in [
            (
                "SalvaSettings::max_substeps",
                self.max_substeps,
                MAX_SUBSTEPS,
            ),
            ("SalvaSettings::max_steps", self.max_steps, MAX_STEPS),
        ] {
            let mut count = count as f32;
            SalvaError::check(&Limited::new(name, &mut count, [1.0, max as f32], 1.0))?;
        }
        finite("SalvaSettings::gravity", self.gravity)?;
        finite("SalvaSettings::low", self.low)?;
        finite("SalvaSettings::high", self.high)
    }

    /// These settings, clamped to their ranges. Values that are not a number are replaced by the
    /// default.
    pub fn clamped(&self) -> Self {
        let default = Self::default();
        let finite = |value: Vec3, default: Vec3| if value.is_finite() { value } else { default };
        let mut own = self.clone();
        own.fields().iter_mut().for_each(Limited::clamp);
        own.max_substeps = own.max_substeps.clamp(1, MAX_SUBSTEPS);
        own.max_steps = own.max_steps.clamp(1, MAX_STEPS);
        own.gravity = finite(own.gravity, default.gravity);
        own.low = finite(own.low, default.low);
        own.high = finite(own.high, default.high);
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_make_sense() {
        for fluid in [SalvaFluid::WATER, SalvaFluid::HONEY] {
            assert_eq!(fluid.validate(), Ok(()));
            assert_eq!(fluid.clamped(), fluid);
        }
        assert_eq!(SalvaBoundary::default().validate(), Ok(()));
        assert_eq!(SalvaBody::default().validate(), Ok(()));
    }

    #[test]
    fn bad_fields_are_named_and_clamped() {
        for value in [-1.0, f32::NAN, f32::INFINITY] {
            let fluid = SalvaFluid {
                viscosity: value,
                ..SalvaFluid::WATER
            };
            let error = fluid.validate().unwrap_err().to_string();
            assert!(error.contains("SalvaFluid::viscosity") && error.contains(&value.to_string()));
            assert_eq!(fluid.clamped().validate(), Ok(()));

            let body = SalvaBody {
                density: value,
                ..default()
            };
            let error = body.validate().unwrap_err().to_string();
            assert!(error.contains("SalvaBody::density"), "{error}");
            assert_eq!(body.clamped().validate(), Ok(()));

            let boundary = SalvaBoundary {
                friction: value,
                ..default()
            };
            assert!(boundary.validate().is_err());
            assert_eq!(boundary.clamped().validate(), Ok(()));
        }
        let endless = SalvaBody::new(SolidShape::Ground, 500.0);
        assert_eq!(endless.validate(), Err(SalvaError::BodyShape));
    }

    #[test]
    fn bad_settings_are_named_and_clamped() {
        let default = SalvaSettings::default();
        assert_eq!(default.validate(), Ok(()));
        assert_eq!(default.clamped(), default);
        let odd = |change: fn(&mut SalvaSettings)| {
            let mut settings = SalvaSettings::default();
            change(&mut settings);
            settings
        };
        for (settings, name) in [
            (odd(|it| it.step = 0.0), "step` is 0;"),
            (odd(|it| it.max_speed = f32::NAN), "max_speed` is NaN;"),
            (odd(|it| it.max_substeps = 0), "max_substeps` is 0;"),
            (odd(|it| it.max_steps = 1000), "max_steps` is 1000;"),
            (odd(|it| it.gravity.y = f32::NAN), "gravity"),
            (odd(|it| it.low.x = f32::NEG_INFINITY), "low"),
            (odd(|it| it.high.z = f32::INFINITY), "high"),
        ] {
            let error = settings.validate().unwrap_err().to_string();
            assert!(
                error.starts_with("`SalvaSettings::") && error.contains(name),
                "{error}"
            );
            assert_eq!(settings.clamped().validate(), Ok(()), "{name}");
        }
    }
}
