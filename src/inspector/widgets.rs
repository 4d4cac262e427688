//! What a single value is edited with, and the columns that all rows share.

use bevy::{prelude::*, reflect::PartialReflect};
use bevy_egui::egui::{
    self, Align, DragValue, Id, Label, Layout, Response, RichText, Slider, SliderClamping, Ui,
};
use core::time::Duration;

use crate::SettingRange;

/// Widths of the columns, in points.
pub(super) const LABEL: f32 = 128.0;
const SLIDER: f32 = 92.0;
const NUMBER: f32 = 92.0;
pub(super) const GAP: f32 = 6.0;
const RESET: f32 = 20.0;
const INDENT: f32 = 10.0;
pub(super) const VALUE: f32 = SLIDER + GAP + NUMBER;
/// All of them.
pub(super) const WIDTH: f32 = LABEL + GAP + VALUE + GAP + RESET;

/// What is known of a value beside itself.
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
/// something to reset. The widgets get the label's id, for those who hear the window.
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

/// A field's or a variant's name in words: `half_taps` and `BulkFront` are "half taps" and "bulk
/// front".
pub(super) fn words(name: &str) -> String {
    let mut words = String::with_capacity(name.len() + 4);
    for (i, letter) in name.char_indices() {
        match letter {
            '_' => words.push(' '),
            _ if letter.is_ascii_uppercase() => {
                if i > 0 {
                    words.push(' ');
                }
                words.push(letter.to_ascii_lowercase());
            }
            _ => words.push(letter),
        }
    }
    words
}

/// Docs without the marks of Markdown: links are their text, lines of a paragraph are joined.
pub(super) fn plain(docs: &str) -> String {
    let mut text = String::with_capacity(docs.len());
    for line in docs.lines().map(str::trim) {
        if line.is_empty() {
            text.push_str("\n\n");
        } else {
            if !text.is_empty() && !text.ends_with('\n') {
                text.push(' ');
            }
            text.push_str(line);
        }
    }
    let mut plain = String::with_capacity(text.len());
    let mut rest = text.trim();
    while let Some(at) = rest.find(['`', '[', ']']) {
        plain.push_str(&rest[..at]);
        let mark = rest.as_bytes()[at];
        rest = &rest[at + 1..];
        // Where a link goes to, behind its text.
        if mark == b']'
            && rest.starts_with('(')
            && let Some(end) = rest.find(')')
        {
            rest = &rest[end + 1..];
        }
    }
    plain + rest
}

