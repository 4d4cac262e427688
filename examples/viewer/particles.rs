//! Particles from a file, through splashsurf's readers.

use std::{
    panic::{self, AssertUnwindSafe},
    path::Path,
};

use anyhow::{anyhow, bail, ensure};
use bevy::prelude::*;

/// Reads the particles of a file; an error names the file and what is wrong with it.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Vec3>> {
    let name = path.display();
    let bytes = std::fs::metadata(path)
        .map_err(|error| anyhow!("cannot read {name}: {error}"))?
        .len();
    ensure!(bytes > 0, "{name} is empty");
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    match extension.to_lowercase().as_str() {
        "vtk" | "bgeo" | "ply" => {}
        "xyz" => ensure!(
            bytes % 12 == 0,
            "{name} is not a list of binary f32 triples: its {bytes} bytes are no multiple of 12"
        ),
        _ => bail!("{name} has no known particle format: .vtk, .bgeo, .ply or .xyz is expected"),
    }
    let points = quietly(|| splashsurf_lib::io::particles_from_file::<f32, _>(path))
        .ok_or_else(|| anyhow!("{name} is damaged"))?
        .map_err(|error| anyhow!("{name} is damaged: {}", first_line(&error)))?;
    ensure!(!points.is_empty(), "{name} holds no particles");
    Ok(points.iter().map(|p| vec3(p.x, p.y, p.z)).collect())
}

/// Some readers go on about where they were.
fn first_line(error: &anyhow::Error) -> String {
    let cause = error.root_cause().to_string();
    cause.lines().next().unwrap_or_default().to_owned()
}

/// The readers check some of their assumptions by panicking; that is an answer too.
fn quietly<T>(read: impl FnOnce() -> T) -> Option<T> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let result = panic::catch_unwind(AssertUnwindSafe(read)).ok();
    panic::set_hook(hook);
    result
}
