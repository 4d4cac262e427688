//! The header of a PLY file.

use super::super::{
    content,
    found::{Fault, Found},
    number::Number,
    scan::{Scan, shown, words},
};

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Property {
    pub(super) name: String,
    /// Of the number of items, where it is a list.
    pub(super) count: Option<Type>,
    pub(super) item: Type,
}

/// A type, or the word that is none. In text, any will do.
pub(super) type Type = Result<Number, String>;

/// The encoding and the elements in their order; then the scan is at the first element.
pub(super) fn read(scan: &mut Scan, found: &mut Found) -> Result<(Encoding, Vec<Element>), Fault> {
    let damaged = |reason: &str| Fault::Damaged(reason.into());
    let all = scan.rest();
    if scan
        .line()
        .is_none_or(|line| !line.eq_ignore_ascii_case(b"ply"))
    {
        let what = content::described(all);
        return Err(Fault::Unsupported(format!("no .ply: {what}")));
    }
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    while let Some(line) = scan.line() {
        let all: Vec<_> = words(line)
            .map(|word| String::from_utf8_lossy(word))
            .collect();
        let all: Vec<_> = all.iter().map(AsRef::as_ref).collect();
        let [keyword, words @ ..] = &all[..] else {
            continue;
        };
        match (keyword.to_ascii_lowercase().as_str(), words) {
            ("comment" | "obj_info", _) => {}
            ("format", [word, ..]) => encoding = Some(encoding_of(word)?),
            ("element", [name, count, ..]) => {
                let count = count.parse().map_err(|_| {
                    let [name, count] = [name, count].map(|word| shown(word.as_bytes()));
                    Fault::Damaged(format!("its number of {name} is {count}"))
                })?;
                elements.push(Element {
                    name: (*name).into(),
                    count,
                    properties: Vec::new(),
                });
            }
            ("property", ["list", count, item, name]) => {
                let element = elements.last_mut();
                let element = element.ok_or_else(|| damaged("a property is of no element"))?;
                element.properties.push(Property {
                    name: (*name).into(),
                    count: Some(type_of(count)),
                    item: type_of(item),
                });
            }
            ("property", [item, name]) => {
                let element = elements.last_mut();
                let element = element.ok_or_else(|| damaged("a property is of no element"))?;
                element.properties.push(Property {
                    name: (*name).into(),
                    count: None,
                    item: type_of(item),
                });
            }
            ("element" | "property" | "format", _) => {
                let (number, line) = (scan.line_number(), shown(line));
                return Err(Fault::Damaged(format!(
                    "line {number}, {line}, is incomplete"
                )));
            }
            ("end_header", _) => {
                let encoding = encoding.ok_or_else(|| damaged("its header has no `format`"))?;
                return Ok((encoding, elements));
            }
            _ => {
                let keyword = shown(keyword.as_bytes());
                found.note(&keyword, format!("its header's {keyword} is left out"));
            }
        }
    }
    Err(damaged("its header does not end"))
}

fn encoding_of(word: &str) -> Result<Encoding, Fault> {
    match word.to_ascii_lowercase().as_str() {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => {
            let word = shown(word.as_bytes());
            Err(Fault::Unsupported(format!(
                "its format is the unknown {word}"
            )))
        }
    }
}

fn type_of(word: &str) -> Type {
    Ok(match word.to_ascii_lowercase().as_str() {
        "char" | "int8" => Number::I8,
        "uchar" | "uint8" | "bool" => Number::U8,
        "short" | "int16" => Number::I16,
        "ushort" | "uint16" => Number::U16,
        "int" | "int32" => Number::I32,
        "uint" | "uint32" => Number::U32,
        "long" | "int64" | "longlong" => Number::I64,
        "ulong" | "uint64" | "ulonglong" => Number::U64,
        "half" | "float16" => Number::F16,
        "float" | "float32" => Number::F32,
        "double" | "float64" => Number::F64,
        _ => return Err(word.into()),
    })
}
