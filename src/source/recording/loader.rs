//! Asset loaders: one frame, or the description of a recording.

use std::sync::{Arc, Weak};

use bevy::{
    asset::{AssetLoader, AssetServer, LoadContext, io::Reader},
    prelude::*,
};
use ron::extensions::Extensions;

use super::{
    asset::{FluidRecording, RecordingSettings},
    error::RecordingError,
    frame::{FrameError, ParticleFrame},
};

/// Loads a [`ParticleFrame`] from a file of any [`ParticleFormat`](super::ParticleFormat).
#[derive(Clone, Copy, Debug, Default, TypePath)]
pub struct ParticleFrameLoader;

impl AssetLoader for ParticleFrameLoader {
    type Asset = ParticleFrame;
    type Settings = ();
    type Error = FrameError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &Self::Settings,
        context: &mut LoadContext<'_>,
    ) -> Result<ParticleFrame, FrameError> {
        let name = context.path().to_string();
        let mut bytes = Vec::new();
        let read = reader.read_to_end(&mut bytes).await;
        match read {
            Ok(_) => ParticleFrame::parse(&name, &bytes),
            Err(error) => Err(FrameError::Read {
                name,
                reason: error.to_string(),
            }),
        }
    }

    fn extensions(&self) -> &[&str] {
        &[
            "vtk",
            "bgeo",
            "bhclassic",
            "ply",
            "xyz",
            "vtk.gz",
            "bgeo.gz",
            "bhclassic.gz",
            "ply.gz",
            "xyz.gz",
        ]
    }
}

/// Loads a [`FluidRecording`] from a `.fluid.ron` file: see [`RecordingSettings`].
#[derive(Clone, TypePath)]
pub struct FluidRecordingLoader {
    /// To list the frames' folder, which the loader's context cannot. The server owns its loaders:
    /// if they owned it in turn, it would outlive its app.
    server: Weak<AssetServer>,
}

/// Keeps the loader's server alive as long as the world.
#[derive(Resource)]
struct KeptServer(Arc<AssetServer>);

impl FromWorld for FluidRecordingLoader {
    fn from_world(world: &mut World) -> Self {
        let server = world.resource::<AssetServer>().clone();
        let kept = world.get_resource_or_insert_with(|| KeptServer(Arc::new(server)));
        Self {
            server: Arc::downgrade(&kept.0),
        }
    }
}

impl AssetLoader for FluidRecordingLoader {
    type Asset = FluidRecording;
    type Settings = ();
    type Error = RecordingError;

    async fn load(
        &self,
        reader: &mut dyn Reader,
        _: &Self::Settings,
        context: &mut LoadContext<'_>,
    ) -> Result<FluidRecording, RecordingError> {
        let path = context.path().clone_owned();
        let refuse = |reason: String| RecordingError::Description {
            name: path.to_string(),
            reason,
        };
        let mut bytes = Vec::new();
        let read = reader.read_to_end(&mut bytes).await;
        read.map_err(|error| refuse(error.to_string()))?;
        let settings: RecordingSettings = ron::Options::default()
            .with_default_extension(Extensions::IMPLICIT_SOME)
            .from_bytes(&bytes)
            .map_err(|error| refuse(error.to_string()))?;
        let server = self.server.upgrade();
        let server = server.ok_or_else(|| refuse("its app has ended".into()))?;
        FluidRecording::find(&server, &settings, Some(&path)).await
    }

    fn extensions(&self) -> &[&str] {
        &["fluid.ron"]
    }
}
