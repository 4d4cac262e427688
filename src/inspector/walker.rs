//! From reflected values to rows: through structs and enums down to what has a widget.

use bevy::{
    prelude::*,
    reflect::{
        NamedField, PartialReflect, ReflectMut, ReflectRef, TypeInfo, TypeRegistry, UnnamedField,
        enums::{DynamicEnum, DynamicVariant, Enum, VariantInfo},
        prelude::ReflectDefault,
        structs::{DynamicStruct, Struct},
        tuple::DynamicTuple,
        tuple_struct::TupleStruct,
    },
};
use bevy_egui::egui::{ComboBox, Id, RichText, Ui};
use core::any::TypeId;

use super::{
    presets::ReflectPresets,
    widgets::{Field, VALUE, explained, leaf, row},
};
use crate::SettingRange;

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

    /// What stands in the row of a value with parts: a list of its variants or presets.
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

    fn variants(
        &self,
        ui: &mut Ui,
        label: Id,
        value: &mut dyn PartialReflect,
        range: Option<&SettingRange>,
    ) -> bool {
        let Some(TypeInfo::Enum(info)) = value.get_represented_type_info() else {
            return false;
        };
        let Ok(chosen) = value.reflect_ref().as_enum() else {
            return false;
        };
        let chosen = chosen.variant_name().to_owned();
        let mut next = None;
        ComboBox::from_id_salt("variants")
            .width(VALUE)
            .selected_text(chosen.as_str())
            .show_ui(ui, |ui| {
                for variant in info.iter() {
                    let label = ui.selectable_label(variant.name() == chosen, variant.name());
                    if explained(label, variant.docs()).clicked() && variant.name() != chosen {
                        next = Some(variant);
                    }
                }
            })
            .response
            .labelled_by(label);
        let Some(next) = next else {
            return false;
        };
        let Some(parts) = self.new_variant(next, range) else {
            return false;
        };
        value
            .try_apply(&DynamicEnum::new(next.name(), parts))
            .is_ok()
    }

    /// Rows for what a variant holds. A variant's only part goes by the variant's name: the
    /// struct in it, if it is one, is no step of its own.
    fn variant_parts(
        &self,
        ui: &mut Ui,
        field: Field,
        value: &mut dyn Enum,
        default: Option<&dyn PartialReflect>,
    ) -> bool {
        let variant = value
            .get_represented_enum_info()
            .and_then(|info| info.variant_at(value.variant_index()));
        let default = default
            .and_then(|it| it.reflect_ref().as_enum().ok())
            .filter(|it| it.variant_name() == value.variant_name());
        let depth = field.depth + 1;
        let count = value.field_len();
        let mut edited = false;
        for index in 0..count {
            let (name, docs, range, id) = match variant {
                Some(VariantInfo::Struct(info)) => {
                    let Some(info) = info.field_at(index) else {
                        continue;
                    };
                    (
                        info.name(),
                        info.docs(),
                        SettingRange::of(info),
                        info.type_id(),
                    )
                }
                Some(VariantInfo::Tuple(info)) => {
                    let Some(part) = info.field_at(index) else {
                        continue;
                    };
                    let docs = part.docs().or(info.docs());
                    let range = SettingRange::of_unnamed(part).or(field.range);
                    (info.name(), docs, range, part.type_id())
                }
                _ => continue,
            };
            let first = self.first(id, range);
            let default = default
                .and_then(|it| it.field_at(index))
                .or(first.as_deref());
            let Some(part) = value.field_at_mut(index) else {
                continue;
            };
            let structure = matches!(part.reflect_ref(), ReflectRef::Struct(_));
            edited |= if count == 1 && structure && !has_widget(part) {
                self.parts(ui, part, default, depth)
            } else {
                let field = Field {
                    name,
                    docs,
                    range,
                    depth,
                };
                self.field(ui, field, part, default)
            };
        }
        edited
    }

    /// What a variant holds when it is chosen; `None` where some part has no first value. `range`
    /// is that of an option's field, and holds for what is in the option.
    fn new_variant(
        &self,
        variant: &VariantInfo,
        range: Option<&SettingRange>,
    ) -> Option<DynamicVariant> {
        Some(match variant {
            VariantInfo::Unit(_) => DynamicVariant::Unit,
            VariantInfo::Tuple(info) => {
                let mut parts = DynamicTuple::default();
                for part in info.iter() {
                    let range = SettingRange::of_unnamed(part).or(range);
                    parts.insert_boxed(self.first(part.type_id(), range)?);
                }
                DynamicVariant::Tuple(parts)
            }
            VariantInfo::Struct(info) => {
                let mut parts = DynamicStruct::default();
                for part in info.iter() {
                    let first = self.first(part.type_id(), SettingRange::of(part))?;
                    parts.insert_boxed(part.name(), first);
                }
                DynamicVariant::Struct(parts)
            }
        })
    }

    /// A number in its range, or a type's default.
    fn first(&self, id: TypeId, range: Option<&SettingRange>) -> Option<Box<dyn PartialReflect>> {
        if let Some(range) = range {
            macro_rules! numbers {
                ($($type:ty),+) => {
                    $(if id == TypeId::of::<$type>() {
                        return Some(Box::new(range.first() as $type));
                    })+
                };
            }
            numbers!(f32, f64, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
        }
        Some(self.default_of(id)?.into_partial_reflect())
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

/// Whether a value stands for an asset: its variants are nobody's choice.
fn is_handle(value: &dyn PartialReflect) -> bool {
    let paths = value
        .get_represented_type_info()
        .map(TypeInfo::type_path_table);
    paths.is_some_and(|paths| {
        paths.crate_name() == Some("bevy_asset") && paths.ident() == Some("Handle")
    })
}
