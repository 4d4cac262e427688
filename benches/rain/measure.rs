//! Two apps with the same rain, drawn by either method.

use core::{fmt, sync::atomic::AtomicU32};
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use bevy::{
    camera::{Exposure as CameraExposure, Hdr, ScalingMode},
    core_pipeline::tonemapping::{DebandDither, Tonemapping},
    diagnostic::{DiagnosticPath, DiagnosticsStore},
    prelude::*,
    render::{RenderApp, view::ViewTarget},
};
use bevy_fluid::{
    prelude::*,
    rain::{
        DragLaw, Exposure, RainMethod, RainStreakSettings,
        drops::extinction,
        streaks::{StreakInput, bake},
    },
};
use fluid_stage::{adapter_name, headless_app, read_texture, set_time_step, settle, step};
use serde::Serialize;

/// The pass in which rain is drawn; nothing else is transparent here.
const PASS: &str = "render/main_transparent_pass_3d/elapsed_gpu";
/// At this setting a luminance of 1 cd/m² is a pixel of 1.
const UNIT_EXPOSURE: CameraExposure = CameraExposure {
    ev100: -0.263_034_4,
};
/// Pictures are compared by the means of blocks of this side, for single drops differ by chance.
const BLOCK: usize = 20;

#[derive(Clone, Copy)]
pub(crate) struct Case {
    /// mm/h.
    pub(crate) rate: f32,
    /// m.
    pub(crate) distance: f32,
    pub(crate) view: View,
}

/// How rain is looked at.
#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum View {
    Perspective,
    /// The same with four samples a pixel.
    Multisampled,
    /// Six metres high.
    Orthographic,
}

impl View {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Multisampled => "perspective, MSAA ×4",
            Self::Orthographic => "orthographic",
        }
    }

    fn bundle(self) -> impl Bundle {
        let projection = match self {
            Self::Orthographic => Projection::Orthographic(OrthographicProjection {
                near: 0.0,
                scaling_mode: ScalingMode::FixedVertical {
                    viewport_height: 6.0,
                },
                ..OrthographicProjection::default_3d()
            }),
            Self::Perspective | Self::Multisampled => Projection::default(),
        };
        let msaa = match self {
            Self::Multisampled => Msaa::Sample4,
            Self::Perspective | Self::Orthographic => Msaa::Off,
        };
        (projection, msaa)
    }
}

/// One line of the table.
#[derive(Serialize)]
pub(crate) struct Row {
    pub(crate) adapter: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rate: f32,
    pub(crate) distance: f32,
    pub(crate) view: View,
    /// Medians of the GPU's time for the pass, ms.
    pub(crate) streaks_ms: f64,
    pub(crate) drops_ms: f64,
    /// Medians of the whole frame, ms.
    pub(crate) streaks_frame_ms: f64,
    pub(crate) drops_frame_ms: f64,
    pub(crate) speedup: f64,
    /// −ln of the mean transmittance, over βL.
    pub(crate) streaks_depth: f64,
    pub(crate) drops_depth: f64,
    /// RMS difference of block means over the mean, both averaged over all frames.
    pub(crate) difference: f64,
    /// The same between every other frame of the truth and the rest: what chance makes of it.
    pub(crate) own_difference: f64,
    /// Variance of pixels over time, streaks over drops.
    pub(crate) variance: f64,
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}x{} {} mm/h {} m, {}: {:.2} / {:.2} ms = {:.1} x, depth {:.3} / {:.3}, difference {:.3} (own {:.3}), variance {:.2}",
            self.width,
            self.height,
            self.rate,
            self.distance,
            self.view.name(),
            self.streaks_ms,
            self.drops_ms,
            self.speedup,
            self.streaks_depth,
            self.drops_depth,
            self.difference,
            self.own_difference,
            self.variance,
        )
    }
}

/// Rain before black in light of 1 cd/m² from all around: a pixel is the rain's opacity.
struct Rainy {
    app: App,
    method: RainMethod,
    camera: Entity,
}

