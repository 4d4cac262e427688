//! Enums: a list of their variants, and what the chosen one holds.

use bevy::{
    prelude::*,
    reflect::{
        PartialReflect, ReflectRef, TypeInfo,
        enums::{DynamicEnum, DynamicVariant, Enum, VariantInfo},
        structs::DynamicStruct,
        tuple::DynamicTuple,
    },
};
use bevy_egui::egui::{ComboBox, Id, Ui};
use core::any::TypeId;

use super::{Walker, has_widget};
use crate::{
    inspector::widgets::{Field, VALUE, explained},
    settings::SettingRange,
};

impl Walker<'_> {
    pub(super) fn variants(
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

    /// Rows for what a variant holds. A variant's only part has the variant's name; a struct in it
    /// gets no level of its own.
    pub(super) fn variant_parts(
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

    /// The initial content of a variant; `None` where some part has no first value. `range` is that
    /// of an option's field, and holds for what is in the option.
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
                        return Some(Box::new(range.initial_value() as $type));
                    })+
                };
            }
            numbers!(f32, f64, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
        }
        Some(self.default_of(id)?.into_partial_reflect())
    }
}
