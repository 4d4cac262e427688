//! What is logged of files that are read all the same.

use std::{
    collections::BTreeSet,
    sync::{Mutex, PoisonError},
};

use bevy::prelude::*;

use super::format::Note;

/// So many notes are remembered; more are not logged.
const MOST: usize = 1000;

/// Logs a note on a file, unless one on the same subject has been logged of a file of its series: one whose
/// name differs in its numbers alone.
pub(super) fn log_once(name: &str, note: &Note) {
    static LOGGED: Mutex<BTreeSet<(String, String)>> = Mutex::new(BTreeSet::new());
    let series = name.replace(|letter: char| letter.is_ascii_digit(), "");
    let mut logged = LOGGED.lock().unwrap_or_else(PoisonError::into_inner);
    if logged.len() < MOST && logged.insert((series, note.subject.clone())) {
        warn!("{name}: {}", note.text);
    }
}
