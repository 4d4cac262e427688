//! Numbers as files hold them: binary of several types, or words.

use half::f16;

use super::{found::Fault, scan::shown};

/// The type of a binary number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Number {
    /// Unit: bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// The number in these bytes, the most significant first.
    pub(super) fn big_endian<'a>(self, bytes: impl IntoIterator<Item = &'a u8>) -> f64 {
        let append = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        let bits = bytes.into_iter().fold(0, append);
        match self {
            Self::I8 => (bits as i8).into(),
            Self::U8 => (bits as u8).into(),
            Self::I16 => (bits as i16).into(),
            Self::U16 => (bits as u16).into(),
            Self::I32 => (bits as i32).into(),
            Self::U32 => (bits as u32).into(),
            Self::I64 => bits as i64 as f64,
            Self::U64 => bits as f64,
            Self::F16 => f16::from_bits(bits as u16).into(),
            Self::F32 => f32::from_bits(bits as u32).into(),
            Self::F64 => f64::from_bits(bits),
        }
    }

    /// The number in these bytes, the least significant first.
    pub(super) fn little_endian(self, bytes: &[u8]) -> f64 {
        self.big_endian(bytes.iter().rev())
    }
}

/// The number that a word says, in any of the ways that C, Fortran and their compilers print it.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let text = str::from_utf8(word).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let text = text.to_ascii_lowercase();
    let unsigned = text.trim_start_matches(['+', '-']);
    let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
    if unsigned.starts_with("nan(") || unsigned.starts_with("1.#qnan") {
        return Some(f64::NAN);
    }
    if unsigned.starts_with("1.#ind") || unsigned.starts_with("1.#snan") {
        return Some(f64::NAN);
    }
    if unsigned.starts_with("1.#inf") {
        return Some(sign * f64::INFINITY);
    }
    // Fortran's double precision: 0.1D+01.
    text.replace('d', "e").parse().ok()
}

/// Why a word on this line is none.
pub(super) fn no_number(word: &[u8], line: usize) -> Fault {
    let word_shown = shown(word);
    if word.contains(&b',') {
        Fault::Unsupported(format!(
            "line {line}: {word_shown} is no number; decimal points and blanks are expected, no commas"
        ))
    } else {
        Fault::Damaged(format!("line {line}: {word_shown} is no number"))
    }
}
