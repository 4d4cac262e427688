//! Invalid settings of emitters and colliders: how they are logged and clamped.

use core::f32::consts::PI;

use bevy::prelude::*;
use thiserror::Error;

use super::{Emission, EmitterBounds, ParticleCollider, ParticleEmitter};
use crate::{
    complaints::{AboutField, Complaints},
    limits::Limited,
    source::solid::SolidShape,
};

/// More particles than this are of no use, and would take gigabytes.
const MAX_PARTICLES: u32 = 10_000_000;

/// Why an emitter or a collider is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EmitterError {
    /// A field is out of its range.
    #[error("`{component}::{field}` is {value}; it must be from {min} to {max}")]
    Range {
        /// `ParticleEmitter` or `ParticleCollider`.
        component: &'static str,
        /// Name of the field.
        field: &'static str,
        /// Its value.
        value: f32,
        /// Smallest value allowed.
        min: f32,
        /// Largest value allowed.
        max: f32,
    },
    /// The direction is zero or not finite.
    #[error("`ParticleEmitter::direction` is {0}; it must be finite and not zero")]
    Direction(Vec3),
    /// The capacity is out of its range.
    #[error("`ParticleEmitter::capacity` is {0}; it must be from 0 to {MAX_PARTICLES}")]
    Capacity(u32),
    /// The bounds enclose nothing.
    #[error("`ParticleEmitter::bounds` are from {} to {}; min must not exceed max", .0.min, .0.max)]
    Bounds(EmitterBounds),
    /// The transform has no inverse, so particles have no place in the entity's space.
    #[error("its `GlobalTransform` has no inverse")]
    Transform,
}

impl AboutField for EmitterError {
    fn field(&self) -> &'static str {
        match self {
            Self::Range { field, .. } => field,
            Self::Direction(_) => "direction",
            Self::Capacity(_) => "capacity",
            Self::Bounds(_) => "bounds",
            Self::Transform => "transform",
        }
    }
}

impl EmitterError {
    fn check(component: &'static str, limited: &Limited) -> Result<(), Self> {
        if limited.is_inside() {
            return Ok(());
        }
        Err(Self::Range {
            component,
            field: limited.name,
            value: *limited.value,
            min: limited.min,
            max: limited.max,
        })
    }
}

impl ParticleEmitter {
    fn fields(&mut self) -> [Limited<'_>; 11] {
        let absent = Self::DEFAULT;
        let [x, y, z] = self.gravity.as_mut();
        [
            Limited::new("rate", &mut self.rate, [0.0, 1e7], absent.rate),
            Limited::new("speed", &mut self.speed, [0.0, 1e3], absent.speed),
            Limited::new("spread", &mut self.spread, [0.0, PI], absent.spread),
            Limited::new("nozzle", &mut self.nozzle, [0.0, 1e3], absent.nozzle),
            Limited::new("jitter", &mut self.jitter, [0.0, 1e3], absent.jitter),
            Limited::new(
                "particle_radius",
                &mut self.particle_radius,
                [1e-6, 1e6],
                absent.particle_radius,
            ),
            Limited::new(
                "lifetime",
                &mut self.lifetime,
                [0.0, f32::INFINITY],
                absent.lifetime,
            ),
            Limited::new("gravity.x", x, [-1e3, 1e3], absent.gravity.x),
            Limited::new("gravity.y", y, [-1e3, 1e3], absent.gravity.y),
            Limited::new("gravity.z", z, [-1e3, 1e3], absent.gravity.z),
            Limited::new("drag", &mut self.drag, [0.0, 1e3], absent.drag),
        ]
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), EmitterError> {
        for field in { *self }.fields() {
            EmitterError::check("ParticleEmitter", &field)?;
        }
        if !self.has_direction() {
            return Err(EmitterError::Direction(self.direction));
        }
        if self.capacity > MAX_PARTICLES {
            return Err(EmitterError::Capacity(self.capacity));
        }
        match self.bounds {
            // Also true for NaN.
            Some(bounds) if !bounds.min.cmple(bounds.max).all() => {
                Err(EmitterError::Bounds(bounds))
            }
            _ => Ok(()),
        }
    }

