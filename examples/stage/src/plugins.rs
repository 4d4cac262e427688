//! `DefaultPlugins` for a window, or the same plugins without one.

use std::{path::PathBuf, time::Duration};

use bevy::{
    app::{PluginGroupBuilder, TerminalCtrlCHandlerPlugin},
    log::LogPlugin,
    prelude::*,
    render::{
        RenderPlugin, diagnostic::RenderDiagnosticsPlugin,
        pipelined_rendering::PipelinedRenderingPlugin, settings::WgpuSettings,
    },
    time::TimeUpdateStrategy,
    window::ExitCondition,
    winit::WinitPlugin,
};
use bevy_panorbit_camera::PanOrbitCameraPlugin;

use crate::{
    StageError,
    adapter::require_adapter,
    log,
    picture::PicturePlugin,
    stage::{Stage, StagePlugin, is_valid_size},
};

/// Default size of windows and pictures, in pixels.
pub const VIEW_SIZE: UVec2 = UVec2::new(1280, 720);

/// Replaces `DefaultPlugins`: with a window or, if a picture is requested, without one.
///
/// Ends the program with one line on stderr and exit code 2 if nothing can be shown: no adapter, no
/// display, an invalid size. Without a window, `App::run` renders until every pipeline is compiled
/// (with the clock stopped), then steps `frames` frames of `time_step` each, writes the picture and
/// returns; pass its `AppExit` on from `main`.
#[derive(Debug, Clone, PartialEq)]
pub struct StagePlugins {
    /// Where to write the picture (PNG), or `None` for a window.
    pub out: Option<PathBuf>,
    /// Size of the window or picture in pixels. Default: [`VIEW_SIZE`].
    pub size: UVec2,
    /// Frames before the picture is taken; 0 shows the start. Default: 60. Unused in a window.
    pub frames: u32,
    /// Time step from frame to frame of a picture, however long rendering takes. Unit: time per
    /// frame. Default: 1/60 s. Unused in a window.
    pub time_step: Duration,
    /// Title of the window.
    pub title: String,
}

impl Default for StagePlugins {
    fn default() -> Self {
        Self {
            out: None,
            size: VIEW_SIZE,
            frames: 60,
            time_step: Duration::from_secs_f64(1.0 / 60.0),
            title: "bevy_fluid".into(),
        }
    }
}

impl PluginGroup for StagePlugins {
    fn build(self) -> PluginGroupBuilder {
        let wants_window = self.out.is_none();
        let group = match self.out.clone() {
            _ if wants_window && !Stage::has_display() => Err(StageError::NoDisplay),
            Some(out) => headless(self.size, WgpuSettings::default(), true).map(|group| {
                group.add(PicturePlugin {
                    out,
                    frames: self.frames,
                    time_step: self.time_step,
                })
            }),
            None => windowed(self.size, self.title),
        };
        group.unwrap_or_else(|error| {
            eprintln!("{error}");
            std::process::exit(error.exit_code().into())
        })
    }
}

fn check(size: UVec2) -> Result<(), StageError> {
    if !is_valid_size(size) {
        return Err(StageError::Size(size));
    }
    require_adapter()
}

fn windowed(size: UVec2, title: String) -> Result<PluginGroupBuilder, StageError> {
    check(size)?;
    let window = Window {
        title,
        resolution: size.into(),
        ..default()
    };
    Ok(DefaultPlugins
        .set(WindowPlugin {
            primary_window: Some(window),
            ..default()
        })
        .add(PanOrbitCameraPlugin))
}

/// The plugins of a stage without a window; its clock is stopped until a [`TimeUpdateStrategy`]
/// moves it.
pub(crate) fn headless(
    size: UVec2,
    settings: WgpuSettings,
    synchronous_pipeline_compilation: bool,
) -> Result<PluginGroupBuilder, StageError> {
    check(size)?;
    log::listen();
    Ok(DefaultPlugins
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..default()
        })
        .set(RenderPlugin {
            synchronous_pipeline_compilation,
            render_creation: settings.into(),
            ..default()
        })
        // The log belongs to the process, and tests build many apps in one.
        .disable::<LogPlugin>()
        .disable::<WinitPlugin>()
        // Pictures and measurements are of the frame just simulated, not of the one before it.
        .disable::<PipelinedRenderingPlugin>()
        // Without an event loop nothing handles it: the shell's own Ctrl-C ends the program at
        // once.
        .disable::<TerminalCtrlCHandlerPlugin>()
        .add(RenderDiagnosticsPlugin)
        .add(ClockPlugin)
        .add(StagePlugin { size }))
}

struct ClockPlugin;

impl Plugin for ClockPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    }
}
