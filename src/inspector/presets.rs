//! Named values of settings, as type data of the reflection registry.

use bevy::{
    prelude::*,
    reflect::{FromType, PartialReflect, TypeRegistry},
};

use crate::{
    emitter::ParticleEmitter,
    material::{FluidMaterial, Medium},
    rain::Rain,
    settings::PlaneFit,
    shape::SurfaceKernel,
};

/// A setting with named values. The inspector offers them if [`ReflectPresets`] is registered for
/// the type:
///
/// ```
/// use bevy::prelude::*;
/// use bevy_fluid::inspector::{Presets, ReflectPresets};
///
/// #[derive(Component, Clone, Default, Reflect)]
/// #[reflect(Component, Default, Presets)]
/// struct Tap {
///     open: bool,
/// }
///
/// impl Presets for Tap {
///     const PRESETS: &[(&str, Self)] = &[("CLOSED", Tap { open: false }), ("OPEN", Tap { open: true })];
/// }
/// ```
pub trait Presets: Reflect + Clone {
    /// Names and values. The names are those of the type's constants.
    const PRESETS: &'static [(&'static str, Self)];
}

/// The [`Presets`] of a type in the registry.
#[derive(Clone)]
pub struct ReflectPresets {
    values: fn() -> Vec<(&'static str, Box<dyn Reflect>)>,
}

impl<T: Presets> FromType<T> for ReflectPresets {
    fn from_type() -> Self {
        Self {
            values: || {
                T::PRESETS
                    .iter()
                    .map(|(name, value)| (*name, Box::new(value.clone()) as Box<dyn Reflect>))
                    .collect()
            },
        }
    }
}

impl ReflectPresets {
    /// Names and values.
    pub fn values(&self) -> Vec<(&'static str, Box<dyn Reflect>)> {
        (self.values)()
    }

    /// The presets of a value's type, if it has any.
    pub fn of(value: &dyn PartialReflect, registry: &TypeRegistry) -> Option<Self> {
        let id = value.get_represented_type_info()?.type_id();
        registry.get_type_data::<Self>(id).cloned()
    }

    /// The name of the preset that `value` equals.
    pub fn name_of(&self, value: &dyn PartialReflect) -> Option<&'static str> {
        let equal = |preset: &dyn Reflect| value.reflect_partial_eq(preset.as_partial_reflect());
        self.values()
            .into_iter()
            .find_map(|(name, preset)| (equal(&*preset) == Some(true)).then_some(name))
    }
}

macro_rules! presets {
    ($($type:ident: $($name:ident),+;)+) => {
        $(impl Presets for $type {
            const PRESETS: &'static [(&'static str, Self)] =
                &[$((stringify!($name), Self::$name)),+];
        })+

        pub(in crate::inspector) fn plugin(app: &mut App) {
            app$(.register_type_data::<$type, ReflectPresets>())+;
        }
    };
}

// In the order in which they are offered.
presets! {
    FluidMaterial: WATER, CLEAR_WATER, INK, MILK, HONEY, SMOKE, FIRE;
    SurfaceKernel: DEFAULT, THESIS, EARLIER, PUFFS;
    Medium: CLEAR;
    ParticleEmitter: DEFAULT, JET, FOUNTAIN, SHOWER, SPRAY, DRIP;
    PlaneFit: DEFAULT, THESIS;
    Rain: DRIZZLE, RAIN, HEAVY, CLOUDBURST;
}

#[cfg(not(feature = "published"))]
pub(super) mod views {
    use super::*;
    use crate::settings::ScreenSpaceFluid;

    presets! {
        ScreenSpaceFluid: FAST, DEFAULT, ACCURATE;
    }
}

#[cfg(feature = "published")]
pub(super) mod views {
    use super::*;
    use crate::settings::{Bilateral, ScreenSpaceFluid};

    presets! {
        ScreenSpaceFluid: FAST, DEFAULT, ACCURATE, THESIS, EARLIER;
        Bilateral: DEFAULT, THESIS;
    }
}

#[cfg(feature = "salva")]
pub(super) mod salva {
    use super::*;
    use crate::source::salva::{SalvaBoundary, SalvaFluid};

    presets! {
        SalvaFluid: WATER, HONEY;
        SalvaBoundary: MESH, GROUND;
    }
}
