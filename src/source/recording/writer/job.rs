//! One file that is to be written, and the description beside the first.

use std::{
    fs,
    path::{Path, PathBuf},
};

use bevy::prelude::*;

use super::RecordingWriter;
use crate::source::recording::{
    asset::RecordingSettings,
    error::RecordingError,
    frame::{FrameError, ParticleFrame},
    frame_file::replace,
    pattern::FramePattern,
};

/// One file to be written.
#[derive(Debug, Default)]
pub(super) struct Job {
    pub(super) frame: ParticleFrame,
    pub(super) path: PathBuf,
    /// A second file, with the first frame; none once it is written.
    pub(super) description: Option<(PathBuf, String)>,
    /// Which of the writer's recordings it is a part of.
    pub(super) recording: u32,
    bytes: Vec<u8>,
}

impl Job {
    pub(super) fn run(&mut self) -> Result<(), FrameError> {
        let failed = |path: &Path| {
            let name = path.display().to_string();
            move |error: std::io::Error| FrameError::Write {
                name,
                reason: error.to_string(),
            }
        };
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder).map_err(failed(folder))?;
        }
        self.frame.write_with(&self.path, &mut self.bytes)?;
        if let Some((path, text)) = &self.description {
            replace(path, text.as_bytes()).map_err(failed(path))?;
            self.description = None;
        }
        Ok(())
    }
}

/// The content of the `.fluid.ron` beside the frames.
pub(super) fn description(
    pattern: &FramePattern,
    writer: &RecordingWriter,
    radius: Option<f32>,
) -> Result<String, RecordingError> {
    let frames = pattern.to_string();
    let settings = RecordingSettings {
        frames: frames[pattern.folder().len()..].into(),
        rate: writer.rate.into(),
        radius,
        ..default()
    };
    ron::ser::to_string_pretty(&settings, default())
        .map(|text| text + "\n")
        .map_err(|error| RecordingError::Description {
            name: frames,
            reason: error.to_string(),
        })
}
