//! Ranges of settings, for editors.

use bevy::reflect::{NamedField, Reflect, UnnamedField};

/// The range and the unit of a setting: an attribute of reflected fields, read by editors such as
/// the inspector. It enforces nothing.
///
/// ```
/// use bevy::reflect::{Reflect, TypeInfo, Typed};
/// use bevy_fluid::SettingRange;
///
/// #[derive(Reflect)]
/// struct Pipe {
///     /// How wide it is. Unit: m, range 0.01..=2.
///     #[reflect(@SettingRange::new(0.01, 2.0).unit("m").logarithmic())]
///     width: f32,
/// }
///
/// let TypeInfo::Struct(pipe) = Pipe::type_info() else { unreachable!() };
/// let range = pipe.field("width").and_then(SettingRange::of).unwrap();
/// assert_eq!((range.max, range.unit), (2.0, "m"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
pub struct SettingRange {
    /// The least value.
    pub min: f64,
    /// The greatest value.
    pub max: f64,
    /// The unit, as written after a number; empty for pure numbers.
    pub unit: &'static str,
    /// Whether values span orders of magnitude.
    pub logarithmic: bool,
    /// Whether values beyond `max` are valid too, if rare.
    pub open: bool,
    /// The initial value of an enum variant's field when the variant is chosen; the value nearest
    /// to 1 where this is NaN.
    pub start: f64,
}

impl SettingRange {
    /// A range from `min` to `max`, linear and without a unit.
    pub const fn new(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            unit: "",
            logarithmic: false,
            open: false,
            start: f64::NAN,
        }
    }

    /// The same range with a unit.
    pub const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// The same range over orders of magnitude.
    pub const fn logarithmic(self) -> Self {
        Self {
            logarithmic: true,
            ..self
        }
    }

    /// The same range with larger values allowed.
    pub const fn open(self) -> Self {
        Self { open: true, ..self }
    }

    /// The same range with an initial value.
    pub const fn start(self, start: f64) -> Self {
        Self { start, ..self }
    }

    /// The range of a struct's field, if it has one.
    pub fn of(field: &NamedField) -> Option<&Self> {
        field.get_attribute()
    }

    /// The range of a tuple's field, if it has one.
    pub fn of_unnamed(field: &UnnamedField) -> Option<&Self> {
        field.get_attribute()
    }

    /// The initial value.
    pub fn first(&self) -> f64 {
        let start = if self.start.is_nan() { 1.0 } else { self.start };
        start.clamp(self.min, self.max)
    }

    /// The greatest value that may be typed.
    pub fn limit(&self) -> f64 {
        if self.open { f64::INFINITY } else { self.max }
    }
}
