//! Mean and quantiles of many values.

use super::MetricError;

/// How values are distributed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantiles {
    /// How many values there are.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Median.
    pub p50: f64,
    /// 95 % are not above it.
    pub p95: f64,
    /// The greatest.
    pub max: f64,
}

impl Quantiles {
    /// Of values of any order; between two ranks, in proportion.
    ///
    /// # Errors
    /// [`MetricError::NotFinite`] with the number of the value, or [`MetricError::Empty`].
    pub fn of(
        metric: &'static str,
        values: impl IntoIterator<Item = f64>,
    ) -> Result<Self, MetricError> {
        let mut values: Vec<_> = values.into_iter().collect();
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(MetricError::NotFinite { metric, index });
        }
        values.sort_by(f64::total_cmp);
        let Some(&max) = values.last() else {
            return Err(MetricError::Empty { metric });
        };
        let at = |part: f64| {
            let rank = part * (values.len() - 1) as f64;
            let [low, high] = [rank.floor(), rank.ceil()].map(|rank| values[rank as usize]);
            low + (high - low) * rank.fract()
        };
        Ok(Self {
            count: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            p50: at(0.5),
            p95: at(0.95),
            max,
        })
    }
}
