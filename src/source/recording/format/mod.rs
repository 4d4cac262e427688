//! The formats of particle files: one reader and one writer for each.

mod bgeo;
mod ply;
mod vtk;
mod xyz;

use std::path::Path;

use bevy::prelude::*;

use super::{
    frame::{FrameError, ParticleFrame, is_radius},
    quietly::quietly,
};

/// A format of particle files, known by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Reflect)]
pub enum ParticleFormat {
    /// Legacy VTK, text or big-endian binary: an unstructured grid or polygonal data, with the
    /// point data `id`, `velocity` and `radius`.
    Vtk,
    /// Houdini's classic `.bgeo`, plain or zipped, with the point attributes `id`, `v` and
    /// `pscale`.
    Bgeo,
    /// PLY, text or binary: the element `vertex` with `x`, `y`, `z`, and `id`, `vx`, `vy`, `vz`,
    /// `radius`.
    Ply,
    /// Little-endian `f32` triples and nothing else: positions without ids, velocities or radius.
    Xyz,
}

/// Names under which particle tools write attributes; the first is the one that we write.
const IDS: [&str; 4] = ["id", "ids", "particle_id", "particle_ids"];
const VELOCITIES: [&str; 5] = ["velocity", "velocities", "vel", "v", "Velocity"];
const RADII: [&str; 4] = ["radius", "radii", "pscale", "Radius"];

impl ParticleFormat {
    /// The extensions, without the dot.
    pub const EXTENSIONS: [&str; 4] = ["vtk", "bgeo", "ply", "xyz"];

    /// The format of the file `name`.
    ///
    /// # Errors
    /// [`FrameError::Format`] for any other extension.
    pub fn of(name: &str) -> Result<Self, FrameError> {
        let extension = Path::new(name).extension().and_then(|e| e.to_str());
        match extension.unwrap_or("").to_lowercase().as_str() {
            "vtk" => Ok(Self::Vtk),
            "bgeo" => Ok(Self::Bgeo),
            "ply" => Ok(Self::Ply),
            "xyz" => Ok(Self::Xyz),
            _ => Err(FrameError::Format { name: name.into() }),
        }
    }

    pub(super) fn read(self, bytes: &[u8]) -> Result<ParticleFrame, String> {
        // Third-party readers panic on some invalid input.
        let guarded = |read: fn(&[u8]) -> Result<ParticleFrame, String>| {
            quietly(|| read(bytes)).ok_or("it breaks its format's rules")?
        };
        match self {
            Self::Vtk => guarded(vtk::read),
            Self::Bgeo => bgeo::read(bytes),
            Self::Ply => guarded(ply::read),
            Self::Xyz => xyz::read(bytes),
        }
    }

    /// Appends the file's content to `bytes`.
    pub(super) fn write(self, frame: &ParticleFrame, bytes: &mut Vec<u8>) -> Result<(), String> {
        match self {
            Self::Vtk => vtk::write(frame, bytes),
            Self::Bgeo => bgeo::write(frame, bytes),
            Self::Ply => ply::write(frame, bytes),
            Self::Xyz => {
                xyz::write(frame, bytes);
                Ok(())
            }
        }
    }
}

/// Ids from numbers of any type; none if any of them is not a whole number of 32 bits.
fn ids(numbers: impl Iterator<Item = f64>) -> Vec<u32> {
    let whole = |number: f64| (number as u32 as f64 == number).then_some(number as u32);
    numbers
        .map(whole)
        .collect::<Option<_>>()
        .unwrap_or_default()
}

/// The mean of the valid radii.
fn mean_radius(radii: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = radii
        .filter(|&radius| is_radius(radius))
        .fold((0.0, 0), |(sum, count), radius| {
            (sum + f64::from(radius), count + 1)
        });
    (count > 0).then(|| (sum / f64::from(count)) as f32)
}

fn floats(vectors: &[Vec3]) -> Vec<f32> {
    vectors.iter().flat_map(Vec3::to_array).collect()
}