impl Rainy {
    fn new(size: UVec2, method: RainMethod, exposure: f32) -> anyhow::Result<Self> {
        let mut camera = Entity::PLACEHOLDER;
        let mut app = headless_app(size, |app| {
            app.add_plugins(RainPlugin {
                synchronous_bake: true,
            })
            .insert_resource(RainStreakSettings {
                exposure: Exposure::Seconds(exposure),
                ..default()
            })
            .insert_resource(GlobalAmbientLight {
                brightness: 1.0,
                ..default()
            });
            let bundle = (
                Camera3d::default(),
                Camera {
                    clear_color: ClearColorConfig::Custom(Color::BLACK),
                    ..default()
                },
                Hdr,
                Tonemapping::None,
                DebandDither::Disabled,
                UNIT_EXPOSURE,
                Transform::from_xyz(0.3, 50.2, 0.7),
                Rain {
                    method,
                    ..default()
                },
            );
            camera = app.world_mut().spawn(bundle).id();
        })?;
        settle(&mut app)?;
        Ok(Self {
            app,
            method,
            camera,
        })
    }

    fn set(&mut self, case: Case) -> anyhow::Result<()> {
        let rain = Rain {
            distance: case.distance,
            extent: 0.0,
            method: self.method,
            ..Rain::falling(case.rate)
        };
        let bundle = (rain, case.view.bundle());
        self.app.world_mut().entity_mut(self.camera).insert(bundle);
        settle(&mut self.app)?;
        // Long enough for every drop to be elsewhere.
        set_time_step(&mut self.app, Duration::from_secs_f64(0.37));
        let path = DiagnosticPath::new(PASS);
        let mut store = self.app.world_mut().resource_mut::<DiagnosticsStore>();
        if let Some(diagnostic) = store.get_mut(&path) {
            diagnostic.clear_history();
        }
        Ok(())
    }

    /// The next moment from another place: frame time in ms and opacity of each pixel.
    fn look(&mut self, look: u32) -> anyhow::Result<(f64, Vec<f32>)> {
        if let Some(mut place) = self.app.world_mut().get_mut::<Transform>(self.camera) {
            place.rotation = Quat::from_rotation_y(2.4 * look as f32);
            place.translation += vec3(1.7, 0.9, 2.3);
        }
        let start = Instant::now();
        step(&mut self.app, 1);
        let frame = start.elapsed().as_secs_f64() * 1e3;
        let world = self.app.sub_app(RenderApp).world();
        let target = world
            .iter_entities()
            .find_map(|entity| entity.get::<ViewTarget>());
        let target = target.context("the camera draws nothing")?;
        let data = read_texture(&self.app, target.main_texture())?;
        let pixels = (0..data.size.y)
            .flat_map(|y| (0..data.size.x).map(move |x| (x, y)))
            .map(|(x, y)| data.f16x4(x, y)[1]);
        Ok((frame, pixels.collect()))
    }

    fn gpu_ms(&self) -> anyhow::Result<f64> {
        match fluid_stage::median_gpu_ms(&self.app, PASS) {
            Some(time) => Ok(time),
            None => bail!("{} has no timestamps", adapter_name(&self.app)),
        }
    }
}

pub(crate) struct Pair {
    size: UVec2,
    streaks: Rainy,
    drops: Rainy,
}

impl Pair {
    pub(crate) fn new(size: UVec2) -> anyhow::Result<Self> {
        let exposure = 1.0 / 60.0;
        Ok(Self {
            size,
            streaks: Rainy::new(size, RainMethod::Streaks, exposure)?,
            drops: Rainy::new(size, RainMethod::PerDrop, exposure)?,
        })
    }

