//! Settings as the Rust code that makes them.

use std::fmt::Write;

use bevy::{
    prelude::*,
    reflect::{
        PartialReflect, ReflectRef, TypeRegistry,
        enums::{Enum, VariantType},
        prelude::ReflectDefault,
        structs::Struct,
    },
};
use core::time::Duration;

/// The Rust expression of a reflected value, laid out as `rustfmt` does it. Of structs with a
/// registered `Default`, only the fields that differ from it are listed, and `..default()` stands
/// for the rest. It compiles with Bevy's prelude and the value's types in scope.
///
/// What has no literal, such as long lists and handles, is left to the default and noted in a
/// comment; a value that has none itself is `default()`.
///
/// ```
/// use bevy::{prelude::*, reflect::TypeRegistry};
/// use bevy_fluid::{SurfaceKernel, inspector::rust_code};
///
/// let mut registry = TypeRegistry::new();
/// registry.register::<SurfaceKernel>();
/// let kernel = SurfaceKernel {
///     max_ratio: 2.0,
///     ..default()
/// };
/// let code = "SurfaceKernel {\n    max_ratio: 2.0,\n    ..default()\n}";
/// assert_eq!(rust_code(&kernel, &registry), code);
/// ```
pub fn rust_code(value: &dyn PartialReflect, registry: &TypeRegistry) -> String {
    Writer { registry }
        .expression(value, 0)
        .unwrap_or_else(|| "default()".into())
}

/// Lists that are longer are left out.
const LONGEST_LIST: usize = 16;

struct Writer<'a> {
    registry: &'a TypeRegistry,
}

impl Writer<'_> {
    /// `None` for what has no literal.
    fn expression(&self, value: &dyn PartialReflect, depth: usize) -> Option<String> {
        if let Some(literal) = literal(value) {
            return Some(literal);
        }
        let all = |values: &mut dyn Iterator<Item = &dyn PartialReflect>| {
            values
                .map(|value| self.expression(value, depth))
                .collect::<Option<Vec<_>>>()
                .map(|values| values.join(", "))
        };
        let ident = value
            .get_represented_type_info()
            .and_then(|info| info.type_path_table().ident());
        match value.reflect_ref() {
            ReflectRef::Struct(it) => self.structure(it, ident?, depth),
            ReflectRef::TupleStruct(it) => {
                Some(format!("{}({})", ident?, all(&mut it.iter_fields())?))
            }
            ReflectRef::Tuple(it) if it.field_len() == 1 => {
                Some(format!("({},)", all(&mut it.iter_fields())?))
            }
            ReflectRef::Tuple(it) => Some(format!("({})", all(&mut it.iter_fields())?)),
            ReflectRef::Array(it) => Some(format!("[{}]", all(&mut it.iter())?)),
            ReflectRef::List(it) if it.len() <= LONGEST_LIST => {
                Some(format!("vec![{}]", all(&mut it.iter())?))
            }
            ReflectRef::Enum(it) => self.variant(it, ident?, depth),
            _ => None,
        }
    }

    fn structure(&self, value: &dyn Struct, ident: &str, depth: usize) -> Option<String> {
        let default = value
            .get_represented_type_info()
            .and_then(|info| {
                self.registry
                    .get_type_data::<ReflectDefault>(info.type_id())
            })
            .map(ReflectDefault::default);
        let default = default
            .as_deref()
            .and_then(|it| it.reflect_ref().as_struct().ok());
        let mut body = Body::new(depth);
        for (name, field) in value.iter_fields() {
            let same = default
                .and_then(|default| default.field(name)?.reflect_partial_eq(field))
                .unwrap_or(false);
            if same {
                body.rest = true;
                continue;
            }
            match self.expression(field, depth + 1) {
                Some(code) => body.line(&format!("{name}: {code},")),
                // Without a default there is nothing to leave it to.
                None if default.is_none() => return None,
                None => {
                    body.line(&format!("// {name}: {}", what(field)));
                    body.rest = true;
                }
            }
        }
        Some(body.after(ident))
    }

    fn variant(&self, value: &dyn Enum, ident: &str, depth: usize) -> Option<String> {
        let name = match (ident, value.variant_name()) {
            ("Option", name) => name.to_owned(),
            (_, name) => format!("{ident}::{name}"),
        };
        match value.variant_type() {
            VariantType::Unit => Some(name),
            VariantType::Tuple => {
                let fields = value
                    .iter_fields()
                    .map(|field| self.expression(field.value(), depth))
                    .collect::<Option<Vec<_>>>()?;
                Some(format!("{name}({})", fields.join(", ")))
            }
            VariantType::Struct => {
                let mut fields = Vec::new();
                for field in value.iter_fields() {
                    let code = self.expression(field.value(), depth + 1)?;
                    fields.push(format!("{}: {code}", field.name()?));
                }
                let short = format!("{name} {{ {} }}", fields.join(", "));
                // As rustfmt breaks small structs.
                if short.len() <= 40 && !short.contains('\n') {
                    return Some(short);
                }
                let mut body = Body::new(depth);
                for field in fields {
                    body.line(&format!("{field},"));
                }
                Some(body.after(&name))
            }
        }
    }
}

