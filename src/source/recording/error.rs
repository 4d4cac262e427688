//! Errors of recordings.

use thiserror::Error;

use super::frame::FrameError;

/// Why a recording cannot be found or played; the error names the cause.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The pattern of the frames' names is invalid.
    #[error("`{pattern}` is an invalid pattern of frames: {reason}")]
    Pattern {
        /// The pattern.
        pattern: String,
        /// Why.
        reason: &'static str,
    },
    /// A frame's file has an error.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The frame rate or the radius is not a positive number.
    #[error("recording `{pattern}`: its {field} is {value}; it must be a positive number")]
    Value {
        /// The pattern.
        pattern: String,
        /// `rate` or `radius`.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// The folder cannot be listed.
    #[error(
        "cannot list {folder} for `{pattern}`: {reason} (`first` and `last` spare the listing)"
    )]
    Folder {
        /// The folder.
        folder: String,
        /// The pattern.
        pattern: String,
        /// Why.
        reason: String,
    },
    /// No file matches, or the first number is above the last.
    #[error("there are no frames `{pattern}` from {first} to {last}")]
    NoFrames {
        /// The pattern.
        pattern: String,
        /// The first number requested.
        first: u32,
        /// The last number requested.
        last: u32,
    },
    /// More frames are requested than a recording may have.
    #[error("`{pattern}` names more than {most} frames")]
    TooManyFrames {
        /// The pattern.
        pattern: String,
        /// The maximum.
        most: u32,
    },
    /// The `.fluid.ron` file cannot be read.
    #[error("{name} is an invalid description of a recording: {reason}")]
    Description {
        /// The file.
        name: String,
        /// Why.
        reason: String,
    },
}
