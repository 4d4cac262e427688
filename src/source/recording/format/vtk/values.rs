//! The numbers between the lines of a legacy `.vtk`.

use super::super::{
    found::Fault,
    number::{Number, no_number, number},
    scan::{Scan, shown},
};

/// Numbers as they lie in a file.
pub(super) enum Values<'a> {
    Text(Vec<f64>),
    /// Big-endian.
    Binary(Number, &'a [u8]),
    /// Not numbers, or of an unknown size; why.
    Unknown(Fault),
}

impl<'a> Values<'a> {
    /// The next `count` numbers of type `kind`, or an error if the file ends in them. What is not
    /// numbers is not passed.
    pub(super) fn read(
        scan: &mut Scan<'a>,
        is_text: bool,
        kind: &[u8],
        count: usize,
    ) -> Result<Self, Fault> {
        let kind = kind.to_ascii_lowercase();
        if kind.ends_with(b"string") {
            return Ok(Self::Unknown(Fault::Unsupported("it holds strings".into())));
        }
        if is_text {
            // Whatever the type is called, numbers are numbers.
            return Self::text(scan, count);
        }
        if kind == b"bit" {
            binary(scan, count, Some(count.div_ceil(8)))?;
            return Ok(Self::Unknown(Fault::Unsupported("it holds bits".into())));
        }
        let Some(number) = type_of(&kind) else {
            let reason = format!("its type {} is unknown", shown(&kind));
            return Ok(Self::Unknown(Fault::Unsupported(reason)));
        };
        let bytes = binary(scan, count, count.checked_mul(number.size()))?;
        Ok(Self::Binary(number, bytes))
    }

    fn text(scan: &mut Scan, count: usize) -> Result<Self, Fault> {
        let mut numbers = Vec::new();
        while numbers.len() < count {
            let before = *scan;
            let Some(word) = scan.word() else {
                let there = numbers.len();
                return Err(Fault::Damaged(format!(
                    "{count} numbers are claimed where it holds {there}"
                )));
            };
            let Some(number) = number(word) else {
                let fault = no_number(word, scan.line_number());
                *scan = before;
                return Ok(Self::Unknown(fault));
            };
            numbers.push(number);
        }
        Ok(Self::Text(numbers))
    }

    pub(super) fn numbers(self) -> Result<Vec<f64>, Fault> {
        match self {
            Self::Text(numbers) => Ok(numbers),
            Self::Binary(number, bytes) => {
                let numbers = bytes.chunks_exact(number.size());
                Ok(numbers.map(|bytes| number.big_endian(bytes)).collect())
            }
            Self::Unknown(fault) => Err(fault),
        }
    }
}

fn binary<'a>(scan: &mut Scan<'a>, count: usize, size: Option<usize>) -> Result<&'a [u8], Fault> {
    let there = scan.rest().len();
    size.and_then(|size| scan.take(size)).ok_or_else(|| {
        Fault::Damaged(format!(
            "{count} numbers are claimed where it holds {there} bytes"
        ))
    })
}

/// The binary type of this name in lower case.
fn type_of(kind: &[u8]) -> Option<Number> {
    Some(match kind {
        b"char" | b"signed_char" | b"vtktypeint8" => Number::I8,
        b"unsigned_char" | b"vtktypeuint8" => Number::U8,
        b"short" | b"vtktypeint16" => Number::I16,
        b"unsigned_short" | b"vtktypeuint16" => Number::U16,
        // VTK's ids have 64 bits in memory and 32 in these files.
        b"int" | b"vtktypeint32" | b"vtkidtype" => Number::I32,
        b"unsigned_int" | b"vtktypeuint32" => Number::U32,
        b"long" | b"long_long" | b"vtktypeint64" => Number::I64,
        b"unsigned_long" | b"unsigned_long_long" | b"vtktypeuint64" => Number::U64,
        b"float" | b"vtktypefloat32" => Number::F32,
        b"double" | b"vtktypefloat64" => Number::F64,
        _ => return None,
    })
}
