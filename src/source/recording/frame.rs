//! The particles of one moment.

use bevy::prelude::*;
use thiserror::Error;

/// The particles of one moment, as a file holds them.
///
/// An asset: `asset_server.load::<ParticleFrame>("dam.vtk")` reads one file of any
/// [`ParticleFormat`](super::ParticleFormat) by its extension.
#[derive(Asset, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct ParticleFrame {
    /// Centres, in the file's order. Unit: m. Those that are not finite are kept, and
    /// dropped by the fluid that shows them.
    pub positions: Vec<Vec3>,
    /// Ids that match particles from frame to frame: one for each particle, or none at all.
    pub ids: Vec<u32>,
    /// Velocities: one for each particle, or none at all. Unit: m/s.
    pub velocities: Vec<Vec3>,
    /// Radius of the particles, the mean where they differ, if the file has it. Unit: m, > 0.
    pub radius: Option<f32>,
}

/// Why a frame cannot be read or written; the error names the file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FrameError {
    /// The file cannot be opened or read to its end.
    #[error("cannot read {name}: {reason}")]
    Read {
        /// The file.
        name: String,
        /// Why.
        reason: String,
    },
    /// The file's extension is unknown.
    #[error("{name} has no known particle format: .vtk, .bgeo, .ply or .xyz is expected")]
    Format {
        /// The file.
        name: String,
    },
    /// The file is empty: it has not even a header.
    #[error("{name} is empty")]
    Empty {
        /// The file.
        name: String,
    },
    /// The file is something else than its extension says, or of a kind that is not read.
    #[error("{name} is not read: {reason}")]
    Unsupported {
        /// The file.
        name: String,
        /// What it is.
        reason: String,
    },
    /// The file breaks the rules of its format.
    #[error("{name} is damaged: {reason}")]
    Damaged {
        /// The file.
        name: String,
        /// How it is damaged.
        reason: String,
    },
    /// The file cannot be written.
    #[error("cannot write {name}: {reason}")]
    Write {
        /// The file.
        name: String,
        /// Why.
        reason: String,
    },
}

impl ParticleFrame {
    /// Whether every attribute is there for every particle.
    pub(super) fn check(&self) -> Result<(), String> {
        let count = self.positions.len();
        for (what, there) in [
            ("ids", self.ids.len()),
            ("velocities", self.velocities.len()),
        ] {
            if there != 0 && there != count {
                return Err(format!("it has {count} particles and {there} {what}"));
            }
        }
        Ok(())
    }
}

/// Whether particles can have this radius.
pub(super) fn is_radius(radius: f32) -> bool {
    radius > 0.0 && radius.is_finite()
}
