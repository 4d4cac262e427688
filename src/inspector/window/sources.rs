//! The status of recordings and of live simulation: read-only lines.

use bevy::prelude::*;
use bevy_egui::egui::{CollapsingHeader, RichText, Ui};

use crate::inspector::times;

/// The frames that a fluid's player has loaded, and those that its writer has written.
#[cfg(feature = "recordings")]
pub(super) fn recordings(ui: &mut Ui, world: &World, fluid: Entity) {
    use crate::source::recording::{LoadedFrames, WrittenFrames};

    if let Some(frames) = world.get::<LoadedFrames>(fluid) {
        let shown = frames
            .shown()
            .map_or_else(|| "–".into(), |it| it.to_string());
        let lines = [
            ("number of the one shown", shown),
            ("held", frames.held().to_string()),
            ("loading", frames.loading().to_string()),
            ("unreadable or missing", frames.skipped().to_string()),
        ];
        section(ui, "Loaded frames", lines);
    }
    if let Some(frames) = world.get::<WrittenFrames>(fluid) {
        let lines = [
            ("written", frames.written().to_string()),
            ("waiting", frames.waiting().to_string()),
            ("left out", frames.dropped().to_string()),
        ];
        section(ui, "Written frames", lines);
        if let Some(error) = frames.error() {
            ui.colored_label(ui.visuals().warn_fg_color, error);
        }
    }
}

/// The status of live simulation.
#[cfg(feature = "salva")]
pub(super) fn live(ui: &mut Ui, world: &World) {
    let Some(status) = world.get_resource::<crate::source::salva::SalvaStatus>() else {
        return;
    };
    let lines = [
        ("speed", format!("{:.2}", status.speed)),
        (
            "ms per step",
            format!("{:.3}", 1e3 * status.step_time.as_secs_f64()),
        ),
        ("particles", status.particles.to_string()),
        ("simulated s", format!("{:.2}", status.simulated)),
        ("shown s", format!("{:.2}", status.shown)),
        ("removed particles", status.broken.to_string()),
    ];
    section(ui, "Live simulation", lines);
    if status.stopped {
        ui.colored_label(ui.visuals().warn_fg_color, "it has stopped: see the log");
    }
}

fn section<const N: usize>(ui: &mut Ui, title: &str, lines: [(&str, String); N]) {
    CollapsingHeader::new(title)
        .default_open(true)
        .show_unindented(ui, |ui| {
            for (name, figure) in lines {
                times::figures_row(ui, RichText::new(name), [figure]);
            }
        });
}
