//! Why there is no report.

use std::{io, path::PathBuf};

use fluid_reference::metrics::MetricError;
use fluid_stage::StageError;
use thiserror::Error;

/// Why there is no report.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The command line was not understood, or asks for help.
    #[error("{0}")]
    Arguments(#[from] clap::Error),
    /// A scene or method that does not exist.
    #[error("unknown {what} `{name}`; there are: {known}")]
    Unknown {
        /// Scene or method.
        what: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A file or the folder cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A frame of particles cannot be read.
    #[error("cannot read {}: {reason}", path.display())]
    Particles {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// The part of a scene failed in a process of its own, which has said why.
    #[error("no values in {}: {reason}", path.display())]
    Part {
        /// Its table.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// Nothing renders, or not rightly.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The particles of a scene cannot be shaped.
    #[error(transparent)]
    Shape(#[from] bevy_fluid::shape::ShapeError),
    /// Something that was measured is not a number.
    #[error("{scene}, {method}: {source}")]
    Metric {
        /// Where.
        scene: String,
        /// With which method.
        method: String,
        /// What.
        source: MetricError,
    },
    /// A plot cannot be drawn.
    #[error("cannot draw {}: {reason}", path.display())]
    Plot {
        /// Its file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}

impl ReportError {
    /// The exit code of the program: 0 for help, 2 where the request or the machine is at fault,
    /// 1 where the program is.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Arguments(error) => error.exit_code() as u8,
            Self::Unknown { .. } | Self::Write { .. } | Self::Particles { .. } => 2,
            Self::Stage(error) => error.exit_code(),
            Self::Shape(_) | Self::Metric { .. } | Self::Part { .. } | Self::Plot { .. } => 1,
        }
    }
}
