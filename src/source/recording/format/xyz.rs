//! Positions alone: little-endian `f32` triples, or text.

use bevy::math::Vec3;

use super::{
    content,
    found::{Fault, Found},
    number::{Number, no_number, number},
    scan::{Scan, shown, words},
};
use crate::source::recording::frame::ParticleFrame;

pub(super) fn read(bytes: &[u8]) -> Result<Found, Fault> {
    if let Some(kind) = content::kind(bytes) {
        return Err(Fault::Unsupported(format!(
            "no list of positions: it is {kind}"
        )));
    }
    if content::is_text(bytes) {
        return text(bytes);
    }
    let (triples, rest) = bytes.as_chunks::<12>();
    if !rest.is_empty() {
        let count = bytes.len();
        return Err(Fault::Damaged(format!(
            "it is not a list of binary f32 triples: its {count} bytes are no multiple of 12"
        )));
    }
    let floats = triples.iter().flat_map(|triple| triple.as_chunks::<4>().0);
    let numbers: Vec<_> = floats
        .map(|float| Number::F32.little_endian(float))
        .collect();
    let mut found = Found::default();
    found.set_positions(&numbers);
    Ok(found)
}

/// Lines of three numbers, behind the name of an atom or not. Files of atoms may begin with their
/// number and a title.
fn text(bytes: &[u8]) -> Result<Found, Fault> {
    let mut scan = Scan::new(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes));
    let mut found = Found::default();
    let mut numbers = Vec::new();
    let atoms = atoms(&mut scan)?;
    let mut has_more = false;
    while atoms.is_none_or(|atoms| numbers.len() < 3 * atoms)
        && let Some(line) = scan.line()
    {
        if line.is_empty() || line.starts_with(b"#") || line.starts_with(b"//") {
            continue;
        }
        let words: Vec<_> = words(line).collect();
        let has_name = number(words[0]).is_none() || (atoms.is_some() && words.len() > 3);
        let Some(triple) = words
            .get(usize::from(has_name)..)
            .and_then(<[_]>::first_chunk::<3>)
        else {
            return Err(no_particle(line, &scan));
        };
        for word in triple {
            numbers.push(number(word).ok_or_else(|| no_particle(line, &scan))?);
        }
        has_more |= words.len() > 3 + usize::from(has_name);
    }
    if let Some(atoms) = atoms.filter(|atoms| numbers.len() < 3 * atoms) {
        let there = numbers.len() / 3;
        return Err(Fault::Damaged(format!(
            "it claims {atoms} atoms and holds {there}"
        )));
    }
    if has_more {
        found.note(
            "columns",
            "what follows x, y and z in its lines is left out",
        );
    }
    if atoms.is_some() && scan.word().is_some() {
        found.note("frames", "what follows its first frame is left out");
    }
    found.set_positions(&numbers);
    Ok(found)
}

/// The number of atoms, if the text begins with it; then it goes on after the title.
fn atoms(scan: &mut Scan) -> Result<Option<usize>, Fault> {
    let mut ahead = *scan;
    let first = ahead
        .word()
        .and_then(|word| str::from_utf8(word).ok()?.parse().ok());
    let is_alone = ahead.line().is_some_and(<[_]>::is_empty);
    let Some(atoms) = first.filter(|_| is_alone) else {
        return Ok(None);
    };
    let title = String::from_utf8_lossy(ahead.line().unwrap_or_default());
    if title.contains("Properties=") && !title.contains("Properties=species:S:1:pos:R:3") {
        let reason = "the columns of its atoms do not begin with `species:S:1:pos:R:3`";
        return Err(Fault::Unsupported(reason.into()));
    }
    *scan = ahead;
    Ok(Some(atoms))
}

fn no_particle(line: &[u8], scan: &Scan) -> Fault {
    let number = scan.line_number();
    if let Some(word) = words(line).find(|word| word.contains(&b',')) {
        return no_number(word, number);
    }
    let line = shown(line);
    Fault::Unsupported(format!(
        "it is text, and its line {number} is not `x y z`: {line}"
    ))
}

pub(super) fn write(frame: &ParticleFrame, bytes: &mut Vec<u8>) {
    let numbers = frame.positions.iter().flat_map(Vec3::to_array);
    bytes.extend(numbers.flat_map(f32::to_le_bytes));
}