    pub(crate) fn measure(&mut self, case: Case, frames: u32) -> anyhow::Result<Row> {
        self.streaks.set(case)?;
        self.drops.set(case)?;
        let (mut streak_looks, mut drop_looks) = (Vec::new(), Vec::new());
        for look in 0..frames {
            streak_looks.push(self.streaks.look(look)?);
            drop_looks.push(self.drops.look(look)?);
        }
        let (streaks, drops) = (
            Moments::of(&streak_looks, |_| true),
            Moments::of(&drop_looks, |_| true),
        );
        let even = Moments::of(&drop_looks, |i| i % 2 == 0);
        let odd = Moments::of(&drop_looks, |i| i % 2 == 1);
        let width = self.size.x as usize;
        let wanted = extinction(f64::from(case.rate)) * f64::from(case.distance);
        let depth = |moments: &Moments| -(1.0 - moments.total).ln() / wanted;
        let (streaks_ms, drops_ms) = (self.streaks.gpu_ms()?, self.drops.gpu_ms()?);
        Ok(Row {
            adapter: adapter_name(&self.streaks.app),
            width: self.size.x,
            height: self.size.y,
            rate: case.rate,
            distance: case.distance,
            view: case.view,
            streaks_ms,
            drops_ms,
            streaks_frame_ms: median(streak_looks.iter().map(|look| look.0)),
            drops_frame_ms: median(drop_looks.iter().map(|look| look.0)),
            speedup: drops_ms / streaks_ms,
            streaks_depth: depth(&streaks),
            drops_depth: depth(&drops),
            difference: streaks.difference(&drops, width),
            own_difference: even.difference(&odd, width),
            variance: streaks.variance / drops.variance,
        })
    }
}

/// Means over time.
struct Moments {
    pixels: Vec<f64>,
    total: f64,
    /// Of a pixel, on average.
    variance: f64,
}

impl Moments {
    fn of(looks: &[(f64, Vec<f32>)], which: impl Fn(usize) -> bool) -> Self {
        let looks: Vec<&Vec<f32>> = looks
            .iter()
            .enumerate()
            .filter(|(i, _)| which(*i))
            .map(|(_, look)| &look.1)
            .collect();
        let count = looks.len() as f64;
        let pixels: Vec<f64> = (0..looks[0].len())
            .map(|i| looks.iter().map(|look| f64::from(look[i])).sum::<f64>() / count)
            .collect();
        let square = |i: usize| {
            looks
                .iter()
                .map(|look| (f64::from(look[i]) - pixels[i]).powi(2))
                .sum::<f64>()
        };
        let variance = (0..pixels.len())
            .map(|i| square(i) / (count - 1.0).max(1.0))
            .sum::<f64>();
        Self {
            total: pixels.iter().sum::<f64>() / pixels.len() as f64,
            variance: variance / pixels.len() as f64,
            pixels,
        }
    }

    fn blocks(&self, width: usize) -> Vec<f64> {
        let height = self.pixels.len() / width;
        let mut blocks = Vec::new();
        for top in (0..height - BLOCK + 1).step_by(BLOCK) {
            for left in (0..width - BLOCK + 1).step_by(BLOCK) {
                let rows = (top..top + BLOCK).map(|y| &self.pixels[y * width + left..][..BLOCK]);
                blocks.push(rows.flatten().sum::<f64>() / (BLOCK * BLOCK) as f64);
            }
        }
        blocks
    }

    fn difference(&self, other: &Self, width: usize) -> f64 {
        let (a, b) = (self.blocks(width), other.blocks(width));
        let squares = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        (squares / a.len() as f64).sqrt() / (0.5 * (self.total + other.total))
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// How long all textures take on the common threads.
pub(crate) fn bake_ms(runs: u32) -> f64 {
    median((0..runs).map(|seed| {
        let input = StreakInput {
            exposure: 1.0 / 60.0,
            law: DragLaw::GunnKinzer,
            seed: u64::from(seed),
        };
        let start = Instant::now();
        let streaks = bake(&input, &AtomicU32::new(0));
        let elapsed = start.elapsed().as_secs_f64() * 1e3;
        assert!(!streaks.texels.is_empty());
        elapsed
    }))
}

/// Optical depth of 10 m over βL for each rate, by streaks.
pub(crate) fn extinction_ratio(
    exposure: f32,
    rates: &[f32],
    frames: u32,
) -> anyhow::Result<Vec<f64>> {
    let mut rainy = Rainy::new(uvec2(320, 180), RainMethod::Streaks, exposure)?;
    let mut ratios = Vec::new();
    for &rate in rates {
        rainy.set(Case {
            rate,
            distance: 10.0,
            view: View::Perspective,
        })?;
        let mut sum = 0.0;
        for look in 0..frames {
            let (_, pixels) = rainy.look(look)?;
            sum += pixels.iter().copied().map(f64::from).sum::<f64>() / pixels.len() as f64;
        }
        ratios.push(-(1.0 - sum / f64::from(frames)).ln() / (extinction(f64::from(rate)) * 10.0));
    }
    Ok(ratios)
}
