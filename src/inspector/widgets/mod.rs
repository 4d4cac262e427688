//! Widgets for single values, and the columns that all rows share.

mod leaf;
mod number;
mod text;

use bevy_egui::egui::{self, Align, Id, Label, Layout, Response, Ui};

use self::text::plain;
pub(super) use self::{
    leaf::leaf,
    text::{digits, words},
};
use crate::settings::SettingRange;

/// Widths of the columns, in points.
pub(super) const LABEL: f32 = 128.0;
const SLIDER: f32 = 92.0;
const NUMBER: f32 = 92.0;
pub(super) const GAP: f32 = 6.0;
const RESET: f32 = 20.0;
const INDENT: f32 = 10.0;
pub(super) const VALUE: f32 = SLIDER + GAP + NUMBER;
/// Of the button that copies what a list shows.
pub(super) const COPY: f32 = 24.0;
/// All of them.
pub(super) const WIDTH: f32 = LABEL + GAP + VALUE + GAP + RESET;

/// The metadata of a value.
#[derive(Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) name: &'a str,
    pub(super) docs: Option<&'a str>,
    pub(super) range: Option<&'a SettingRange>,
    /// Structs around it, for the indent.
    pub(super) depth: usize,
}

/// What the user did to a row.
pub(super) struct RowOutput {
    pub(super) edited: bool,
    pub(super) reset: bool,
}

/// A row: the name with its explanation, the widgets, and a button that resets, where there is
/// something to reset. The widgets get the label's id, for screen readers.
pub(super) fn row(
    ui: &mut Ui,
    field: Field,
    differs: bool,
    widgets: impl FnOnce(&mut Ui, Id) -> bool,
) -> RowOutput {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        let label = label(ui, field);
        let edited = ui
            .allocate_ui_with_layout(
                egui::vec2(VALUE, ui.spacing().interact_size.y),
                Layout::left_to_right(Align::Center),
                |ui| {
                    ui.set_width(VALUE);
                    widgets(ui, label.id)
                },
            )
            .inner;
        let reset = differs && reset_button(ui, field.name);
        RowOutput { edited, reset }
    })
    .inner
}

fn label(ui: &mut Ui, field: Field) -> Response {
    let indent = INDENT * field.depth as f32;
    ui.allocate_ui_with_layout(
        egui::vec2(LABEL, ui.spacing().interact_size.y),
        Layout::left_to_right(Align::Center),
        |ui| {
            ui.set_width(LABEL);
            ui.add_space(indent);
            let label = ui.add(Label::new(words(field.name)).truncate());
            explained(label, field.docs)
        },
    )
    .inner
}

fn reset_button(ui: &mut Ui, name: &str) -> bool {
    let button = egui::Button::new("⟲").frame(false).small();
    let name = format!("reset {}", words(name));
    let response = ui.add(button).on_hover_text("back to the default");
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, name.as_str()));
    response.clicked()
}

/// A button that copies all settings of the entity shown. Whether it was pressed.
pub(super) fn copy_button(ui: &mut Ui, kind: &str) -> bool {
    let response = ui.button("Copy").on_hover_text("all of it as Rust code");
    let name = format!("copy {}", words(kind));
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Button, true, name.as_str()));
    response.clicked()
}

/// A response that shows the docs when the pointer rests on it.
pub(super) fn explained(response: Response, docs: Option<&str>) -> Response {
    match docs {
        Some(docs) => response.on_hover_ui(|ui| {
            ui.set_max_width(320.0);
            ui.label(plain(docs));
        }),
        None => response,
    }
}
