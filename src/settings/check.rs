//! The one check of settings: every number against the range of its field.

use core::fmt::{self, Display};
use std::time::Duration;

use bevy::reflect::{NamedField, PartialReflect, Reflect, ReflectMut, enums::VariantInfo};
use thiserror::Error;

use super::SettingRange;

/// A setting out of its range.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{name}` is {value}; it must be {expected}")]
#[non_exhaustive]
pub struct SettingError {
    /// Type and field, such as `Rain::wind.x`.
    pub name: String,
    /// The invalid value.
    pub value: String,
    /// What it must be, such as "from -30 to 30 m/s".
    pub expected: String,
}

impl SettingError {
    pub(crate) fn new(name: impl Display, value: impl Display, expected: impl Display) -> Self {
        Self {
            name: name.to_string(),
            value: value.to_string(),
            expected: expected.to_string(),
        }
    }
}

/// Settings whose numbers have ranges: a [`SettingRange`] on each field.
///
/// Whatever draws or simulates reads a clamped copy of them. A warning is logged once for each
/// entity and setting.
///
/// ```
/// use bevy_fluid::prelude::*;
///
/// let rain = Rain { distance: -3.0, ..Rain::HEAVY };
/// let error = rain.validate().unwrap_err();
/// assert_eq!(error.to_string(), "`Rain::distance` is -3; it must be from 1 to 100 m");
/// assert_eq!(rain.clamped().distance, 1.0);
/// ```
pub trait Settings: Reflect + Default + Clone + PartialEq {
    /// Mends what no range expresses, such as a direction of no length.
    ///
    /// # Errors
    /// What was wrong, if anything.
    fn mend(&mut self) -> Result<(), SettingError> {
        Ok(())
    }

    /// Clamps every number to its range. NaN is replaced by the default.
    ///
    /// # Errors
    /// The first setting that was invalid.
    fn clamp(&mut self) -> Result<(), SettingError> {
        let mended = self.mend();
        let mut clamped = Ok(());
        for_each_number(self, &mut |number| {
            let valid = number.clamp();
            if clamped.is_ok() {
                clamped = valid;
            }
        });
        mended.and(clamped)
    }

    /// Checks every number against its range.
    ///
    /// # Errors
    /// The first setting that is invalid.
    fn validate(&self) -> Result<(), SettingError> {
        self.clone().clamp()
    }

    /// A valid copy: numbers are clamped to their ranges, NaN is replaced by the default.
    fn clamped(&self) -> Self {
        let mut copy = self.clone();
        // What was invalid is of no interest here.
        let _ = copy.clamp();
        copy
    }
}

/// Visits everything in `settings` that has no parts: its numbers, but also its booleans and text.
pub(crate) fn for_each_number<S: Settings>(settings: &mut S, visit: &mut dyn FnMut(Part)) {
    let default = S::default();
    let info = settings.reflect_type_info();
    let part = Part {
        value: settings,
        default: Some(&default),
        range: None,
        path: &Path {
            name: &info.type_path_table().short_path(),
            parent: None,
        },
    };
    part.walk(visit);
}

/// A part of some settings.
pub(crate) struct Part<'a> {
    pub(crate) value: &'a mut dyn PartialReflect,
    default: Option<&'a dyn PartialReflect>,
    pub(crate) range: Option<&'a SettingRange>,
    pub(crate) path: &'a Path<'a>,
}

/// The name of a part, linked to what it is part of: nothing is allocated.
pub(crate) struct Path<'a> {
    name: &'a dyn Display,
    parent: Option<&'a Path<'a>>,
}

impl Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.parent {
            None => write!(f, "{}", self.name),
            Some(parent) if parent.parent.is_none() => write!(f, "{parent}::{}", self.name),
            Some(parent) => write!(f, "{parent}.{}", self.name),
        }
    }
}

