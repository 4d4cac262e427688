//! How long each pass takes, as a plot over time and in numbers.

use std::time::Duration;

use bevy::{
    diagnostic::{Diagnostic, DiagnosticPath, DiagnosticsStore},
    platform::time::Instant,
    prelude::*,
};
use bevy_egui::egui::{self, Align, Color32, Layout, RichText, Ui};
use egui_plot::{Line, Plot};

use super::widgets::WIDTH;
use crate::{
    clock,
    diagnostics::{PASSES, RAIN_PASSES, SHAPE_TOTAL, cpu_time, gpu_time},
};

/// Which times are plotted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Clock {
    /// Those of the GPU.
    #[default]
    Gpu,
    /// Those of the CPU: shaping, and recording the passes.
    Cpu,
}

/// A pass that has not run for so long has stopped.
const STALE: Duration = Duration::from_secs(3);

/// One colour for each pass, and the last for shaping.
const COLORS: [Color32; PASSES.len() + 1] = [
    Color32::from_rgb(150, 150, 150),
    Color32::from_rgb(66, 150, 250),
    Color32::from_rgb(90, 110, 230),
    Color32::from_rgb(60, 200, 200),
    Color32::from_rgb(110, 200, 80),
    Color32::from_rgb(220, 200, 60),
    Color32::from_rgb(240, 120, 60),
    Color32::from_rgb(220, 90, 180),
    Color32::from_rgb(250, 180, 200),
    Color32::from_rgb(160, 130, 240),
];

/// The names and colours of the passes with rain.
const RAIN: [(&str, Color32); RAIN_PASSES.len()] = [
    ("rain: scene depth", Color32::from_rgb(120, 120, 200)),
    ("transparent, rain", Color32::from_rgb(190, 215, 240)),
];

/// One line of the plot and one row of the table.
struct Stage {
    name: String,
    color: Color32,
    gpu: Option<DiagnosticPath>,
    cpu: DiagnosticPath,
}

impl Stage {
    /// Includes the passes with rain only where rain is drawn.
    fn all(store: &DiagnosticsStore, now: Instant) -> Vec<Self> {
        let shape = Self {
            name: "shape".into(),
            color: COLORS[PASSES.len()],
            gpu: None,
            cpu: SHAPE_TOTAL,
        };
        let passes = PASSES.iter().zip(COLORS).map(|(pass, color)| Self {
            name: pass.trim_start_matches("fluid_").replace('_', " "),
            color,
            gpu: Some(gpu_time(pass)),
            cpu: cpu_time(pass),
        });
        let rain = RAIN_PASSES
            .iter()
            .zip(RAIN)
            .map(|(pass, (name, color))| Self {
                name: name.into(),
                color,
                gpu: Some(gpu_time(pass)),
                cpu: cpu_time(pass),
            });
        let rains = current(store, Some(&cpu_time(RAIN_PASSES[0])), now).is_some();
        let rain = rain.filter(|_| rains);
        [shape].into_iter().chain(passes).chain(rain).collect()
    }

    fn path(&self, clock: Clock) -> Option<&DiagnosticPath> {
        match clock {
            Clock::Gpu => self.gpu.as_ref(),
            Clock::Cpu => Some(&self.cpu),
        }
    }
}

/// A diagnostic that is still measured.
fn current<'a>(
    store: &'a DiagnosticsStore,
    path: Option<&DiagnosticPath>,
    now: Instant,
) -> Option<&'a Diagnostic> {
    let diagnostic = store.get(path?)?;
    let last = diagnostic.measurement()?;
    (now.saturating_duration_since(last.time) < STALE).then_some(diagnostic)
}

pub(super) fn show(ui: &mut Ui, store: &DiagnosticsStore, clock: &mut Clock) {
    let now = clock::now();
    let stages = Stage::all(store, now);
    ui.horizontal(|ui| {
        ui.selectable_value(clock, Clock::Gpu, "GPU");
        ui.selectable_value(clock, Clock::Cpu, "CPU");
        ui.label(RichText::new("ms over the last seconds").weak());
    });
    plot(ui, store, &stages, *clock, now);
    table(ui, store, &stages, now);
}

fn plot(ui: &mut Ui, store: &DiagnosticsStore, stages: &[Stage], clock: Clock, now: Instant) {
    Plot::new("times")
        .width(WIDTH)
        .height(96.0)
        // The wheel scrolls the window.
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_x(false)
        .include_y(0.0)
        .include_x(0.0)
        .y_axis_min_width(34.0)
        .x_axis_formatter(|mark, _| format!("{:.0} s", mark.value))
        .show(ui, |plot| {
            for stage in stages {
                let Some(times) = current(store, stage.path(clock), now) else {
                    continue;
                };
                let points: Vec<_> = times
                    .measurements()
                    .map(|it| {
                        let ago = now.saturating_duration_since(it.time);
                        [-ago.as_secs_f64(), it.value]
                    })
                    .collect();
                plot.line(Line::new(stage.name.as_str(), points).color(stage.color));
            }
        });
}

/// Means over the frames that Bevy remembers.
fn table(ui: &mut Ui, store: &DiagnosticsStore, stages: &[Stage], now: Instant) {
    let mut sums = [None::<f64>; 2];
    heading_row(ui, ["", "GPU ms", "CPU ms"]);
    for stage in stages {
        let means = [Clock::Gpu, Clock::Cpu]
            .map(|clock| current(store, stage.path(clock), now).and_then(Diagnostic::average));
        for (sum, mean) in sums.iter_mut().zip(means) {
            if let Some(mean) = mean {
                *sum = Some(sum.unwrap_or(0.0) + mean);
            }
        }
        let name = RichText::new(format!("■ {}", stage.name)).color(stage.color);
        figures_row(ui, name, means.map(milliseconds));
    }
    figures_row(
        ui,
        RichText::new("together").strong(),
        sums.map(milliseconds),
    );
}

fn milliseconds(time: Option<f64>) -> String {
    time.map_or_else(|| "–".into(), |time| format!("{time:.3}"))
}

/// A table's first row.
pub(super) fn heading_row<const N: usize>(ui: &mut Ui, names: [&str; N]) {
    let [first, rest @ ..] = &names[..] else {
        return;
    };
    let texts = rest.iter().map(|name| RichText::new(*name).weak().small());
    columns(ui, RichText::new(*first).weak().small(), texts);
}

/// A name, and figures in columns of fixed width, so that they stay where they are.
pub(super) fn figures_row<const N: usize>(ui: &mut Ui, name: RichText, figures: [String; N]) {
    let texts = figures.into_iter().map(|it| RichText::new(it).monospace());
    columns(ui, name, texts);
}

const FIGURE: f32 = 76.0;

fn columns(ui: &mut Ui, name: RichText, figures: impl ExactSizeIterator<Item = RichText>) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let height = ui.text_style_height(&egui::TextStyle::Body);
        let first = WIDTH - FIGURE * figures.len() as f32;
        for (width, text, layout) in
            core::iter::once((first, name, Layout::left_to_right(Align::Center)))
                .chain(figures.map(|figure| (FIGURE, figure, Layout::right_to_left(Align::Center))))
        {
            ui.allocate_ui_with_layout(egui::vec2(width, height), layout, |ui| {
                ui.set_width(width);
                ui.label(text);
            });
        }
    });
}
