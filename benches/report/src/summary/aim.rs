//! One figure that the project has set itself.

use super::markdown::number;

/// A figure that was aimed for.
pub(super) struct Aim {
    pub(super) what: String,
    pub(super) wanted: String,
    pub(super) got: f64,
    pub(super) reached: bool,
}

impl Aim {
    pub(super) fn at_most(what: impl Into<String>, got: Option<f64>, most: f64) -> Option<Self> {
        Some(Self {
            what: what.into(),
            wanted: format!("≤ {}", number(Some(most))),
            got: got?,
            reached: got? <= most,
        })
    }

    pub(super) fn at_least(what: impl Into<String>, got: Option<f64>, least: f64) -> Option<Self> {
        Some(Self {
            what: what.into(),
            wanted: format!("≥ {least}"),
            got: got?,
            reached: got? >= least,
        })
    }
}
