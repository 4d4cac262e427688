//! The particles of one moment, and the files that hold them.

use std::{fs, io, path::Path};

use bevy::prelude::*;
use thiserror::Error;

use super::format::ParticleFormat;

/// The particles of one moment, as a file holds them.
///
/// An asset: `asset_server.load::<ParticleFrame>("dam.vtk")` reads one file of any
/// [`ParticleFormat`] by its extension.
#[derive(Asset, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Default, Clone, PartialEq)]
pub struct ParticleFrame {
    /// Centres, in the file's order. Unit: m. Those that are not finite are kept.
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
    /// Parses the content of the file `name`, whose extension sets the format. Memory and time are
    /// bounded by the actual bytes, whatever the header claims (a zipped `.bgeo` may unzip to 1
    /// GiB).
    ///
    /// # Errors
    /// [`FrameError::Format`], [`FrameError::Empty`] and [`FrameError::Damaged`].
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, FrameError> {
        let format = ParticleFormat::of(name)?;
        if bytes.is_empty() && format != ParticleFormat::Xyz {
            return Err(FrameError::Empty { name: name.into() });
        }
        format
            .read(bytes)
            .and_then(Self::checked)
            .map_err(|reason| FrameError::Damaged {
                name: name.into(),
                reason: reason.lines().next().unwrap_or_default().into(),
            })
    }

    /// Reads a file from the file system.
    ///
    /// # Errors
    /// [`FrameError::Read`] and those of [`parse`](Self::parse).
    pub fn read(path: &Path) -> Result<Self, FrameError> {
        let name = path.display().to_string();
        let bytes = fs::read(path).map_err(|error| FrameError::Read {
            name: name.clone(),
            reason: error.to_string(),
        })?;
        Self::parse(&name, &bytes)
    }

    /// Writes a file to the file system, in the format of its extension. The file is written
    /// completely or not at all.
    ///
    /// # Errors
    /// [`FrameError::Format`] and [`FrameError::Write`]; no partial file is left.
    pub fn write(&self, path: &Path) -> Result<(), FrameError> {
        self.write_with(path, &mut Vec::new())
    }

    /// The same with a buffer that can be used again.
    pub(super) fn write_with(&self, path: &Path, bytes: &mut Vec<u8>) -> Result<(), FrameError> {
        let name = path.display().to_string();
        let format = ParticleFormat::of(&name)?;
        bytes.clear();
        self.check()
            .and_then(|()| format.write(self, bytes))
            .and_then(|()| replace(path, bytes).map_err(|error| error.to_string()))
            .map_err(|reason| FrameError::Write { name, reason })
    }

    /// What a reader has found, if every attribute is there for every particle.
    fn checked(self) -> Result<Self, String> {
        self.check()?;
        Ok(Self {
            radius: self.radius.filter(|&radius| is_radius(radius)),
            ..self
        })
    }

    fn check(&self) -> Result<(), String> {
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

/// Puts a file in its place once all of it is written, so that no partial file is read.
pub(super) fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
    // Hidden, so that no listing of frames holds it.
    let temporary = path.with_file_name(format!(".{}.tmp", name.to_string_lossy()));
    fs::write(&temporary, bytes)
        .and_then(|()| fs::rename(&temporary, path))
        .inspect_err(|_| {
            let _ = fs::remove_file(&temporary);
        })
}