/// The lines between the braces of a struct.
struct Body {
    depth: usize,
    lines: String,
    /// Fields are missing.
    rest: bool,
}

impl Body {
    fn new(depth: usize) -> Self {
        Self {
            depth,
            lines: String::new(),
            rest: false,
        }
    }

    fn line(&mut self, line: &str) {
        let _ = writeln!(self.lines, "{}{line}", "    ".repeat(self.depth + 1));
    }

    fn after(mut self, name: &str) -> String {
        if self.lines.is_empty() && self.rest {
            return format!("{name}::default()");
        }
        if self.rest {
            self.line("..default()");
        }
        let indent = "    ".repeat(self.depth);
        format!("{name} {{\n{}{indent}}}", self.lines)
    }
}

/// What stands in the comment for a field without a literal.
fn what(field: &dyn PartialReflect) -> String {
    match field.reflect_ref() {
        ReflectRef::List(list) => format!("{} of them", list.len()),
        _ => "has no literal".into(),
    }
}

/// Numbers, words, colours and vectors.
fn literal(value: &dyn PartialReflect) -> Option<String> {
    macro_rules! numbers {
        ($($type:ty),+) => {
            $(if let Some(number) = value.try_downcast_ref::<$type>() {
                return Some(format!("{number:?}"));
            })+
        };
    }
    numbers!(bool, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
    if let Some(number) = value.try_downcast_ref::<f32>() {
        return Some(float(*number));
    }
    if let Some(number) = value.try_downcast_ref::<f64>() {
        return Some(if number.is_finite() {
            format!("{number:?}")
        } else {
            format!("f64::from({})", float(*number as f32))
        });
    }
    if let Some(text) = value.try_downcast_ref::<String>() {
        return Some(format!("String::from({text:?})"));
    }
    if let Some(time) = value.try_downcast_ref::<Duration>() {
        return Some(format!(
            "core::time::Duration::from_secs_f64({:?})",
            time.as_secs_f64()
        ));
    }
    if let Some(color) = value.try_downcast_ref::<LinearRgba>() {
        let [r, g, b, a] = color.to_f32_array();
        return Some(if a == 1.0 {
            format!("LinearRgba::rgb({})", floats(&[r, g, b]))
        } else {
            format!("LinearRgba::new({})", floats(&[r, g, b, a]))
        });
    }
    let vector = |name: &str, of: &[f32]| Some(format!("{name}({})", floats(of)));
    if let Some(v) = value.try_downcast_ref::<Vec2>() {
        return vector("vec2", &v.to_array());
    }
    if let Some(v) = value.try_downcast_ref::<Vec3>() {
        return vector("vec3", &v.to_array());
    }
    if let Some(v) = value.try_downcast_ref::<Vec4>() {
        return vector("vec4", &v.to_array());
    }
    if let Some(rotation) = value.try_downcast_ref::<Quat>() {
        return vector("Quat::from_xyzw", &rotation.to_array());
    }
    None
}

fn float(number: f32) -> String {
    match number {
        _ if number.is_nan() => "f32::NAN".into(),
        f32::INFINITY => "f32::INFINITY".into(),
        f32::NEG_INFINITY => "f32::NEG_INFINITY".into(),
        _ => format!("{number:?}"),
    }
}

fn floats(numbers: &[f32]) -> String {
    let numbers: Vec<_> = numbers.iter().map(|number| float(*number)).collect();
    numbers.join(", ")
}

#[cfg(test)]
mod tests;
