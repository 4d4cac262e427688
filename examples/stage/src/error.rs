//! Errors of the stage, each in one line that names the cause.

use std::{io, path::PathBuf};

use bevy::math::UVec2;
use bevy::render::render_resource::TextureFormat;
use thiserror::Error;

use crate::stage::MAX_SIDE;

/// Why there is no picture.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StageError {
    /// Nothing on this machine can render, not even in software.
    #[error(
        "no Vulkan, Metal or DX12 adapter: on Debian install one with \
         `apt-get install mesa-vulkan-drivers` (or run scripts/setup)"
    )]
    NoAdapter,
    /// A window was requested, but none can be opened.
    #[error(
        "no display to open a window on (neither DISPLAY nor WAYLAND_DISPLAY is set): \
         render a picture instead with `--out FILE.png`"
    )]
    NoDisplay,
    /// A side of the picture is 0 or larger than textures may be.
    #[error("picture size {}x{}: each side must be between 1 and {MAX_SIDE}", .0.x, .0.y)]
    Size(UVec2),
    /// Shaders or pipelines that do not compile.
    #[error("pipelines failed to compile:\n{}", .0.join("\n"))]
    Pipelines(Vec<String>),
    /// Pipelines that neither compiled nor failed, because a shader or one of its imports is
    /// missing.
    #[error("pipelines still waiting after {seconds} s (is a shader or an import missing?):\n{}", .waiting.join("\n"))]
    Unsettled {
        /// Time without a change.
        seconds: u64,
        /// The waiting pipelines, and what they wait for.
        waiting: Vec<String>,
    },
    /// Errors that wgpu's validation reported since the app was built.
    #[error("the GPU refused:\n{}", .0.join("\n"))]
    Validation(Vec<String>),
    /// The stage's picture is not on the GPU: no frame has been rendered yet.
    #[error("nothing has been rendered yet")]
    NotRendered,
    /// A texture that cannot be copied: no `COPY_SRC`, multisampled, compressed or with several
    /// aspects.
    #[error("cannot read back a {format:?} texture with {samples} samples: {reason}")]
    Unreadable {
        /// Its format.
        format: TextureFormat,
        /// Its sample count.
        samples: u32,
        /// The reason.
        reason: &'static str,
    },
    /// A buffer without `COPY_SRC`.
    #[error("cannot read back a buffer without COPY_SRC (its usages: {0})")]
    UnreadableBuffer(String),
    /// The GPU did not return the copied data.
    #[error("the GPU did not return the data: {0}")]
    Map(String),
    /// The picture's file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: io::Error,
    },
}

impl StageError {
    /// The exit code of a program that ends with this error: 2 where the request or the machine is
    /// at fault, 1 where the program is.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Pipelines(_)
            | Self::Unsettled { .. }
            | Self::Validation(_)
            | Self::NotRendered
            | Self::Unreadable { .. }
            | Self::UnreadableBuffer(_)
            | Self::Map(_) => 1,
            Self::NoAdapter | Self::NoDisplay | Self::Size(_) | Self::Write { .. } => 2,
        }
    }
}
