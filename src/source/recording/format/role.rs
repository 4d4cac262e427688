//! Names of attributes.

/// What an attribute of particles is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Id,
    Velocity,
    Radius,
}

/// Names under which particle tools write attributes, in any case; the first is the one that we
/// write.
pub(super) const IDS: [&str; 4] = ["id", "ids", "particle_id", "particle_ids"];
pub(super) const VELOCITIES: [&str; 4] = ["velocity", "velocities", "vel", "v"];
pub(super) const RADII: [&str; 3] = ["radius", "radii", "pscale"];

impl Role {
    pub(super) fn of(name: &str) -> Option<Self> {
        let is_of = |names: &[&str]| names.iter().any(|known| known.eq_ignore_ascii_case(name));
        match () {
            () if is_of(&IDS) => Some(Self::Id),
            () if is_of(&VELOCITIES) => Some(Self::Velocity),
            () if is_of(&RADII) => Some(Self::Radius),
            () => None,
        }
    }

    /// Numbers for each particle.
    pub(super) fn components(self) -> usize {
        match self {
            Self::Velocity => 3,
            Self::Id | Self::Radius => 1,
        }
    }
}
