//! From reflected values to rows: through structs and enums down to what has a widget.

mod variants;

use bevy::{
    prelude::*,
    reflect::{
        NamedField, PartialReflect, ReflectMut, ReflectRef, TypeInfo, TypeRegistry, UnnamedField,
        prelude::ReflectDefault, structs::Struct, tuple_struct::TupleStruct,
    },
};
use bevy_egui::egui::{ComboBox, Id, RichText, Ui};
use core::any::TypeId;

use super::{
    presets::ReflectPresets,
    widgets::{Field, VALUE, leaf, row},
};
use crate::settings::SettingRange;

/// Walks over values of the types that the registry knows.
pub(super) struct Walker<'a> {
    pub(super) registry: &'a TypeRegistry,
}

impl Walker<'_> {
    /// The default of a type, if it is registered with one.
    pub(super) fn default_of(&self, id: TypeId) -> Option<Box<dyn Reflect>> {
        let data = self.registry.get_type_data::<ReflectDefault>(id)?;
        Some(data.default())
    }

    /// Rows for all parts of a component. Whether something was edited.
    pub(super) fn parts(
        &self,
        ui: &mut Ui,
        value: &mut dyn PartialReflect,
        default: Option<&dyn PartialReflect>,
        depth: usize,
    ) -> bool {
        match value.reflect_mut() {
            ReflectMut::Struct(it) => self.structure(ui, it, default, depth),
            ReflectMut::TupleStruct(it) => self.tuple(ui, it, default, depth),
            ReflectMut::Enum(_) => {
                let field = Field {
                    name: "kind",
                    docs: None,
                    range: None,
                    depth,
                };
                self.field(ui, field, value, default)
            }
            _ => false,
        }
    }

    fn structure(
        &self,
        ui: &mut Ui,
        value: &mut dyn Struct,
        default: Option<&dyn PartialReflect>,
        depth: usize,
    ) -> bool {
        let info = value.get_represented_struct_info();
        let default = default.and_then(|it| it.reflect_ref().as_struct().ok());
        let mut edited = false;
        for index in 0..value.field_len() {
            let name = value.name_at(index).unwrap_or_default().to_owned();
            let info: Option<&NamedField> = info.and_then(|info| info.field(&name));
            let default = default.and_then(|it| it.field(&name));
            let field = Field {
                name: &name,
                docs: info.and_then(NamedField::docs),
                range: info.and_then(SettingRange::of),
                depth,
            };
            if let Some(part) = value.field_at_mut(index) {
                edited |= self.field(ui, field, part, default);
            }
        }
        edited
    }

    fn tuple(
        &self,
        ui: &mut Ui,
        value: &mut dyn TupleStruct,
        default: Option<&dyn PartialReflect>,
        depth: usize,
    ) -> bool {
        let info = value.get_represented_tuple_struct_info();
        let default = default.and_then(|it| it.reflect_ref().as_tuple_struct().ok());
        let mut edited = false;
        for index in 0..value.field_len() {
            let info = info.and_then(|info| info.field_at(index));
            let field = Field {
                name: if index == 0 { "value" } else { "and" },
                docs: info.and_then(UnnamedField::docs),
                range: info.and_then(SettingRange::of_unnamed),
                depth,
            };
            let default = default.and_then(|it| it.field(index));
            if let Some(part) = value.field_mut(index) {
                edited |= self.field(ui, field, part, default);
            }
        }
        edited
    }

    /// A value's row and those of its parts.
    fn field(
        &self,
        ui: &mut Ui,
        field: Field,
        value: &mut dyn PartialReflect,
        default: Option<&dyn PartialReflect>,
    ) -> bool {
        let equal = default.and_then(|default| value.reflect_partial_eq(default));
        let output = ui
            .push_id(field.name, |ui| {
                row(ui, field, equal == Some(false), |ui, label| {
                    leaf(ui, label, value, field.range)
                        .unwrap_or_else(|| self.choice(ui, label, value, field.range))
                })
            })
            .inner;
        let mut edited = output.edited;
        if let Some(default) = default.filter(|_| output.reset) {
            edited |= value.try_apply(default).is_ok();
        }
        if has_widget(value) {
            return edited;
        }
        let inside = field.depth + 1;
        edited
            | ui.push_id((field.name, "parts"), |ui| match value.reflect_mut() {
                ReflectMut::Struct(it) => self.structure(ui, it, default, inside),
                ReflectMut::TupleStruct(it) => self.tuple(ui, it, default, inside),
                ReflectMut::Enum(it) => self.variant_parts(ui, field, it, default),
                _ => false,
            })
            .inner
    }

    /// The widget in the row of a value with parts: a list of its variants or presets.
    fn choice(
        &self,
        ui: &mut Ui,
        label: Id,
        value: &mut dyn PartialReflect,
        range: Option<&SettingRange>,
    ) -> bool {
        match value.reflect_ref() {
            _ if is_handle(value) => {
                ui.label(RichText::new("an asset").weak());
                false
            }
            ReflectRef::Enum(_) => self.variants(ui, label, value, range),
            ReflectRef::Struct(_) | ReflectRef::TupleStruct(_) => {
                self.presets(ui, label, value, VALUE)
            }
            ReflectRef::List(list) => {
                ui.label(RichText::new(format!("{} values", list.len())).weak());
                false
            }
            _ => {
                ui.label(RichText::new("not editable").weak());
                false
            }
        }
    }

    /// A list of presets, where there are some.
    pub(super) fn presets(
        &self,
        ui: &mut Ui,
        label: Id,
        value: &mut dyn PartialReflect,
        width: f32,
    ) -> bool {
        let Some(presets) = ReflectPresets::of(value, self.registry) else {
            return false;
        };
        let name = presets.name_of(value);
        let mut edited = false;
        let list = ComboBox::from_id_salt("presets")
            .width(width)
            .selected_text(name.unwrap_or("custom"));
        list.show_ui(ui, |ui| {
            for (preset, values) in presets.values() {
                if ui.selectable_label(name == Some(preset), preset).clicked() {
                    edited |= value.try_apply(values.as_partial_reflect()).is_ok();
                }
            }
        })
        .response
        .labelled_by(label);
        edited
    }
}

/// Whether a value with parts is edited as a whole.
fn has_widget(value: &dyn PartialReflect) -> bool {
    let id = value.get_represented_type_info().map(TypeInfo::type_id);
    let wholes = [
        TypeId::of::<LinearRgba>(),
        TypeId::of::<Color>(),
        TypeId::of::<Vec2>(),
        TypeId::of::<Vec3>(),
        TypeId::of::<Vec4>(),
    ];
    id.is_some_and(|id| wholes.contains(&id)) || is_handle(value)
}

/// Whether a value is a handle to an asset, whose variants are not to be chosen.
fn is_handle(value: &dyn PartialReflect) -> bool {
    let paths = value
        .get_represented_type_info()
        .map(TypeInfo::type_path_table);
    paths.is_some_and(|paths| {
        paths.crate_name() == Some("bevy_asset") && paths.ident() == Some("Handle")
    })
}
