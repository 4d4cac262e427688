//! The elements after a PLY file's header, one after the other.

use super::{
    super::{
        found::Fault,
        number::{Number, no_number, number},
        scan::{Scan, words},
    },
    header::{Element, Encoding, Property, Type},
};

/// Takes the number of a property of an element, or why it is none.
pub(super) type Sink<'a> = dyn FnMut(usize, Result<f64, Fault>) + 'a;

/// Passes all of an element; what is a list is passed over.
pub(super) fn read(
    scan: &mut Scan,
    encoding: Encoding,
    element: &Element,
    sink: &mut Sink,
) -> Result<(), Fault> {
    // Any number of elements of nothing fits in any file.
    if element.properties.is_empty() {
        return Ok(());
    }
    for index in 0..element.count {
        let is_whole = match encoding {
            Encoding::Text => text(scan, &element.properties, sink)?,
            _ => binary(scan, encoding, &element.properties, sink)?.is_some(),
        };
        if !is_whole {
            let (count, name) = (element.count, element.name.escape_debug());
            let reason = format!("it claims {count} of `{name}` and holds {index}");
            return Err(Fault::Damaged(reason));
        }
    }
    Ok(())
}

/// Whether there is another line with an element.
fn text(scan: &mut Scan, properties: &[Property], sink: &mut Sink) -> Result<bool, Fault> {
    let line = loop {
        match scan.line() {
            None => return Ok(false),
            Some([]) => {}
            Some(line) => break line,
        }
    };
    let at = *scan;
    let cut = |is_short| {
        let line = at.line_number();
        let than = if is_short { "fewer" } else { "more" };
        Fault::Damaged(format!("line {line} has {than} numbers than properties"))
    };
    let mut words = words(line);
    for (index, property) in properties.iter().enumerate() {
        let word = words.next().ok_or_else(|| cut(true))?;
        let value = number(word).ok_or_else(|| no_number(word, at.line_number()));
        if property.count.is_none() {
            sink(index, value);
            continue;
        }
        let items = value? as usize;
        if items > 0 && words.nth(items - 1).is_none() {
            return Err(cut(true));
        }
    }
    match words.next() {
        None => Ok(true),
        Some(_) => Err(cut(false)),
    }
}

/// None where the bytes end.
fn binary(
    scan: &mut Scan,
    encoding: Encoding,
    properties: &[Property],
    sink: &mut Sink,
) -> Result<Option<()>, Fault> {
    for (index, property) in properties.iter().enumerate() {
        let item = known(&property.item, property)?;
        let Some(count) = &property.count else {
            let Some(value) = value(scan, encoding, item) else {
                return Ok(None);
            };
            sink(index, Ok(value));
            continue;
        };
        let items = value(scan, encoding, known(count, property)?);
        let size = items.and_then(|items| (items as usize).checked_mul(item.size()));
        if size.and_then(|size| scan.take(size)).is_none() {
            return Ok(None);
        }
    }
    Ok(Some(()))
}

fn value(scan: &mut Scan, encoding: Encoding, number: Number) -> Option<f64> {
    let bytes = scan.take(number.size())?;
    Some(match encoding {
        Encoding::BigEndian => number.big_endian(bytes),
        _ => number.little_endian(bytes),
    })
}

fn known(number: &Type, property: &Property) -> Result<Number, Fault> {
    number.as_ref().copied().map_err(|word| {
        let [name, word] = [&property.name, word].map(|text| text.escape_debug());
        Fault::Unsupported(format!(
            "its property `{name}` is of the unknown type `{word}`"
        ))
    })
}
