//! Particles from a file: our own reader of `.bgeo`, splashsurf's for the rest, with a look at what
//! the file claims before a reader believes it.

use std::{
    fs,
    io::{BufRead, BufReader, Read},
    panic::{self, AssertUnwindSafe},
    path::Path,
};

use anyhow::{anyhow, bail, ensure};
use bevy::prelude::*;

#[path = "bgeo.rs"]
mod bgeo;

/// Longer headers of `.ply` files are none.
const MAX_HEADER: u64 = 1 << 16;

/// Reads the particles of a file; an error names the file and what is wrong with it. Memory and time
/// are bounded by the bytes that are there.
pub(crate) fn read(path: &Path) -> anyhow::Result<Vec<Vec3>> {
    let name = path.display();
    let bytes = fs::metadata(path)
        .map_err(|error| anyhow!("cannot read {name}: {error}"))?
        .len();
    ensure!(bytes > 0, "{name} is empty");
    let damaged = |error: anyhow::Error| anyhow!("{name} is damaged: {}", first_line(&error));
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let points = match extension.to_lowercase().as_str() {
        "bgeo" => bgeo::read(&fs::read(path)?),
        "ply" => check_ply(path, bytes).and_then(|()| read_by_splashsurf(path)),
        "vtk" => read_by_splashsurf(path),
        "xyz" => {
            ensure!(
                bytes % 12 == 0,
                "{name} is not a list of binary f32 triples: its {bytes} bytes are no multiple of 12"
            );
            read_by_splashsurf(path)
        }
        _ => bail!("{name} has no known particle format: .vtk, .bgeo, .ply or .xyz is expected"),
    }
    .map_err(damaged)?;
    ensure!(!points.is_empty(), "{name} holds no particles");
    Ok(points)
}

/// Refuses headers that claim more elements than there are bytes, or elements of nothing, of which
/// any number fits into any file: the reader would believe both.
fn check_ply(path: &Path, bytes: u64) -> anyhow::Result<()> {
    let mut header = BufReader::new(fs::File::open(path)?.take(MAX_HEADER));
    let mut line = Vec::new();
    let mut of_nothing = None;
    loop {
        line.clear();
        ensure!(
            header.read_until(b'\n', &mut line)? > 0,
            "its header does not end"
        );
        let text = String::from_utf8_lossy(&line);
        let mut words = text.split_whitespace();
        match words.next() {
            Some("property") => of_nothing = None,
            Some(word @ ("element" | "end_header")) => {
                if let Some(element) = of_nothing.take() {
                    bail!("its element `{element}` has no properties");
                }
                if word == "end_header" {
                    return Ok(());
                }
                let element = words.next().unwrap_or_default().to_owned();
                let count = words.next().unwrap_or_default();
                let count: u64 = count
                    .parse()
                    .map_err(|_| anyhow!("its number of `{element}` is `{count}`"))?;
                ensure!(
                    count <= bytes,
                    "it claims {count} of `{element}` in {bytes} bytes"
                );
                of_nothing = Some(element);
            }
            _ => {}
        }
    }
}

fn read_by_splashsurf(path: &Path) -> anyhow::Result<Vec<Vec3>> {
    let points = quietly(|| splashsurf_lib::io::particles_from_file::<f32, _>(path))
        .ok_or_else(|| anyhow!("it breaks its format's rules"))??;
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
