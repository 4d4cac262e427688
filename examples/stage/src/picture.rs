//! A run that ends in a picture.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    time::Duration,
};

use bevy::prelude::*;
use image::{DynamicImage, ImageFormat, RgbaImage};

use crate::{
    StageError, adapter_name, capture,
    headless::{finish, set_time_step, settle, step},
};

/// Makes `App::run` render `frames` frames and write the last.
pub(crate) struct PicturePlugin {
    pub(crate) out: PathBuf,
    pub(crate) frames: u32,
    pub(crate) time_step: Duration,
}

impl Plugin for PicturePlugin {
    fn build(&self, app: &mut App) {
        let (out, frames, time_step) = (self.out.clone(), self.frames, self.time_step);
        app.set_runner(
            move |mut app| match run(&mut app, &out, frames, time_step) {
                Ok(exit) => exit,
                Err(error) => {
                    eprintln!("{error}");
                    AppExit::from_code(error.exit_code())
                }
            },
        );
    }
}

fn run(app: &mut App, out: &Path, frames: u32, time_step: Duration) -> Result<AppExit, StageError> {
    // First of all, so that an unwritable path does not cost a minute of rendering.
    let picture = PendingPicture::create(out)?;
    finish(app);
    settle(app)?;
    set_time_step(app, time_step);
    let mut stepped = 0;
    while stepped < frames && app.should_exit().is_none() {
        step(app, 1);
        stepped += 1;
    }
    let image = capture(app)?;
    let (width, height) = image.dimensions();
    picture.commit(image)?;
    println!(
        "wrote {} ({width}x{height}, {stepped} frames, {})",
        out.display(),
        adapter_name(app)
    );
    Ok(app.should_exit().unwrap_or(AppExit::Success))
}

/// A picture that is written to a temporary file and then renamed.
///
/// Its path never holds half a picture, and a failed run leaves the last one unchanged.
pub struct PendingPicture<'a> {
    out: &'a Path,
    temporary: PathBuf,
    file: File,
}

impl<'a> PendingPicture<'a> {
    /// Creates the temporary file beside `out`: a path that cannot be written to fails at once.
    pub fn create(out: &'a Path) -> Result<Self, StageError> {
        let failed = |source| StageError::Write {
            path: out.into(),
            source,
        };
        if out.is_dir() {
            return Err(failed(io::ErrorKind::IsADirectory.into()));
        }
        let mut name = out
            .file_name()
            .ok_or_else(|| failed(io::ErrorKind::InvalidFilename.into()))?
            .to_os_string();
        name.push(format!(".{}.tmp", std::process::id()));
        let temporary = out.with_file_name(name);
        let file = File::create(&temporary).map_err(failed)?;
        Ok(Self {
            out,
            temporary,
            file,
        })
    }

    /// Writes the picture and moves it to its path.
    pub fn commit(self, image: RgbaImage) -> Result<(), StageError> {
        // Alpha is dropped, as in a window.
        let opaque = DynamicImage::ImageRgba8(image).into_rgb8();
        let mut writer = BufWriter::new(&self.file);
        opaque
            .write_to(&mut writer, ImageFormat::Png)
            .map_err(io::Error::other)
            .and_then(|()| writer.flush())
            .and_then(|()| fs::rename(&self.temporary, self.out))
            .map_err(|source| StageError::Write {
                path: self.out.into(),
                source,
            })
    }
}

impl Drop for PendingPicture<'_> {
    fn drop(&mut self) {
        // After a commit no file of this name is left.
        let _ = fs::remove_file(&self.temporary);
    }
}
