//! Files of one frame each, read and written.

use std::{fs, io, path::Path};

use super::{
    format::{Fault, ParticleFormat},
    frame::{FrameError, ParticleFrame},
    notes::log_once,
};

impl ParticleFrame {
    /// Parses the content of the file `name`, whose extension sets the format. Memory and time are
    /// bounded by the actual bytes, whatever the header claims (a zipped file may unzip to 1 GiB).
    ///
    /// An attribute that cannot be read is left out, and logged once for all files whose names
    /// differ in their numbers alone.
    ///
    /// # Errors
    /// [`FrameError::Format`], [`FrameError::Empty`], [`FrameError::Unsupported`] and
    /// [`FrameError::Damaged`].
    pub fn parse(name: &str, bytes: &[u8]) -> Result<Self, FrameError> {
        let format = ParticleFormat::of(name)?;
        if bytes.is_empty() && format != ParticleFormat::Xyz {
            return Err(FrameError::Empty { name: name.into() });
        }
        let name = name.to_owned();
        match format.read(bytes) {
            Ok(found) => {
                for note in &found.notes {
                    log_once(&name, note);
                }
                Ok(found.frame)
            }
            Err(Fault::Damaged(reason)) => Err(FrameError::Damaged { name, reason }),
            Err(Fault::Unsupported(reason)) => Err(FrameError::Unsupported { name, reason }),
        }
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
            .and_then(|()| format.write(&name, self, bytes))
            .and_then(|()| replace(path, bytes).map_err(|error| error.to_string()))
            .map_err(|reason| FrameError::Write { name, reason })
    }
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