    /// These settings, clamped to their ranges. NaN and invalid directions are replaced by the
    /// default, empty bounds by none.
    pub fn clamped(&self) -> Self {
        let mut clamped = *self;
        clamped.fields().iter_mut().for_each(Limited::clamp);
        if !self.has_direction() {
            clamped.direction = Self::DEFAULT.direction;
        }
        clamped.capacity = self.capacity.min(MAX_PARTICLES);
        clamped.bounds = self
            .bounds
            .filter(|bounds| bounds.min.cmple(bounds.max).all());
        clamped
    }

    fn has_direction(&self) -> bool {
        self.direction.try_normalize().is_some()
    }
}

impl ParticleCollider {
    fn with_fields<T>(&mut self, f: impl FnOnce(&mut [Limited<'_>]) -> T) -> T {
        const LENGTHS: [f32; 2] = [0.0, 1e6];
        let absent = Self::DEFAULT;
        let restitution = Limited::new(
            "restitution",
            &mut self.restitution,
            [0.0, 1.0],
            absent.restitution,
        );
        let friction = Limited::new("friction", &mut self.friction, [0.0, 1e3], absent.friction);
        match &mut self.shape {
            SolidShape::Ground => f(&mut [restitution, friction]),
            SolidShape::Sphere { radius } => f(&mut [
                restitution,
                friction,
                Limited::new("shape.radius", radius, LENGTHS, 0.0),
            ]),
            SolidShape::Cuboid { half_size } => {
                let [x, y, z] = half_size.as_mut();
                f(&mut [
                    restitution,
                    friction,
                    Limited::new("shape.half_size.x", x, LENGTHS, 0.0),
                    Limited::new("shape.half_size.y", y, LENGTHS, 0.0),
                    Limited::new("shape.half_size.z", z, LENGTHS, 0.0),
                ])
            }
            SolidShape::Capsule {
                radius,
                half_length,
            } => f(&mut [
                restitution,
                friction,
                Limited::new("shape.radius", radius, LENGTHS, 0.0),
                Limited::new("shape.half_length", half_length, LENGTHS, 0.0),
            ]),
            SolidShape::Cylinder {
                radius,
                half_height,
            } => f(&mut [
                restitution,
                friction,
                Limited::new("shape.radius", radius, LENGTHS, 0.0),
                Limited::new("shape.half_height", half_height, LENGTHS, 0.0),
            ]),
        }
    }

    /// Checks every field against its documented range.
    ///
    /// # Errors
    /// The first field that is out of its range, by name and value.
    pub fn validate(&self) -> Result<(), EmitterError> {
        { *self }.with_fields(|fields| {
            fields
                .iter()
                .try_for_each(|field| EmitterError::check("ParticleCollider", field))
        })
    }

    /// This collider, clamped to its ranges. NaN is replaced by the default.
    pub fn clamped(&self) -> Self {
        let mut clamped = *self;
        clamped.with_fields(|fields| fields.iter_mut().for_each(Limited::clamp));
        clamped
    }
}

pub(super) fn check_emitters(
    emitters: Query<(Entity, &ParticleEmitter), Changed<ParticleEmitter>>,
    colliders: Query<(Entity, &ParticleCollider), Changed<ParticleCollider>>,
    mut gone_emitters: RemovedComponents<ParticleEmitter>,
    mut gone_colliders: RemovedComponents<ParticleCollider>,
    mut emissions: Query<&mut Emission>,
    mut of_emitters: Local<Complaints>,
    mut of_colliders: Local<Complaints>,
) {
    for entity in gone_emitters.read() {
        of_emitters.forget(entity);
        // An emitter that is inserted again elsewhere has not moved there from here.
        if let Ok(mut emission) = emissions.get_mut(entity) {
            *emission = default();
        }
    }
    for entity in gone_colliders.read() {
        of_colliders.forget(entity);
    }
    for (entity, emitter) in &emitters {
        if let Some(error) = of_emitters.of(entity, emitter.validate()) {
            warn!("emitter {entity}: {error}; it is clamped");
        }
    }
    for (entity, collider) in &colliders {
        if let Some(error) = of_colliders.of(entity, collider.validate()) {
            warn!("collider {entity}: {error}; it is clamped");
        }
    }
}
