//! Counts and times in Bevy's `DiagnosticsStore`, where any tool can show them.
//!
//! [`FluidDiagnosticsPlugin`] is not part of `FluidPlugin`; add it where you need figures:
//!
//! ```no_run
//! use bevy::{diagnostic::LogDiagnosticsPlugin, prelude::*};
//! use bevy_fluid::{diagnostics::FluidDiagnosticsPlugin, prelude::*};
//!
//! App::new()
//!     .add_plugins((
//!         DefaultPlugins,
//!         FluidPlugin::default(),
//!         FluidDiagnosticsPlugin,
//!         LogDiagnosticsPlugin::default(),
//!     ))
//!     .run();
//! ```
//!
//! | path | unit | what |
//! | --- | --- | --- |
//! | `fluid/particles` | | particles of all fluids, dropped ones included |
//! | `fluid/bulk`, `fluid/interior`, `fluid/spray` | | particles of each class |
//! | `fluid/dropped` | | particles whose position is not finite |
//! | `fluid/shape/grid`, `…/classify`, `…/anisotropy`, `…/total` | ms | CPU time of the frame's shaping; 0 where nothing was shaped |
//! | `fluid/texture_memory` | MiB | textures that the passes of fluids draw to, of all cameras |
//! | `fluid/emitted` | | particles of emitters, without those that something else moves |
//! | `fluid/recording/cached` | | frames in the players' memory, loading ones included; feature `recordings` |
//! | `fluid/salva/particles` | | particles simulated live; feature `salva`, with `SalvaPlugin` |
//! | `fluid/salva/step` | ms | CPU time of one of its steps, on its own threads |
//! | `rain/bake_progress` | | share of the rain's textures that is drawn, 0 to 1; recorded by `RainPlugin` itself |
//! | `rain/bake_time` | ms | time to draw all of them; likewise |
//! | `render/<pass>/elapsed_gpu` | ms | GPU time of a pass in [`PASSES`] or [`RAIN_PASSES`], all cameras |
//! | `render/<pass>/elapsed_cpu` | ms | CPU time of recording it |
//!
//! The passes' times come from Bevy's [`RenderDiagnosticsPlugin`], which is added if missing; GPU
//! times need an adapter with timestamp queries.

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic},
    prelude::*,
    render::{RenderApp, diagnostic::RenderDiagnosticsPlugin},
};

#[cfg(feature = "recordings")]
use crate::source::recording::LoadedFrames;
use crate::{
    FluidSystems, emitter::EmittedParticles, needs::log_late_renderer, particles::ShapedFluid,
    render::TextureMemory, shape::ShapeTimes,
};

/// Particles of all fluids, dropped ones included.
pub const PARTICLES: DiagnosticPath = DiagnosticPath::const_new("fluid/particles");
/// Bulk particles near a surface.
pub const BULK: DiagnosticPath = DiagnosticPath::const_new("fluid/bulk");
/// Bulk particles that no visible surface passes through.
pub const INTERIOR: DiagnosticPath = DiagnosticPath::const_new("fluid/interior");
/// Spray particles.
pub const SPRAY: DiagnosticPath = DiagnosticPath::const_new("fluid/spray");
/// Particles dropped because their position is not finite.
pub const DROPPED: DiagnosticPath = DiagnosticPath::const_new("fluid/dropped");
/// CPU time of sorting a frame's shaped particles into cells. Unit: ms.
pub const SHAPE_GRID: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/grid");
/// CPU time of classifying particles. Unit: ms.
pub const SHAPE_CLASSIFY: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/classify");
/// CPU time of computing ellipsoids. Unit: ms.
pub const SHAPE_ANISOTROPY: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/anisotropy");
/// CPU time of all of the shaping. Unit: ms.
pub const SHAPE_TOTAL: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/total");
/// Memory of the textures that the passes of fluids draw to, of all cameras. Unit: MiB.
pub const TEXTURE_MEMORY: DiagnosticPath = DiagnosticPath::const_new("fluid/texture_memory");
/// Particles of emitters, without those that something else moves.
pub const EMITTED: DiagnosticPath = DiagnosticPath::const_new("fluid/emitted");
/// Frames in the players' memory, loading ones included.
#[cfg(feature = "recordings")]
pub const CACHED_FRAMES: DiagnosticPath = DiagnosticPath::const_new("fluid/recording/cached");
/// Particles simulated live.
#[cfg(feature = "salva")]
pub const SALVA_PARTICLES: DiagnosticPath = DiagnosticPath::const_new("fluid/salva/particles");
/// CPU time of one step of live simulation, on its own threads. Unit: ms.
#[cfg(feature = "salva")]
pub const SALVA_STEP: DiagnosticPath = DiagnosticPath::const_new("fluid/salva/step");

/// Names of the passes' time spans, in the order of the passes.
pub const PASSES: [&str; 9] = crate::render::SPANS;

/// Passes that rain uses: the copy of the scene's depth, for rain only, and Bevy's own pass for
/// transparent objects, in which rain is drawn.
pub const RAIN_PASSES: [&str; 2] = ["rain_scene_depth", "main_transparent_pass_3d"];

