//! Numbers, vectors and colours.

use bevy::prelude::*;
use bevy_egui::egui::{DragValue, Id, RichText, Slider, SliderClamping, Ui};

use super::{GAP, NUMBER, SLIDER, VALUE, digits};
use crate::settings::SettingRange;

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
        drag = drag.range(range.valid[0]..=range.valid[1]);
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

/// A colour; with a range beyond 1, one that may be brighter than white, and how bright it is.
pub(super) fn color(
    ui: &mut Ui,
    label: Id,
    color: &mut LinearRgba,
    range: Option<&SettingRange>,
) -> bool {
    let range = range.filter(|range| range.max > 1.0);
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
