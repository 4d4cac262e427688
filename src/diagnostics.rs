//! Counts and times in Bevy's `DiagnosticsStore`, where any tool can show them.
//!
//! [`FluidDiagnosticsPlugin`] is not part of `FluidPlugin`; add it where figures are wanted:
//!
//! ```no_run
//! use bevy::{diagnostic::LogDiagnosticsPlugin, prelude::*};
//! use bevy_fluid::{FluidDiagnosticsPlugin, prelude::*};
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
//! | `render/<pass>/elapsed_gpu` | ms | GPU time of a pass in [`PASSES`], all cameras |
//! | `render/<pass>/elapsed_cpu` | ms | CPU time of recording it |
//!
//! The passes' times come from Bevy's [`RenderDiagnosticsPlugin`], which is added where it is
//! missing; GPU times need an adapter with timestamp queries.

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, Diagnostics, RegisterDiagnostic},
    prelude::*,
    render::diagnostic::RenderDiagnosticsPlugin,
};

use crate::{FluidSystems, ShapedFluid, shape::ShapeTimes};

/// Particles of all fluids, dropped ones included.
pub const PARTICLES: DiagnosticPath = DiagnosticPath::const_new("fluid/particles");
/// Bulk particles near a surface.
pub const BULK: DiagnosticPath = DiagnosticPath::const_new("fluid/bulk");
/// Bulk particles that no visible surface passes through.
pub const INTERIOR: DiagnosticPath = DiagnosticPath::const_new("fluid/interior");
/// Spray particles.
pub const SPRAY: DiagnosticPath = DiagnosticPath::const_new("fluid/spray");
/// Particles left out because their position is not finite.
pub const DROPPED: DiagnosticPath = DiagnosticPath::const_new("fluid/dropped");
/// Sorting the particles of the fluids shaped in a frame into cells. Unit: ms.
pub const SHAPE_GRID: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/grid");
/// Telling their classes apart. Unit: ms.
pub const SHAPE_CLASSIFY: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/classify");
/// Making their ellipsoids. Unit: ms.
pub const SHAPE_ANISOTROPY: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/anisotropy");
/// All of the shaping. Unit: ms.
pub const SHAPE_TOTAL: DiagnosticPath = DiagnosticPath::const_new("fluid/shape/total");

/// The passes in their order, by the names of their time spans.
pub const PASSES: [&str; 7] = [
    "fluid_scene_depth",
    "fluid_splat",
    "fluid_thickness",
    "fluid_smooth",
    "fluid_normals",
    "fluid_refract",
    "fluid_composite",
];

/// Where the GPU time of a pass is kept. Unit: ms.
pub fn gpu_time(pass: &str) -> DiagnosticPath {
    DiagnosticPath::new(format!("render/{pass}/elapsed_gpu"))
}

/// Where the CPU time of recording a pass is kept. Unit: ms.
pub fn cpu_time(pass: &str) -> DiagnosticPath {
    DiagnosticPath::new(format!("render/{pass}/elapsed_cpu"))
}

/// Keeps the counts and times of all fluids in Bevy's `DiagnosticsStore`: see
/// [`diagnostics`](crate::diagnostics). Add it after `RenderDiagnosticsPlugin`, if you add that.
#[derive(Clone, Copy, Debug, Default)]
pub struct FluidDiagnosticsPlugin;

impl Plugin for FluidDiagnosticsPlugin {
    fn build(&self, app: &mut App) {
        if !app.is_plugin_added::<RenderDiagnosticsPlugin>() {
            app.add_plugins(RenderDiagnosticsPlugin);
        }
        for count in [PARTICLES, BULK, INTERIOR, SPRAY, DROPPED] {
            app.register_diagnostic(Diagnostic::new(count).with_smoothing_factor(0.0));
        }
        for time in [SHAPE_GRID, SHAPE_CLASSIFY, SHAPE_ANISOTROPY, SHAPE_TOTAL] {
            app.register_diagnostic(Diagnostic::new(time).with_suffix(" ms"));
        }
        app.add_systems(PostUpdate, measure.after(FluidSystems::Shape));
    }
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
