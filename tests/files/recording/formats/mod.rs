//! What other programs write: read, or refused by what it is.

mod bgeo;
mod content;
mod ply;
mod vtk;
mod xyz;

use bevy::prelude::*;
use bevy_fluid::recording::{FrameError, ParticleFrame};
use fluid_stage::log;

/// What is in a file of this name and content. Names are of one test each, as the log is of all.
#[track_caller]
fn parse(name: &str, content: impl AsRef<[u8]>) -> ParticleFrame {
    log::listen();
    ParticleFrame::parse(name, content.as_ref()).unwrap_or_else(|error| panic!("{error}"))
}

/// The same of two particles at the origin and a metre to the right.
#[track_caller]
fn two(name: &str, content: impl AsRef<[u8]>) -> ParticleFrame {
    let frame = parse(name, content);
    assert_eq!(frame.positions, [Vec3::ZERO, Vec3::X], "{name}");
    frame
}

/// The same with ids 7 and 8.
#[track_caller]
fn seven_and_eight(name: &str, content: impl AsRef<[u8]>) {
    assert_eq!(two(name, content).ids, [7, 8], "{name}");
}

/// Refused for what it is, which is no damage.
#[track_caller]
fn refused(name: &str, content: impl AsRef<[u8]>, reason: &str) {
    let error = ParticleFrame::parse(name, content.as_ref()).unwrap_err();
    assert!(matches!(error, FrameError::Unsupported { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains(name) && text.contains(reason), "{text}");
    assert!(!text.contains("damage"), "{text}");
}

#[track_caller]
fn damaged(name: &str, content: impl AsRef<[u8]>, reason: &str) {
    let error = ParticleFrame::parse(name, content.as_ref()).unwrap_err();
    assert!(matches!(error, FrameError::Damaged { .. }), "{error}");
    let text = error.to_string();
    assert!(text.contains(name) && text.contains(reason), "{text}");
}

/// Lines of the log about a file.
fn logged(name: &str, part: &str) -> usize {
    log::count(&format!("{name}: its {part}"))
}

/// Words for numbers that are not finite, and a finite one that C calls out of range.
const NOT_FINITE: [(&str, bool); 12] = [
    ("nan", false),
    ("NaN", false),
    ("-nan", false),
    ("-nan(ind)", false),
    ("nan(snan)", false),
    ("1.#QNAN", false),
    ("-1.#IND", false),
    ("inf", false),
    ("-inf", false),
    ("1.#INF", false),
    ("1e400", false),
    ("1e-320", true),
];

/// The first of two particles has `word` for its x.
#[track_caller]
fn first_is_finite(frame: &ParticleFrame, word: &str, is_finite: bool) {
    assert_eq!(frame.positions.len(), 2, "{word}");
    assert_eq!(frame.positions[0].is_finite(), is_finite, "{word}");
    assert_eq!(frame.positions[1], Vec3::X, "{word}");
}