impl Part<'_> {
    fn walk(self, visit: &mut dyn FnMut(Part)) {
        let Part {
            value,
            default,
            range,
            path,
        } = self;
        let default = default.map(PartialReflect::reflect_ref);
        match value.reflect_mut() {
            ReflectMut::Struct(it) => {
                let info = it.get_represented_struct_info();
                let default = default.and_then(|it| it.as_struct().ok());
                for index in 0..it.field_len() {
                    let field = info.and_then(|info| info.field_at(index));
                    if let (Some(value), Some(field)) = (it.field_at_mut(index), field) {
                        let name = field.name();
                        let part = Part {
                            value,
                            default: default.and_then(|it| it.field_at(index)),
                            range: SettingRange::of(field).or(range),
                            path: &path.to(&name),
                        };
                        part.walk(visit);
                    }
                }
            }
            ReflectMut::TupleStruct(it) => {
                let info = it.get_represented_tuple_struct_info();
                let default = default.and_then(|it| it.as_tuple_struct().ok());
                for index in 0..it.field_len() {
                    let field = info.and_then(|info| info.field_at(index));
                    if let Some(value) = it.field_mut(index) {
                        let part = Part {
                            value,
                            default: default.and_then(|it| it.field(index)),
                            range: field.and_then(SettingRange::of_unnamed).or(range),
                            path: &path.to(&index),
                        };
                        part.walk(visit);
                    }
                }
            }
            ReflectMut::Enum(it) => {
                let info = it.get_represented_enum_info();
                let variant = info.and_then(|info| info.variant_at(it.variant_index()));
                let default = default
                    .and_then(|default| default.as_enum().ok())
                    .filter(|default| default.variant_index() == it.variant_index());
                for index in 0..it.field_len() {
                    // What a variant holds without a name is named as the variant's place.
                    let (name, own) = match variant {
                        Some(VariantInfo::Struct(info)) => {
                            let field = info.field_at(index);
                            (
                                field.map(NamedField::name),
                                field.and_then(SettingRange::of),
                            )
                        }
                        Some(VariantInfo::Tuple(info)) => {
                            let field = info.field_at(index);
                            (None, field.and_then(SettingRange::of_unnamed))
                        }
                        _ => continue,
                    };
                    if let Some(value) = it.field_at_mut(index) {
                        let named = name.as_ref().map(|name| path.to(name));
                        let part = Part {
                            value,
                            default: default.and_then(|it| it.field_at(index)),
                            range: own.or(range),
                            path: named.as_ref().unwrap_or(path),
                        };
                        part.walk(visit);
                    }
                }
            }
            ReflectMut::Opaque(value) => visit(Part {
                value,
                default: self.default,
                range,
                path,
            }),
            _ => {}
        }
    }

    /// Clamps a number with a range.
    ///
    /// # Errors
    /// Its name and value if it was out of range.
    fn clamp(self) -> Result<(), SettingError> {
        let Some(range) = self.range else {
            return Ok(());
        };
        let error = |value: &dyn Display| SettingError::new(self.path, value, range.describe());
        macro_rules! numbers {
            ($($number:ty),+) => {
                $(if let Some(value) = self.value.try_downcast_mut::<$number>() {
                    let [min, max] = range.valid.map(|bound| bound as $number);
                    if (min..=max).contains(value) {
                        return Ok(());
                    }
                    let error = error(value);
                    let default = self.default.and_then(|it| it.try_downcast_ref::<$number>());
                    *value = if *value < min {
                        min
                    } else if *value > max {
                        max
                    } else {
                        // NaN is neither below nor above.
                        let default = default.copied().filter(|_| range.initial.is_nan());
                        default.unwrap_or(range.initial_value() as $number)
                    };
                    return Err(error);
                })+
            };
        }
        numbers!(f32, f64, u32, u64, usize);
        if let Some(value) = self.value.try_downcast_mut::<Duration>() {
            let seconds = value.as_secs_f64();
            let [min, max] = range.valid;
            if !(min..=max).contains(&seconds) {
                let error = error(&seconds);
                let clamped = Duration::try_from_secs_f64(seconds.clamp(min, max));
                *value = clamped.unwrap_or(*value);
                return Err(error);
            }
        }
        Ok(())
    }
}

impl Path<'_> {
    fn to<'a>(&'a self, name: &'a dyn Display) -> Path<'a> {
        Path {
            name,
            parent: Some(self),
        }
    }
}