/// Four digits that count, and no more than needed: what does not fit would make the row jump.
pub(super) fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if !(1e-4..1e7).contains(&size) {
        return format!("{value:.2e}");
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A slider, where there is a range, and the number. Whether it was changed.
pub(super) fn number(
    ui: &mut Ui,
    label: Id,
    value: &mut f64,
    integer: bool,
    range: Option<&SettingRange>,
) -> bool {
    let height = ui.spacing().interact_size.y;
    let mut edited = false;
    if let Some(range) = range {
        ui.spacing_mut().slider_width = SLIDER;
        let mut slider = Slider::new(value, range.min..=range.max)
            .show_value(false)
            .logarithmic(range.logarithmic)
            .smallest_positive((range.max * 1e-5).max(1e-6))
            .clamping(SliderClamping::Edits);
        if integer {
            slider = slider.integer();
        }
        edited |= ui
            .add_sized([SLIDER, height], slider)
            .labelled_by(label)
            .changed();
    }
    edited | drag(ui, label, value, integer, range, NUMBER)
}

/// A number that is dragged or typed.
fn drag(
    ui: &mut Ui,
    label: Id,
    value: &mut f64,
    integer: bool,
    range: Option<&SettingRange>,
    width: f32,
) -> bool {
    let before = *value;
    let speed = match range {
        _ if integer => 0.1,
        Some(range) if !range.logarithmic => (range.max - range.min) / 500.0,
        _ => (before.abs() * 0.01).max(1e-4),
    };
    let unit = range.map_or("", |range| range.unit);
    let mut drag = DragValue::new(value)
        .speed(speed)
        .custom_formatter(move |value, _| {
            if integer {
                format!("{value:.0}")
            } else {
                digits(value)
            }
        });
    if let Some(range) = range {
        drag = drag.range(range.min..=range.limit());
    }
    if !unit.is_empty() {
        drag = drag.suffix(RichText::new(format!(" {unit}")).weak());
    }
    ui.spacing_mut().interact_size.x = width;
    let response = ui
        .add_sized([width, ui.spacing().interact_size.y], drag)
        .labelled_by(label);
    if !response.changed() {
        return false;
    }
    // Leaving the field reads back what was shown, which is rounded.
    if digits(*value) == digits(before) && !response.dragged() {
        *value = before;
        return false;
    }
    true
}

/// Vectors: a number for each component.
pub(super) fn vector(
    ui: &mut Ui,
    label: Id,
    values: &mut [f32],
    range: Option<&SettingRange>,
) -> bool {
    let count = values.len() as f32;
    let width = (VALUE - (count - 1.0) * 4.0) / count;
    ui.spacing_mut().item_spacing.x = 4.0;
    let narrow = range.map(|range| SettingRange {
        unit: if count > 2.0 { "" } else { range.unit },
        ..*range
    });
    let mut edited = false;
    for value in values {
        let mut number = f64::from(*value);
        if drag(ui, label, &mut number, false, narrow.as_ref(), width) {
            *value = number as f32;
            edited = true;
        }
    }
    edited
}

/// A colour; with a range, one that may be brighter than white, and how bright it is.
pub(super) fn color(
    ui: &mut Ui,
    label: Id,
    color: &mut LinearRgba,
    range: Option<&SettingRange>,
) -> bool {
    let rgb = color.to_vec3();
    let full = if range.is_some() {
        rgb.max_element()
    } else {
        1.0
    };
    let mut hue = if full > 0.0 { rgb / full } else { Vec3::ONE }.to_array();
    ui.spacing_mut().interact_size.x = if range.is_some() { 40.0 } else { SLIDER };
    let mut edited = ui
        .color_edit_button_rgb(&mut hue)
        .labelled_by(label)
        .changed();
    let mut brightness = f64::from(full);
    match range {
        Some(range) => {
            let width = VALUE - 40.0 - GAP;
            edited |= drag(ui, label, &mut brightness, false, Some(range), width);
        }
        None => {
            let [r, g, b] = hue;
            ui.label(RichText::new(format!("{r:.2} {g:.2} {b:.2}")).weak());
        }
    }
    if edited {
        let rgb = Vec3::from(hue) * brightness as f32;
        *color = LinearRgba::new(rgb.x, rgb.y, rgb.z, color.alpha);
    }
    edited
}

/// The widgets of a value without parts; `None` for what has parts, or cannot be edited.
pub(super) fn leaf(
    ui: &mut Ui,
    label: Id,
    value: &mut dyn PartialReflect,
    range: Option<&SettingRange>,
) -> Option<bool> {
    macro_rules! numbers {
        ($integer:literal: $($type:ty),+) => {
            $(if let Some(value) = value.try_downcast_mut::<$type>() {
                let mut shown = *value as f64;
                let edited = number(ui, label, &mut shown, $integer, range);
                if edited {
                    *value = shown as $type;
                }
                return Some(edited);
            })+
        };
    }
    numbers!(false: f32, f64);
    numbers!(true: u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
    if let Some(value) = value.try_downcast_mut::<bool>() {
        return Some(ui.checkbox(value, "").labelled_by(label).changed());
    }
    if let Some(value) = value.try_downcast_mut::<String>() {
        let edit = egui::TextEdit::singleline(value).desired_width(VALUE);
        return Some(ui.add(edit).labelled_by(label).changed());
    }
    if let Some(value) = value.try_downcast_mut::<Duration>() {
        let mut seconds = value.as_secs_f64();
        let range = range
            .copied()
            .unwrap_or(SettingRange::new(0.0, 60.0).unit("s").open());
        let edited = number(ui, label, &mut seconds, false, Some(&range));
        if edited {
            *value = Duration::try_from_secs_f64(seconds).unwrap_or(*value);
        }
        return Some(edited);
    }
    if let Some(value) = value.try_downcast_mut::<LinearRgba>() {
        return Some(color(ui, label, value, range));
    }
    if let Some(value) = value.try_downcast_mut::<Color>() {
        let mut linear = value.to_linear();
        let edited = color(ui, label, &mut linear, range);
        if edited {
            *value = linear.into();
        }
        return Some(edited);
    }
    macro_rules! vectors {
        ($($type:ty),+) => {
            $(if let Some(value) = value.try_downcast_mut::<$type>() {
                let mut parts = value.to_array();
                let edited = vector(ui, label, &mut parts, range);
                if edited {
                    *value = parts.into();
                }
                return Some(edited);
            })+
        };
    }
    vectors!(Vec2, Vec3, Vec4);
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words() {
        assert_eq!(words("half_taps"), "half taps");
        assert_eq!(words("BulkFront"), "bulk front");
        assert_eq!(words("None"), "none");
    }

    #[test]
    fn docs_lose_their_marks() {
        let docs =
            " How it is. Default:\n [`PlaneFit::DEFAULT`] (`N_ε`).\n\n See [there](Self::there).";
        assert_eq!(
            plain(docs),
            "How it is. Default: PlaneFit::DEFAULT (N_ε).\n\nSee there."
        );
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (2.828_427, "2.828"),
            (f64::from(0.9_f32), "0.9"),
            (25_000.0, "25000"),
            (-30.0, "-30"),
            (0.001_234_56, "0.001235"),
            (123_456.7, "123457"),
            (1e9, "1.00e9"),
            (-1e-6, "-1.00e-6"),
        ] {
            assert_eq!(digits(value), text);
        }
    }
}
