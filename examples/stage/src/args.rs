//! The three options of the small examples, parsed by hand so that these need only Bevy. Examples
//! with more options use clap.

use std::{ffi::OsString, path::PathBuf};

use bevy::math::UVec2;
use clap::{Parser, error::ErrorKind};
use thiserror::Error;

use crate::{
    plugins::StagePlugins,
    stage::{MAX_SIDE, is_valid_size},
};

const USAGE: &str = "\
Options:
  --out FILE.png   render without a window and write a picture
  --size WxH       size of the window or picture in pixels
  --frames N       frames to simulate before the picture is taken
  --help           print this";

/// Why the command line is invalid.
#[derive(Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum ArgumentError {
    /// `--help` was requested: not an error, but not a run either.
    #[error("{USAGE}")]
    Help,
    /// An unknown option or a stray word.
    #[error("unknown option `{0}` (see --help)")]
    Unknown(String),
    /// An option without its value.
    #[error("option `{0}` needs a value")]
    MissingValue(&'static str),
    /// A size that is not two whole numbers with an `x` between, or out of range.
    #[error("option `--size`: `{0}` is not WIDTHxHEIGHT with sides of 1 to {MAX_SIDE} pixels")]
    Size(String),
    /// A number of frames that is not a whole number.
    #[error("option `--frames`: `{0}` is not a whole number")]
    Frames(String),
    /// A picture in a format that the stage does not write.
    #[error("option `--out`: `{0}` does not end in .png")]
    NotPng(String),
}

impl StagePlugins {
    /// The default stage changed by this program's options; ends the program on a bad option
    /// (one line on stderr, exit code 2) and on `--help`.
    pub fn from_args() -> Self {
        Self::default().with_args()
    }

    /// This stage changed by this program's options; ends the program as
    /// [`from_args`](Self::from_args) does.
    pub fn with_args(self) -> Self {
        match self.parse(std::env::args_os().skip(1)) {
            Ok(stage) => stage,
            Err(help @ ArgumentError::Help) => {
                println!("{help}");
                std::process::exit(0);
            }
            Err(error) => {
                eprintln!("{error}");
                std::process::exit(2);
            }
        }
    }

    /// This stage changed by `--out FILE.png`, `--size WxH` and `--frames N`, without the program's
    /// name.
    pub fn parse(
        mut self,
        args: impl IntoIterator<Item = OsString>,
    ) -> Result<Self, ArgumentError> {
        let mut args = args.into_iter();
        while let Some(option) = args.next() {
            let mut value = |name| args.next().ok_or(ArgumentError::MissingValue(name));
            match option.to_str() {
                Some("--help" | "-h") => return Err(ArgumentError::Help),
                Some("--out") => self.out = Some(png(value("--out")?)?),
                Some("--size") => self.size = size(&text(value("--size")?))?,
                Some("--frames") => self.frames = frames(&text(value("--frames")?))?,
                _ => return Err(ArgumentError::Unknown(text(option))),
            }
        }
        Ok(self)
    }
}

/// This program's options, parsed by clap; ends the program with one line and exit code 2 if they
/// are invalid.
pub fn parse_args<A: Parser>() -> A {
    A::try_parse().unwrap_or_else(|error| {
        if matches!(
            error.kind(),
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
        ) {
            error.exit();
        }
        // Clap's message continues with the usage; the error is in its first paragraph.
        let text = error.to_string();
        let first = text.split("\n\n").next().unwrap_or(&text);
        let line = first.split_whitespace().collect::<Vec<_>>().join(" ");
        eprintln!("{line}");
        std::process::exit(2);
    })
}

fn text(word: OsString) -> String {
    word.to_string_lossy().into_owned()
}

fn png(word: OsString) -> Result<PathBuf, ArgumentError> {
    let path = PathBuf::from(word);
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("png") => Ok(path),
        _ => Err(ArgumentError::NotPng(path.display().to_string())),
    }
}

fn size(word: &str) -> Result<UVec2, ArgumentError> {
    word.split_once('x')
        .and_then(|(width, height)| Some(UVec2::new(width.parse().ok()?, height.parse().ok()?)))
        .filter(|size| is_valid_size(*size))
        .ok_or_else(|| ArgumentError::Size(word.into()))
}

fn frames(word: &str) -> Result<u32, ArgumentError> {
    word.parse().map_err(|_| ArgumentError::Frames(word.into()))
}
