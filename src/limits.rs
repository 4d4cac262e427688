//! Numbers that users set, and their ranges.

/// A number, its range, and the value that replaces NaN.
pub(crate) struct Limited<'a> {
    pub(crate) name: &'static str,
    pub(crate) value: &'a mut f32,
    pub(crate) min: f32,
    pub(crate) max: f32,
    pub(crate) absent: f32,
}

impl<'a> Limited<'a> {
    pub(crate) fn new(
        name: &'static str,
        value: &'a mut f32,
        [min, max]: [f32; 2],
        absent: f32,
    ) -> Self {
        Self {
            name,
            value,
            min,
            max,
            absent,
        }
    }

    /// NaN is in no range.
    pub(crate) fn is_inside(&self) -> bool {
        (self.min..=self.max).contains(self.value)
    }

    /// Clamps the value to its range, and replaces NaN by `absent`.
    pub(crate) fn clamp(&mut self) {
        *self.value = if self.value.is_nan() {
            self.absent
        } else {
            self.value.clamp(self.min, self.max)
        };
    }
}
