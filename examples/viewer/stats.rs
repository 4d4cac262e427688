//! Counts and times as JSON.

use std::{path::Path, time::Duration};

use anyhow::{Context, anyhow};
use bevy::{diagnostic::DiagnosticsStore, prelude::*, render::RenderApp};
use bevy_fluid::{
    particles::ShapedFluid, prelude::FluidParticles, render::Layers, shape::ShapeTimes,
};
use fluid_stage::{Stage, adapter_name, median_gpu_ms, read_texture};
use serde::Serialize;

#[derive(Serialize)]
struct Stats {
    particles: usize,
    dropped: u32,
    bulk: u32,
    interior: u32,
    spray: u32,
    width: u32,
    height: u32,
    fluid_pixels: usize,
    adapter: String,
    cpu_ms: CpuTimes,
    gpu_ms: GpuTimes,
}

#[derive(Serialize)]
struct CpuTimes {
    shape: f64,
    grid: f64,
    classify: f64,
    anisotropy: f64,
}

/// Medians over the frames; null where the adapter has no timestamps.
#[derive(Serialize)]
struct GpuTimes {
    splat: Option<f64>,
    smooth: Option<f64>,
    normals: Option<f64>,
    refract: Option<f64>,
    composite: Option<f64>,
}

/// Fails now rather than after rendering.
pub(crate) fn check_writable(path: &Path) -> anyhow::Result<&Path> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let usable = folder.is_dir() && !path.is_dir() && path.file_name().is_some();
    usable
        .then_some(path)
        .ok_or_else(|| anyhow!("cannot write {}: no such folder", path.display()))
}

/// Steps `frames` frames. If `measure` is set, the particles count as changed in every frame, so
/// that they are shaped in each, and earlier times are discarded.
pub(crate) fn step(app: &mut App, frames: u32, measure: bool) -> Vec<ShapeTimes> {
    if !measure {
        fluid_stage::step(app, frames);
        return Vec::new();
    }
    for diagnostic in app
        .world_mut()
        .resource_mut::<DiagnosticsStore>()
        .iter_mut()
    {
        diagnostic.clear_history();
    }
    let mut fluids = app
        .world_mut()
        .query::<(&mut FluidParticles, &ShapedFluid)>();
    let mut times = Vec::new();
    for _ in 0..frames {
        for (mut particles, _) in fluids.iter_mut(app.world_mut()) {
            particles.set_changed();
        }
        fluid_stage::step(app, 1);
        times.extend(fluids.iter(app.world()).map(|(_, shaped)| shaped.times()));
    }
    times
}

/// In milliseconds.
fn median(times: &[ShapeTimes], part: fn(&ShapeTimes) -> Duration) -> f64 {
    let mut parts: Vec<_> = times.iter().map(part).collect();
    parts.sort_unstable();
    parts
        .get(parts.len() / 2)
        .map_or(0.0, |time| 1e3 * time.as_secs_f64())
}

pub(crate) fn gather(app: &App, times: &[ShapeTimes]) -> anyhow::Result<String> {
    let (particles, shaped) = app
        .world()
        .iter_entities()
        .find_map(|e| Some((e.get::<FluidParticles>()?, e.get::<ShapedFluid>()?)))
        .context("there is no fluid")?;
    let gpu = |pass: &str| median_gpu_ms(app, &format!("render/fluid_{pass}/elapsed_gpu"));
    let size = app.world().resource::<Stage>().size;
    let stats = Stats {
        particles: particles.positions.len(),
        dropped: shaped.dropped(),
        bulk: shaped.bulk(),
        interior: shaped.interior(),
        spray: shaped.spray(),
        width: size.x,
        height: size.y,
        fluid_pixels: fluid_pixels(app)?,
        adapter: adapter_name(app),
        cpu_ms: CpuTimes {
            shape: median(times, |times| times.total),
            grid: median(times, |times| times.grid),
            classify: median(times, |times| times.classify),
            anisotropy: median(times, |times| times.anisotropy),
        },
        gpu_ms: GpuTimes {
            splat: gpu("splat"),
            smooth: gpu("smooth"),
            normals: gpu("normals"),
            refract: gpu("refract"),
            composite: gpu("composite"),
        },
    };
    Ok(serde_json::to_string_pretty(&stats)? + "\n")
}

/// Number of pixels that show liquid: those whose exit flags contain a path.
fn fluid_pixels(app: &App) -> anyhow::Result<usize> {
    let render = app.sub_app(RenderApp).world();
    let surfaces = render
        .iter_entities()
        .filter_map(|it| it.get::<Layers>()?.exits());
    let mut count = 0;
    for exits in surfaces {
        let exits = read_texture(app, exits)?;
        count += exits
            .texels::<[u32; 4]>()
            .filter(|[_, _, _, flags]| flags >> 31 == 1)
            .count();
    }
    Ok(count)
}