/// The path of a pass's GPU time. Unit: ms.
pub fn gpu_time(pass: &str) -> DiagnosticPath {
    DiagnosticPath::new(format!("render/{pass}/elapsed_gpu"))
}

/// The path of the CPU time of recording a pass. Unit: ms.
pub fn cpu_time(pass: &str) -> DiagnosticPath {
    DiagnosticPath::new(format!("render/{pass}/elapsed_cpu"))
}

/// Records the counts and times of all fluids in Bevy's `DiagnosticsStore`: see
/// [`diagnostics`](crate::diagnostics). Add it after `RenderDiagnosticsPlugin`, if you add that.
#[derive(Clone, Copy, Debug, Default)]
pub struct FluidDiagnosticsPlugin;

impl Plugin for FluidDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        let is_measured = app.is_plugin_added::<RenderDiagnosticsPlugin>();
        if app.get_sub_app(RenderApp).is_some() && !is_measured {
            app.add_plugins(RenderDiagnosticsPlugin);
        }
        for path in [PARTICLES, BULK, INTERIOR, SPRAY, DROPPED, EMITTED] {
            app.register_diagnostic(count(path));
        }
        for path in [SHAPE_GRID, SHAPE_CLASSIFY, SHAPE_ANISOTROPY, SHAPE_TOTAL] {
            app.register_diagnostic(time(path));
        }
        let memory = Diagnostic::new(TEXTURE_MEMORY).with_smoothing_factor(0.0);
        app.register_diagnostic(memory.with_suffix(" MiB"));
        let measured = FluidSystems::Shape;
        app.add_systems(
            PostUpdate,
            (measure, measure_emitters, measure_memory).after(measured),
        );
        #[cfg(feature = "recordings")]
        app.register_diagnostic(count(CACHED_FRAMES))
            .add_systems(PostUpdate, measure_recordings.after(measured));
        #[cfg(feature = "salva")]
        app.register_diagnostic(count(SALVA_PARTICLES))
            .register_diagnostic(time(SALVA_STEP))
            .add_systems(PostUpdate, measure_salva.after(measured));
    }

    fn finish(&self, app: &mut App) {
        let is_measured = app.is_plugin_added::<RenderDiagnosticsPlugin>();
        if app.get_sub_app(RenderApp).is_some() && !is_measured {
            log_late_renderer("FluidDiagnosticsPlugin", "measures no pass");
        }
    }
}

fn count(path: DiagnosticPath) -> Diagnostic {
    Diagnostic::new(path).with_smoothing_factor(0.0)
}

fn time(path: DiagnosticPath) -> Diagnostic {
    Diagnostic::new(path).with_suffix(" ms")
}

fn measure_memory(memory: Option<Res<TextureMemory>>, mut diagnostics: Diagnostics) {
    if let Some(memory) = memory {
        diagnostics.add_measurement(&TEXTURE_MEMORY, || {
            memory.bytes() as f64 / f64::from(1 << 20)
        });
    }
}

fn measure_emitters(emitters: Query<&EmittedParticles>, mut diagnostics: Diagnostics) {
    let count: usize = emitters.iter().map(EmittedParticles::len).sum();
    diagnostics.add_measurement(&EMITTED, || count as f64);
}

#[cfg(feature = "recordings")]
fn measure_recordings(players: Query<&LoadedFrames>, mut diagnostics: Diagnostics) {
    let count: usize = players.iter().map(LoadedFrames::held).sum();
    diagnostics.add_measurement(&CACHED_FRAMES, || count as f64);
}

#[cfg(feature = "salva")]
fn measure_salva(
    status: Option<Res<crate::source::salva::SalvaStatus>>,
    mut diagnostics: Diagnostics,
) {
    let Some(status) = status else {
        return;
    };
    diagnostics.add_measurement(&SALVA_PARTICLES, || status.particles as f64);
    diagnostics.add_measurement(&SALVA_STEP, || 1e3 * status.step_time.as_secs_f64());
}

fn measure(fluids: Query<Ref<ShapedFluid>>, mut diagnostics: Diagnostics) {
    let (mut bulk, mut interior, mut spray, mut dropped) = (0, 0, 0, 0);
    let mut times = ShapeTimes::default();
    for fluid in &fluids {
        bulk += u64::from(fluid.bulk());
        interior += u64::from(fluid.interior());
        spray += u64::from(fluid.spray());
        dropped += u64::from(fluid.dropped());
        if fluid.is_changed() {
            let these = fluid.times();
            times.grid += these.grid;
            times.classify += these.classify;
            times.anisotropy += these.anisotropy;
            times.total += these.total;
        }
    }
    for (path, count) in [
        (PARTICLES, bulk + interior + spray + dropped),
        (BULK, bulk),
        (INTERIOR, interior),
        (SPRAY, spray),
        (DROPPED, dropped),
    ] {
        diagnostics.add_measurement(&path, || count as f64);
    }
    for (path, time) in [
        (SHAPE_GRID, times.grid),
        (SHAPE_CLASSIFY, times.classify),
        (SHAPE_ANISOTROPY, times.anisotropy),
        (SHAPE_TOTAL, times.total),
    ] {
        diagnostics.add_measurement(&path, || 1e3 * time.as_secs_f64());
    }
}
