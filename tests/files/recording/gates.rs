//! An asset source whose files open when they are told to.

use std::{
    collections::HashSet,
    future::poll_fn,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    task::{Poll, Waker},
};

use bevy::asset::io::{
    AssetReader, AssetReaderError, PathStream, Reader,
    memory::{Dir, MemoryAssetReader},
};

/// Which files are open.
#[derive(Clone, Default)]
pub(crate) struct Gates(Arc<Mutex<(HashSet<PathBuf>, Vec<Waker>)>>);

impl Gates {
    pub(crate) fn open(&self, path: &str) {
        let mut gates = self.0.lock().unwrap();
        gates.0.insert(path.into());
        gates.1.drain(..).for_each(Waker::wake);
    }

    async fn wait(&self, path: &Path) {
        poll_fn(|context| {
            let mut gates = self.0.lock().unwrap();
            if gates.0.contains(path) {
                return Poll::Ready(());
            }
            gates.1.push(context.waker().clone());
            Poll::Pending
        })
        .await;
    }
}

#[derive(Clone)]
pub(crate) struct GatedReader {
    pub(crate) gates: Gates,
    pub(crate) files: Dir,
}

impl GatedReader {
    fn memory(&self) -> MemoryAssetReader {
        MemoryAssetReader {
            root: self.files.clone(),
        }
    }
}

impl AssetReader for GatedReader {
    async fn read<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        self.gates.wait(path).await;
        let data = self.files.get_asset(path);
        let data = data.ok_or_else(|| AssetReaderError::NotFound(path.into()))?;
        Ok(bevy::asset::io::VecReader::new(data.value().to_vec()))
    }

    async fn read_meta<'a>(&'a self, path: &'a Path) -> Result<impl Reader + 'a, AssetReaderError> {
        Err::<bevy::asset::io::VecReader, _>(AssetReaderError::NotFound(path.into()))
    }

    async fn read_directory<'a>(
        &'a self,
        path: &'a Path,
    ) -> Result<Box<PathStream>, AssetReaderError> {
        self.memory().read_directory(path).await
    }

    async fn is_directory<'a>(&'a self, path: &'a Path) -> Result<bool, AssetReaderError> {
        self.memory().is_directory(path).await
    }
}
