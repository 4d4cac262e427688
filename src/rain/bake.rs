//! Bakes the textures of streaks for the current settings, without holding up a frame.

use std::sync::{
    Arc,
    atomic::{AtomicU32, Ordering},
};

use bevy::{
    asset::RenderAssetUsages,
    diagnostic::{DiagnosticPath, Diagnostics},
    image::{ImageAddressMode, ImageFilterMode, ImageSampler, ImageSamplerDescriptor},
    platform::time::Instant,
    prelude::*,
    render::render_resource::{
        Extent3d, TextureDimension, TextureFormat, TextureViewDescriptor, TextureViewDimension,
    },
    tasks::{AsyncComputeTaskPool, Task, block_on, futures::check_ready},
};

use super::{
    densities::DENSITIES,
    drops::mean_speed,
    settings::{LONGEST_FRAME, Rain, RainStreakSettings},
    streaks::{HEIGHT, MIP_LEVELS, STEPS, StreakInput, Streaks, VARIANTS, WIDTH, bake},
};
use crate::{clock::now, settings::Checked};

/// Progress of drawing the textures, 0 to 1.
pub const BAKE_PROGRESS: DiagnosticPath = DiagnosticPath::const_new("rain/bake_progress");
/// Time taken to draw all textures. Unit: ms.
pub const BAKE_TIME: DiagnosticPath = DiagnosticPath::const_new("rain/bake_time");

/// Whether the app waits for the textures.
#[derive(Resource, Clone, Copy)]
pub(crate) struct SynchronousBake(pub(crate) bool);

/// How many devices have been lost so far, and all textures with them. Shared by both worlds.
#[derive(Resource, Clone, Default)]
pub(crate) struct LostDevices(Arc<AtomicU32>);

impl LostDevices {
    pub(crate) fn add(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn count(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

/// The current textures of streaks and those being drawn.
#[derive(Resource, Default)]
pub struct BakedStreaks {
    ready: Option<ReadyStreaks>,
    running: Option<RunningBake>,
    /// Devices lost before the current textures were drawn.
    lost_devices: u32,
    /// Smoothed length of a frame. Unit: s.
    frame: Option<f32>,
}

/// Textures of streaks, and how to read them.
#[derive(Clone, Debug)]
pub(crate) struct ReadyStreaks {
    pub(crate) image: Handle<Image>,
    pub(crate) input: StreakInput,
    /// See [`Streaks`].
    pub(crate) scale: f32,
    pub(crate) extinction: [f64; DENSITIES],
    /// Common speed at which the drops of the textures fall. Unit: m/s.
    pub(crate) speed: f64,
}

struct RunningBake {
    input: StreakInput,
    done: Arc<AtomicU32>,
    start: Instant,
    task: Task<Streaks>,
}

impl BakedStreaks {
    /// Whether textures are ready and no others are being drawn.
    pub fn is_settled(&self) -> bool {
        self.ready.is_some() && self.running.is_none()
    }

    /// The exposure of the current textures. Unit: s.
    pub fn exposure(&self) -> Option<f32> {
        Some(self.ready.as_ref()?.input.exposure)
    }

    pub(crate) fn ready(&self) -> Option<&ReadyStreaks> {
        self.ready.as_ref()
    }
}

pub(crate) fn bake_streaks(
    rains: Query<&Checked<Rain>>,
    settings: Single<&Checked<RainStreakSettings>>,
    synchronous: Res<SynchronousBake>,
    lost_devices: Res<LostDevices>,
    time: Res<Time>,
    mut streaks: ResMut<BakedStreaks>,
    mut images: ResMut<Assets<Image>>,
    mut diagnostics: Diagnostics,
) {
    // Without rain there are no textures; while the rate is 0, they are left as they are.
    let lost_devices = lost_devices.count();
    if rains.is_empty() || streaks.lost_devices != lost_devices {
        streaks.ready = None;
        streaks.lost_devices = lost_devices;
    }
    let is_raining = rains.iter().any(|rain| rain.rate > 0.0);
    if !is_raining && streaks.running.is_none() {
        return;
    }
    // A longer frame does not predict the length of the next one.
    let delta = time.delta_secs().min(LONGEST_FRAME);
    if delta > 0.0 {
        let frame = streaks.frame.unwrap_or(delta);
        streaks.frame = Some(frame + 0.1 * (delta - frame));
    }
    if streaks.running.is_none() {
        let ready = streaks.ready.as_ref().map(|ready| ready.input);
        let current = ready.map(|input| input.exposure);
        let wanted = StreakInput {
            exposure: settings.exposure.seconds(streaks.frame, current),
            law: settings.law,
            seed: settings.seed,
        };
        if ready == Some(wanted) {
            return;
        }
        streaks.running = Some(start(wanted));
    }
    let Some(mut running) = streaks.running.take() else {
        return;
    };
    let finished = if synchronous.0 {
        Some(block_on(&mut running.task))
    } else {
        check_ready(&mut running.task)
    };
    let done = running.done.load(Ordering::Relaxed) as f64 / f64::from(STEPS);
    diagnostics.add_measurement(&BAKE_PROGRESS, || done);
    let Some(baked) = finished else {
        streaks.running = Some(running);
        return;
    };
    diagnostics.add_measurement(&BAKE_TIME, || running.start.elapsed().as_secs_f64() * 1e3);
    streaks.ready = Some(ReadyStreaks {
        image: images.add(image(baked.texels)),
        input: running.input,
        scale: baked.scale,
        extinction: baked.extinction,
        speed: mean_speed(running.input.law),
    });
}

fn start(input: StreakInput) -> RunningBake {
    let done = Arc::new(AtomicU32::new(0));
    let counter = done.clone();
    let task = AsyncComputeTaskPool::get().spawn(async move {
        // Threads of its own: on the common ones a frame's work would queue behind this.
        match rayon::ThreadPoolBuilder::new()
            .thread_name(|i| format!("rain streaks {i}"))
            .build()
        {
            Ok(pool) => pool.install(|| bake(&input, &counter)),
            Err(_) => bake(&input, &counter),
        }
    });
    RunningBake {
        input,
        done,
        start: now(),
        task,
    }
}

fn image(texels: Vec<u8>) -> Image {
    let mut image = Image::new_uninit(
        Extent3d {
            width: WIDTH as u32,
            height: HEIGHT as u32,
            depth_or_array_layers: VARIANTS as u32,
        },
        TextureDimension::D2,
        TextureFormat::Rgba8Unorm,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.label = Some("rain_streaks");
    image.texture_descriptor.mip_level_count = MIP_LEVELS;
    image.data = Some(texels);
    image.texture_view_descriptor = Some(TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..default()
    });
    image.sampler = ImageSampler::Descriptor(ImageSamplerDescriptor {
        address_mode_u: ImageAddressMode::Repeat,
        address_mode_v: ImageAddressMode::Repeat,
        mag_filter: ImageFilterMode::Linear,
        min_filter: ImageFilterMode::Linear,
        // A level's voxels are all about as far away: one mip level is enough, for half the cost.
        mipmap_filter: ImageFilterMode::Nearest,
        ..default()
    });
    image
}
