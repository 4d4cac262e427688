//! Rendering frame by frame without a window, for tests and benches.

use std::{
    mem,
    time::{Duration, Instant},
};

use bevy::{
    app::{PluginGroupBuilder, PluginsState},
    prelude::*,
    render::{
        RenderApp,
        render_asset::RenderAssets,
        render_resource::PollType,
        renderer::{RenderAdapterInfo, RenderDevice},
        settings::WgpuSettings,
        texture::GpuImage,
    },
    time::TimeUpdateStrategy,
};
use image::RgbaImage;

use crate::{
    StageError,
    pipelines::{failed_pipelines, waiting_pipelines},
    plugins, read_texture,
    stage::{GpuErrors, Stage, extent, is_valid_size},
};

/// Frames without a waiting pipeline before the stage counts as settled: pipelines of entities
/// extracted in one frame are requested in the next.
const QUIET_FRAMES: u32 = 2;
/// How long the same pipelines may wait before they count as stuck.
const PATIENCE: Duration = Duration::from_secs(60);

/// An app without a window, ready for [`settle`] and [`step`]; `configure` adds its contents.
///
/// Its clock is stopped until [`set_time_step`].
pub fn headless_app(size: UVec2, configure: impl FnOnce(&mut App)) -> Result<App, StageError> {
    headless_app_with(size, WgpuSettings::default(), configure)
}

/// The same as [`headless_app`], on a device that is not Bevy's default: with fewer features, or
/// tighter limits.
pub fn headless_app_with(
    size: UVec2,
    settings: WgpuSettings,
    configure: impl FnOnce(&mut App),
) -> Result<App, StageError> {
    app_of(plugins::headless(size, settings, true)?, configure)
}

/// The same as [`headless_app`], but pipelines are compiled in the background, as in a game.
pub fn headless_app_in_background(
    size: UVec2,
    configure: impl FnOnce(&mut App),
) -> Result<App, StageError> {
    let settings = WgpuSettings::default();
    app_of(plugins::headless(size, settings, false)?, configure)
}

fn app_of(
    plugins: PluginGroupBuilder,
    configure: impl FnOnce(&mut App),
) -> Result<App, StageError> {
    let mut app = App::new();
    app.add_plugins(plugins);
    configure(&mut app);
    finish(&mut app);
    Ok(app)
}

pub(crate) fn finish(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    app.finish();
    app.cleanup();
}

/// Renders with the clock stopped until every pipeline is compiled.
///
/// Systems run in these frames too, but time does not pass: motion driven by `Time` stops.
pub fn settle(app: &mut App) -> Result<(), StageError> {
    let clock = swap_clock(app, TimeUpdateStrategy::ManualDuration(Duration::ZERO));
    let settled = wait_for_pipelines(app);
    swap_clock(app, clock);
    settled.and_then(|()| check(app))
}

fn swap_clock(app: &mut App, clock: TimeUpdateStrategy) -> TimeUpdateStrategy {
    mem::replace(
        &mut *app.world_mut().resource_mut::<TimeUpdateStrategy>(),
        clock,
    )
}

fn wait_for_pipelines(app: &mut App) -> Result<(), StageError> {
    let mut quiet = 0;
    let mut last_progress = Instant::now();
    let mut waiting = Vec::new();
    // The first frame has nothing extracted yet: it does not count.
    update(app);
    while quiet < QUIET_FRAMES {
        update(app);
        let were_waiting = mem::replace(&mut waiting, waiting_pipelines(app));
        quiet = if waiting.is_empty() { quiet + 1 } else { 0 };
        if waiting.is_empty() || waiting != were_waiting {
            last_progress = Instant::now();
        } else if last_progress.elapsed() > PATIENCE {
            return Err(StageError::Unsettled {
                seconds: PATIENCE.as_secs(),
                waiting,
            });
        }
    }
    Ok(())
}

/// Steps `frames` frames, each as long as set by [`set_time_step`], and waits for the GPU after
/// each: the CPU must not run ahead by a hundred frames' worth of buffers.
pub fn step(app: &mut App, frames: u32) {
    for _ in 0..frames {
        update(app);
    }
}

fn update(app: &mut App) {
    app.update();
    if let Some(device) = app.world().get_resource::<RenderDevice>() {
        // A lost device has already been reported through its callback.
        let _ = device.poll(PollType::wait_indefinitely());
    }
}

/// Sets how far the clock moves in each frame from now on.
pub fn set_time_step(app: &mut App, time_step: Duration) {
    swap_clock(app, TimeUpdateStrategy::ManualDuration(time_step));
}

/// The stage's picture after the last frame.
///
/// Fails if a pipeline did not compile or the GPU's validation has reported an error, since such a
/// picture cannot be trusted.
pub fn capture(app: &mut App) -> Result<RgbaImage, StageError> {
    check(app)?;
    let stage = app.world().resource::<Stage>();
    let texture = app
        .get_sub_app(RenderApp)
        .and_then(|render| render.world().get_resource::<RenderAssets<GpuImage>>())
        .and_then(|images| images.get(&stage.image))
        .map(|image| image.texture.clone())
        .ok_or(StageError::NotRendered)?;
    let data = read_texture(app, &texture)?;
    RgbaImage::from_raw(data.size.x, data.size.y, data.bytes).ok_or(StageError::NotRendered)
}

/// Changes the size of the stage's picture, from the next frame on.
pub fn resize(app: &mut App, size: UVec2) -> Result<(), StageError> {
    if !is_valid_size(size) {
        return Err(StageError::Size(size));
    }
    let world = app.world_mut();
    let mut stage = world.resource_mut::<Stage>();
    stage.size = size;
    let id = stage.image.id();
    if let Some(mut image) = world.resource_mut::<Assets<Image>>().get_mut(id) {
        image.texture_descriptor.size = extent(size);
    }
    // Bevy updates its cameras a frame after the texture has changed; for that frame they would
    // render at the old size.
    world.write_message(AssetEvent::Modified { id });
    Ok(())
}

/// The name of the adapter that renders.
pub fn adapter_name(app: &App) -> String {
    app.world()
        .get_resource::<RenderAdapterInfo>()
        .map_or_else(String::new, |info| info.name.clone())
}

/// All errors that the GPU's validation has reported since the app was built, oldest first.
pub fn validation_errors(app: &App) -> Vec<String> {
    app.world()
        .get_resource::<GpuErrors>()
        .map_or_else(Vec::new, GpuErrors::all)
}

fn check(app: &App) -> Result<(), StageError> {
    let failed = failed_pipelines(app);
    if !failed.is_empty() {
        return Err(StageError::Pipelines(failed));
    }
    let errors = validation_errors(app);
    if !errors.is_empty() {
        return Err(StageError::Validation(errors));
    }
    Ok(())
}
