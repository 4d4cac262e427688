//! The range of a setting.

use bevy::reflect::{NamedField, Reflect, UnnamedField};

/// The range and the unit of a number: an attribute of reflected fields.
///
/// [`Settings`](super::Settings) clamps to the valid range; editors, such as the inspector, show a
/// slider from [`min`](Self::min) to [`max`](Self::max). The range of a vector, a colour or an
/// option holds for each number in it.
///
/// ```
/// use bevy::reflect::{Reflect, TypeInfo, Typed};
/// use bevy_fluid::settings::SettingRange;
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
    /// The least value on a slider.
    pub min: f64,
    /// The greatest value on a slider.
    pub max: f64,
    /// The least and the greatest valid value.
    pub valid: [f64; 2],
    /// The unit, as written after a number; empty for pure numbers.
    pub unit: &'static str,
    /// Whether values span orders of magnitude.
    pub logarithmic: bool,
    /// What replaces NaN, and what an editor fills in where an enum's variant is chosen. If this is
    /// NaN: the default, or without one the value nearest to 1.
    pub initial: f64,
}

impl SettingRange {
    /// A range from `min` to `max`, linear and without a unit. No other value is valid.
    pub const fn new(min: f64, max: f64) -> Self {
        Self {
            min,
            max,
            valid: [min, max],
            unit: "",
            logarithmic: false,
            initial: f64::NAN,
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

    /// The same slider, but with all values from `min` to `max` valid.
    pub const fn valid(self, min: f64, max: f64) -> Self {
        Self {
            valid: [min, max],
            ..self
        }
    }

    /// The same slider, but with greater finite values valid too, and if `min` is negative, lesser
    /// ones.
    pub const fn open(self) -> Self {
        let greatest = f32::MAX as f64;
        let least = if self.min < 0.0 { -greatest } else { self.min };
        self.valid(least, greatest)
    }

    /// The same range with an initial value.
    pub const fn initial(self, initial: f64) -> Self {
        Self { initial, ..self }
    }

    /// Whether a value is valid; NaN never is.
    pub fn contains(&self, value: f32) -> bool {
        let [min, max] = self.valid.map(|bound| bound as f32);
        (min..=max).contains(&value)
    }

    /// The range of a struct's field, if it has one.
    pub fn of(field: &NamedField) -> Option<&Self> {
        field.get_attribute()
    }

    /// The range of a tuple's field, if it has one.
    pub fn of_unnamed(field: &UnnamedField) -> Option<&Self> {
        field.get_attribute()
    }

    /// The initial value: [`initial`](Self::initial), or the value nearest to 1.
    pub fn initial_value(&self) -> f64 {
        let initial = if self.initial.is_nan() {
            1.0
        } else {
            self.initial
        };
        initial.clamp(self.min, self.max)
    }

    /// The valid values in words, to follow "it must be".
    pub(super) fn describe(&self) -> String {
        let number = |value: f64| {
            let value = value as f32;
            if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
                format!("{value:e}")
            } else {
                value.to_string()
            }
        };
        let [min, max] = self.valid;
        let greatest = f64::from(f32::MAX);
        let words = match (min <= -greatest, max >= greatest) {
            (true, true) if max.is_infinite() => return "a number".into(),
            (true, true) => return "a finite number".into(),
            (false, true) if max.is_infinite() => format!("at least {}", number(min)),
            (false, true) => format!("finite and at least {}", number(min)),
            _ => format!("from {} to {}", number(min), number(max)),
        };
        let gap = if self.unit.is_empty() { "" } else { " " };
        words + gap + self.unit
    }
}
