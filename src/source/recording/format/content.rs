//! What bytes are, whatever their file is called.

use super::scan::shown;

/// How files begin. Four bytes at least: particles may begin with any three.
const SIGNATURES: [(&[u8], &str); 19] = [
    (b"<?xml", "XML"),
    (b"<VTKFile", "XML"),
    (b"<!DOCTYPE", "a web page"),
    (b"<!doctype", "a web page"),
    (b"<html", "a web page"),
    (
        b"version https://git-lfs",
        "a pointer of Git LFS, whose file was not fetched",
    ),
    (b"# vtk ", "a legacy .vtk"),
    (b"BgeoV", "a classic .bgeo"),
    (b"ply\n", "a .ply"),
    (b"ply\r", "a .ply"),
    (
        b"\x7fNSJ",
        "a .bgeo of Houdini 12 or newer; as .bhclassic Houdini saves what is read",
    ),
    (b"PGEOMETRY", "a text .geo"),
    (b"scf1", "compressed with Blosc"),
    (b"PK\x03\x04", "a zip archive"),
    (b"\x28\xb5\x2f\xfd", "compressed with Zstandard"),
    (b"\x89HDF", "HDF5"),
    (b"\x89PNG", "a PNG"),
    (b"GIF8", "a GIF"),
    (b"Ogawa", "Alembic"),
];

/// The kind of file that begins like this, if it is well known.
pub(super) fn kind(bytes: &[u8]) -> Option<&'static str> {
    if is_utf16(bytes) {
        return Some("text in UTF-16; UTF-8 is expected");
    }
    let known = SIGNATURES
        .iter()
        .find(|(start, _)| bytes.starts_with(start));
    known.map(|&(_, kind)| kind)
}

/// What a file is that is not what its name says.
pub(super) fn described(bytes: &[u8]) -> String {
    match (kind(bytes), bytes.split(|&byte| byte == b'\n').next()) {
        (Some(kind), _) => format!("it is {kind}"),
        (None, Some(start @ [_, ..])) => format!("it begins with {}", shown(start.trim_ascii())),
        _ => "it begins with nothing".into(),
    }
}

/// Whether these bytes are printable text, in UTF-8 or nearly ASCII. Of floats hardly any are.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let is_blank = |byte: u8| byte.is_ascii_whitespace() || byte == 0x0b;
    let is_control = |&byte: &u8| byte.is_ascii_control() && !is_blank(byte);
    if bytes.is_empty() || bytes.iter().any(is_control) {
        return false;
    }
    let ascii = bytes.iter().filter(|byte| byte.is_ascii()).count();
    str::from_utf8(bytes).is_ok() || ascii >= bytes.len() - bytes.len() / 10
}

fn is_utf16(bytes: &[u8]) -> bool {
    let (pairs, rest) = bytes.as_chunks::<2>();
    let units: fn([u8; 2]) -> u16 = match pairs.first() {
        Some([0xff, 0xfe]) => u16::from_le_bytes,
        Some([0xfe, 0xff]) => u16::from_be_bytes,
        _ => return false,
    };
    let is_printable =
        |read: Result<char, _>| read.is_ok_and(|read| !read.is_control() || read.is_whitespace());
    rest.is_empty() && char::decode_utf16(pairs.iter().copied().map(units)).all(is_printable)
}
