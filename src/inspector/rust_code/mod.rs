//! Settings as the Rust code that makes them.

mod literal;
mod spawn;
#[cfg(all(test, feature = "published"))]
mod tests;

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

use self::literal::literal;
pub use self::spawn::spawn_code;

/// The Rust expression of a reflected value, formatted as by `rustfmt`. For structs with a
/// registered `Default`, only the fields that differ from it are listed, with `..default()` for the
/// rest. It compiles with Bevy's prelude and the value's types in scope.
///
/// Fields without a literal, such as long lists and handles, are left to the default and noted in a
/// comment; a value without a literal is written as `default()`.
///
/// ```
/// use bevy::{prelude::*, reflect::TypeRegistry};
/// use bevy_fluid::{prelude::SurfaceKernel, inspector::rust_code};
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

/// The comment for a field without a literal.
fn what(field: &dyn PartialReflect) -> String {
    match field.reflect_ref() {
        ReflectRef::List(list) => format!("{} of them", list.len()),
        _ => "has no literal".into(),
    }
}
