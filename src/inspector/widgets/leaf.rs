//! Which widget a value gets by its type.

use bevy::{prelude::*, reflect::PartialReflect};
use bevy_egui::egui::{self, Id, Ui};
use core::time::Duration;

use super::{
    VALUE,
    number::{color, number, vector},
};
use crate::settings::SettingRange;

/// The widgets of a value without parts; `None` for what has parts, or cannot be edited.
pub(in crate::inspector) fn leaf(
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
        return Some(text(ui, label, value));
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

/// A line of text, which counts once it is complete: half of a file's name is another file's.
fn text(ui: &mut Ui, label: Id, value: &mut String) -> bool {
    let id = ui.id().with("draft");
    let draft = ui.data_mut(|data| data.remove_temp::<String>(id));
    let mut draft = draft.unwrap_or_else(|| value.clone());
    let edit = egui::TextEdit::singleline(&mut draft).desired_width(VALUE);
    let edit = ui.add(edit).labelled_by(label);
    if edit.has_focus() {
        ui.data_mut(|data| data.insert_temp(id, draft));
        return false;
    }
    let edited = edit.lost_focus() && draft != *value;
    if edited {
        *value = draft;
    }
    edited
}
