//! A recording: its files, and the time of each.

use std::sync::Arc;

use bevy::{
    asset::{AssetPath, AssetServer, io::AssetSourceId},
    prelude::*,
};
use serde::{Deserialize, Serialize};

use super::{error::RecordingError, files, frame::is_radius, pattern::FramePattern};

/// Three days at 60 frames a second are more than anybody records.
const MOST_FRAMES: u32 = 1 << 24;

/// The settings of a recording; also the content of a `.fluid.ron` file beside the frames:
///
/// ```ron
/// (frames: "dam_####.vtk", rate: 30.0, radius: 0.025)
/// ```
#[derive(Clone, Debug, PartialEq, Reflect, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[reflect(Default, Clone, PartialEq)]
pub struct RecordingSettings {
    /// Names of the frames' files, see [`FramePattern`]. In a `.fluid.ron`, relative to that file;
    /// otherwise an asset path, with its source if it is not the default
    /// (`embedded://game/dam_####.vtk`). Absolute paths are read from the file system.
    pub frames: String,
    /// Frames per second of recorded time. Range > 0, default 30.
    pub rate: f64,
    /// Radius of the particles if the files have none. Unit: m, > 0. Default: none.
    pub radius: Option<f32>,
    /// The first number to play. Default: the lowest found.
    pub first: Option<u32>,
    /// The last number to play. Default: the highest found.
    ///
    /// With both `first` and `last` the folder is not listed: set both where it cannot be, as on
    /// the web. Missing frames are then logged and skipped.
    pub last: Option<u32>,
}

impl Default for RecordingSettings {
    fn default() -> Self {
        Self {
            frames: String::new(),
            rate: 30.0,
            radius: None,
            first: None,
            last: None,
        }
    }
}

impl From<&str> for RecordingSettings {
    fn from(frames: &str) -> Self {
        Self {
            frames: frames.into(),
            ..default()
        }
    }
}

/// A numbered sequence of particle files, or a single file. It holds only names and times: the
/// frames are loaded while a [`RecordingPlayer`](super::RecordingPlayer) plays them.
///
/// Frame number n is shown at (n − first) / rate. Missing numbers keep their time: the previous
/// frame is held, or the gap is interpolated.
#[derive(Asset, TypePath, Clone, Debug, PartialEq)]
pub struct FluidRecording {
    /// Shared with the players, which compare it to detect another recording.
    pub(super) frames: Arc<[RecordedFrame]>,
    pub(super) rate: f64,
    pub(super) radius: Option<f32>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct RecordedFrame {
    pub(super) number: u32,
    pub(super) path: AssetPath<'static>,
}

impl FluidRecording {
    /// Finds the frames in the background, as an asset, from a pattern such as
    /// `"frames/dam_####.vtk"`, the name of one file, or [`RecordingSettings`]. Asset servers use
    /// `#` for labels, so a pattern cannot be loaded by its name; a `.fluid.ron` can.
    ///
    /// Errors are logged and become the asset's `LoadState`: see [`RecordingError`].
    pub fn load(server: &AssetServer, settings: impl Into<RecordingSettings>) -> Handle<Self> {
        let settings = settings.into();
        let finder = server.clone();
        server.add_async(async move { Self::find(&finder, &settings, None).await })
    }

    /// Number of files.
    pub fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// The numbers in the files' names, in ascending order.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        self.frames.iter().map(|frame| frame.number)
    }

    /// Frames per second of recorded time.
    pub fn rate(&self) -> f64 {
        self.rate
    }

    /// Time of the last frame. Unit: s.
    pub fn end(&self) -> f64 {
        let number = |frame: Option<&RecordedFrame>| frame.map_or(0.0, |f| f.number.into());
        (number(self.frames.last()) - number(self.frames.first())) / self.rate
    }

    /// Length of one round, in which the last frame is shown as long as the others. Unit: s.
    pub fn duration(&self) -> f64 {
        self.end() + 1.0 / self.rate
    }

    /// `beside` is the file that the settings come from.
    pub(super) async fn find(
        server: &AssetServer,
        settings: &RecordingSettings,
        beside: Option<&AssetPath<'_>>,
    ) -> Result<Self, RecordingError> {
        let pattern = FramePattern::parse(&settings.frames)?;
        let positive = |field, value: f64, is_good| {
            let pattern = settings.frames.clone();
            if is_good {
                Ok(())
            } else {
                Err(RecordingError::Value {
                    pattern,
                    field,
                    value,
                })
            }
        };
        let (rate, radius) = (settings.rate, settings.radius);
        positive("rate", rate, rate > 0.0 && rate.is_finite())?;
        positive(
            "radius",
            radius.unwrap_or(0.0).into(),
            radius.is_none_or(is_radius),
        )?;
        let folder = folder(pattern.folder(), beside);
        let frames = numbered(server, settings, &pattern, &folder).await?;
        let frame = |(number, name): (u32, String)| RecordedFrame {
            number,
            path: AssetPath::from_path_buf(folder.path().join(name))
                .with_source(folder.source().clone_owned()),
        };
        Ok(Self {
            frames: frames.into_iter().map(frame).collect(),
            rate,
            radius,
        })
    }
}

/// `#` would be a label to [`AssetPath::parse`].
fn folder(folder: &str, beside: Option<&AssetPath>) -> AssetPath<'static> {
    if let Some((source, path)) = folder.split_once("://") {
        let source = AssetSourceId::from(source.to_owned());
        return AssetPath::from_path_buf(path.into()).with_source(source);
    }
    let Some(parent) = beside.and_then(AssetPath::parent) else {
        return AssetPath::from_path_buf(folder.into());
    };
    // An absolute folder takes the place of the file's.
    let path = parent.path().join(folder);
    AssetPath::from_path_buf(path).with_source(parent.source().clone_owned())
}

/// Numbers and names, by number.
async fn numbered(
    server: &AssetServer,
    settings: &RecordingSettings,
    pattern: &FramePattern,
    folder: &AssetPath<'_>,
) -> Result<Vec<(u32, String)>, RecordingError> {
    let (first, last) = (
        settings.first.unwrap_or(0),
        settings.last.unwrap_or(u32::MAX),
    );
    if !pattern.is_numbered() {
        return Ok(vec![(0, pattern.file_name(0))]);
    }
    let mut frames: Vec<_> = if settings.first.is_some() && settings.last.is_some() {
        if last.saturating_sub(first) >= MOST_FRAMES {
            return Err(RecordingError::TooManyFrames {
                pattern: settings.frames.clone(),
                most: MOST_FRAMES,
            });
        }
        let named = |number| (number, pattern.file_name(number));
        (first..=last).map(named).collect()
    } else {
        let names = files::list(server, folder).await;
        let names = names.map_err(|reason| RecordingError::Folder {
            folder: folder.to_string(),
            pattern: settings.frames.clone(),
            reason,
        })?;
        let numbered = |name: String| Some((pattern.number(&name)?, name));
        let frames = names.into_iter().filter_map(numbered);
        frames
            .filter(|(number, _)| (first..=last).contains(number))
            .collect()
    };
    frames.sort_unstable();
    // `frame_9` and `frame_09` are the same moment.
    frames.dedup_by_key(|(number, _)| *number);
    if frames.is_empty() {
        let pattern = settings.frames.clone();
        return Err(RecordingError::NoFrames {
            pattern,
            first,
            last,
        });
    }
    Ok(frames)
}
