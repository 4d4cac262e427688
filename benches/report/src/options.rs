//! What is asked for on the command line.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
};

use bevy::math::UVec2;
use clap::Parser;

use crate::{ReportError, methods, scenes};

/// Runs every method with its parameters on every scene and reports speed against error.
#[derive(Parser, Clone, Debug)]
pub struct Options {
    /// Small pictures and few methods: minutes instead of an hour
    #[arg(long)]
    pub quick: bool,
    /// Only this scene; may be given several times
    #[arg(long, value_name = "NAME")]
    pub scene: Vec<String>,
    /// Only methods of this name; may be given several times
    #[arg(long, value_name = "NAME")]
    pub method: Vec<String>,
    /// Size of simulated scenes and of those with many edges in pixels, as in 640x480
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<UVec2>,
    /// Pictures whose mean is the truth about antialiasing, 64 or, if quick, 16
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub jitters: Option<u32>,
    /// No pictures from a moving camera, of which most are drawn
    #[arg(long)]
    pub still: bool,
    /// A folder for the truths about antialiasing: those that are there are not drawn again
    #[arg(long, value_name = "DIR")]
    pub truths: Option<PathBuf>,
    /// Go on with the table in the folder: scenes that are in it are not measured again
    #[arg(long)]
    pub resume: bool,
    /// Where the table, the plots and the summary go
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Where pictures of errors go, if not beside the table
    #[arg(long, value_name = "DIR", hide = true)]
    pictures: Option<PathBuf>,
    /// Only the table: what `run_apart` asks of the process of a scene
    #[arg(long, hide = true)]
    pub(crate) table_only: bool,
    /// What `cargo bench` adds; it means nothing here
    #[arg(long, hide = true)]
    bench: bool,
}

impl Options {
    /// Understands a command line, the program's name first, and makes the folder.
    ///
    /// # Errors
    /// A word that is not understood, a scene or method that does not exist, or a folder that
    /// cannot be written to. `--help` counts as one, with exit code 0.
    pub fn parse_from(
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
    ) -> Result<Self, ReportError> {
        Self::parse_of(words, &scenes::names())
    }

    /// The same of a program with other scenes.
    pub(crate) fn parse_of(
        words: impl IntoIterator<Item = impl Into<OsString> + Clone>,
        scenes: &[&str],
    ) -> Result<Self, ReportError> {
        let options = Self::try_parse_from(words)?;
        let known = |asked: &[String], names: &[&str], what| {
            let stranger = asked.iter().find(|name| !names.contains(&name.as_str()));
            stranger.map_or(Ok(()), |name| {
                Err(ReportError::Unknown {
                    what,
                    name: name.clone(),
                    known: names.join(", "),
                })
            })
        };
        known(&options.scene, scenes, "scene")?;
        known(&options.method, &methods::names(), "method")?;
        options.make_folders()?;
        Ok(options)
    }

    fn make_folders(&self) -> Result<(), ReportError> {
        for folder in self.truths.iter().chain([&self.out]) {
            let probe = folder.join(".probe");
            let made = fs::create_dir_all(folder)
                .and_then(|()| fs::write(&probe, []))
                .and_then(|()| fs::remove_file(&probe));
            made.map_err(|source| ReportError::Write {
                path: folder.clone(),
                source,
            })?;
        }
        Ok(())
    }

    /// Pictures whose mean is the truth about antialiasing.
    pub(crate) fn jitters(&self) -> u32 {
        self.jitters.unwrap_or(if self.quick { 16 } else { 64 })
    }

    /// Where pictures of errors go.
    pub(crate) fn pictures(&self) -> &Path {
        self.pictures.as_ref().unwrap_or(&self.out)
    }

    pub(crate) fn wants_scene(&self, name: &str) -> bool {
        self.scene.is_empty() || self.scene.iter().any(|asked| asked == name)
    }

    pub(crate) fn wants_method(&self, name: &str) -> bool {
        self.method.is_empty() || self.method.iter().any(|asked| asked == name)
    }
}

fn size(word: &str) -> Result<UVec2, String> {
    let sides = word
        .split_once('x')
        .and_then(|(width, height)| Some(UVec2::new(width.parse().ok()?, height.parse().ok()?)));
    sides
        .filter(|size| size.min_element() >= 16 && size.max_element() <= 8192)
        .ok_or_else(|| "not WIDTHxHEIGHT with sides of 16 to 8192 pixels".into())
}
