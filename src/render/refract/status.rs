//! How searches end.

/// How a search for the next interface ended, as stored per ray (`STATUS_…` in `types.wgsl`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum SearchStatus {
    /// No search was made.
    None = 0,
    /// The interface was found.
    Hit = 1,
    /// The ray meets no further interface.
    NoBracket = 2,
    /// The ray left the layer's silhouette before it crossed the layer.
    LeftLayer = 3,
    /// There was no valid sample to search in.
    Invalid = 4,
    /// Total internal reflection at the interface that was found.
    TotalReflection = 5,
    /// The evaluations ran out before the tolerance was reached.
    Budget = 6,
    /// The ray met an opaque surface first.
    Opaque = 7,
}

impl SearchStatus {
    /// All statuses, in the order of their numbers.
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
}
