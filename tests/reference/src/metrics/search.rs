//! How well the next interface is found.

use glam::DVec3;

use super::{MetricError, Quantiles};

/// How a search ended, numbered as in the renderer's `types.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Status {
    /// There was no search.
    #[default]
    None,
    /// It found an interface.
    Hit,
    /// It found nothing on the way.
    NoBracket,
    /// The ray left the layer, or the screen, before it met the interface.
    LeftLayer,
    /// There was nothing to search.
    Invalid,
    /// It found an interface that reflects totally.
    TotalReflection,
    /// It was given up.
    Budget,
    /// Something opaque was in the way.
    Opaque,
}

impl Status {
    /// All, by number.
    pub const ALL: [Self; 8] = [
        Self::None,
        Self::Hit,
        Self::NoBracket,
        Self::LeftLayer,
        Self::Invalid,
        Self::TotalReflection,
        Self::Budget,
        Self::Opaque,
    ];

    fn found(self) -> bool {
        matches!(self, Self::Hit | Self::TotalReflection)
    }
}

/// One search and the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// How it ended.
    pub status: Status,
    /// Where, m.
    pub position: DVec3,
    /// Where the ray really meets the interface, m; `None` where it meets none.
    pub truth: Option<DVec3>,
}

/// What many searches came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchReport {
    /// How many ended in each status, by [`Status::ALL`].
    pub counts: [usize; 8],
    /// How many found nothing where there is an interface.
    pub missed: usize,
    /// How many found an interface where there is none.
    pub invented: usize,
    /// Distances of found interfaces from the true ones, in particle radii; `None` if none was
    /// found.
    pub error: Option<Quantiles>,
}

impl SearchReport {
    /// The part of all searches that ended in a status; 0 without searches.
    pub fn rate(&self, status: Status) -> f64 {
        let all: usize = self.counts.iter().sum();
        self.counts[status as usize] as f64 / all.max(1) as f64
    }
}

/// Counts the ends of searches and measures those that found something, in radii of `radius` m.
///
/// # Errors
/// A found position that is not finite.
pub fn search_report(searches: &[Search], radius: f64) -> Result<SearchReport, MetricError> {
    let mut report = SearchReport {
        counts: [0; 8],
        missed: 0,
        invented: 0,
        error: None,
    };
    let mut distances = Vec::new();
    for search in searches {
        report.counts[search.status as usize] += 1;
        match (search.status.found(), search.truth) {
            (true, Some(truth)) => distances.push(search.position.distance(truth) / radius),
            (true, None) => report.invented += 1,
            (false, Some(_)) => report.missed += 1,
            (false, None) => {}
        }
    }
    if !distances.is_empty() {
        report.error = Some(Quantiles::of("search error", distances)?);
    }
    Ok(report)
}
