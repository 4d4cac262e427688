//! The formats of particle files: one reader and one writer for each.
//!
//! They are our own: the crates that there are refuse whole files for one unknown word, and end the
//! program for some that are damaged. Memory and time are bounded by the actual bytes, whatever a
//! header claims.

mod bgeo;
mod content;
mod found;
mod gzip;
mod number;
mod ply;
mod role;
mod scan;
mod vtk;
mod xyz;

use std::path::Path;

use bevy::prelude::*;

pub(super) use self::found::{Fault, Found, Note};
use super::frame::{FrameError, ParticleFrame};

/// A format of particle files, known by its extension.
///
/// Any of them may be zipped, with `.gz` behind the extension or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
pub enum ParticleFormat {
    /// Legacy VTK of any version, text or big-endian binary: the points of an unstructured grid or
    /// polygonal data, with the point data `id`, `velocity` and `radius`.
    Vtk,
    /// Houdini's classic `.bgeo` (`.bhclassic`), with the point attributes `id`, `v` and `pscale`.
    Bgeo,
    /// PLY, text or binary: the element `vertex` with `x`, `y`, `z`, and `id`, `vx`, `vy`, `vz`,
    /// `radius`.
    Ply,
    /// Positions without ids, velocities or radius: little-endian `f32` triples, or text with three
    /// numbers in a line, as of atoms or not. Written as triples.
    Xyz,
}

impl ParticleFormat {
    /// The extensions, without the dot.
    pub const EXTENSIONS: [&str; 5] = ["vtk", "bgeo", "bhclassic", "ply", "xyz"];

    /// The format of the file `name`.
    ///
    /// # Errors
    /// [`FrameError::Format`] and [`FrameError::Unsupported`] for any other extension.
    pub fn of(name: &str) -> Result<Self, FrameError> {
        let lower = name.to_lowercase();
        let plain = Path::new(lower.strip_suffix(".gz").unwrap_or(&lower));
        let unsupported = |reason: &str| FrameError::Unsupported {
            name: name.into(),
            reason: reason.into(),
        };
        match plain.extension().and_then(|e| e.to_str()).unwrap_or("") {
            "vtk" => Ok(Self::Vtk),
            "bgeo" | "bhclassic" => Ok(Self::Bgeo),
            "ply" => Ok(Self::Ply),
            "xyz" => Ok(Self::Xyz),
            "vtu" | "vtp" | "vtm" | "pvtu" | "pvtp" | "pvd" => {
                Err(unsupported("it is XML; a legacy .vtk is expected"))
            }
            "sc" => Err(unsupported(
                "it is compressed with Blosc; .bgeo or .bgeo.gz is expected",
            )),
            _ => Err(FrameError::Format { name: name.into() }),
        }
    }

    pub(super) fn read(self, bytes: &[u8]) -> Result<Found, Fault> {
        let bytes = &*gzip::unzipped(bytes)?;
        match self {
            Self::Vtk => vtk::read(bytes),
            Self::Bgeo => bgeo::read(bytes),
            Self::Ply => ply::read(bytes),
            Self::Xyz => xyz::read(bytes),
        }
    }

    /// Appends the content of the file `name` to `bytes`, zipped if its name says so.
    pub(super) fn write(
        self,
        name: &str,
        frame: &ParticleFrame,
        bytes: &mut Vec<u8>,
    ) -> Result<(), String> {
        match self {
            Self::Vtk => vtk::write(frame, bytes)?,
            Self::Bgeo => bgeo::write(frame, bytes)?,
            Self::Ply => ply::write(frame, bytes),
            Self::Xyz => xyz::write(frame, bytes),
        }
        if name.to_lowercase().ends_with(".gz") {
            *bytes = gzip::zipped(bytes).map_err(|error| error.to_string())?;
        }
        Ok(())
    }
}
