//! Where frames come from: any of Bevy's asset sources, or the file system.

use std::{fs, path::Path};

use bevy::{
    asset::{
        AssetPath, AssetServer, AssetServerMode,
        io::{AssetSourceId, ErasedAssetReader},
    },
    tasks::futures_lite::StreamExt,
};

/// Absolute paths are the file system's; an asset source would refuse to list their folders.
fn is_on_disk(path: &AssetPath) -> bool {
    matches!(path.source(), AssetSourceId::Default) && path.path().is_absolute()
}

fn reader<'a>(
    server: &'a AssetServer,
    path: &AssetPath,
) -> Result<&'a dyn ErasedAssetReader, String> {
    let source = server
        .get_source(path.source().clone_owned())
        .map_err(|error| error.to_string())?;
    Ok(match server.mode() {
        AssetServerMode::Unprocessed => source.reader(),
        AssetServerMode::Processed => source.processed_reader().unwrap_or(source.reader()),
    })
}

pub(super) async fn read(server: &AssetServer, path: &AssetPath<'_>) -> Result<Vec<u8>, String> {
    if is_on_disk(path) {
        return fs::read(path.path()).map_err(|error| error.to_string());
    }
    let mut bytes = Vec::new();
    let mut file = reader(server, path)?
        .read(path.path())
        .await
        .map_err(|error| error.to_string())?;
    file.read_to_end(&mut bytes)
        .await
        .map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// The names of the files in a folder, in no order.
pub(super) async fn list(
    server: &AssetServer,
    folder: &AssetPath<'_>,
) -> Result<Vec<String>, String> {
    let name = |path: &Path| Some(path.file_name()?.to_str()?.to_owned());
    if is_on_disk(folder) {
        let entries = fs::read_dir(folder.path()).map_err(|error| error.to_string())?;
        return Ok(entries
            .filter_map(|entry| name(&entry.ok()?.path()))
            .collect());
    }
    let mut entries = reader(server, folder)?
        .read_directory(folder.path())
        .await
        .map_err(|error| error.to_string())?;
    let mut names = Vec::new();
    while let Some(path) = entries.next().await {
        names.extend(name(&path));
    }
    Ok(names)
}
