//! Numbers that a user sets, and the ranges that they must be in.

/// A number, the range that it must be in, and what stands in for one that is none.
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

    /// Moves what is out of its range to its end.
    pub(crate) fn clamp(&mut self) {
        *self.value = if self.value.is_nan() {
            self.absent
        } else {
            self.value.clamp(self.min, self.max)
        };
    }
}
