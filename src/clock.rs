//! The clock that measures how long work takes.

use bevy::platform::time::Instant;

/// This moment, on the web too. It is the only way to it: on other platforms Bevy's `Instant` is
/// the standard library's, and no lint could tell the two apart.
#[expect(clippy::disallowed_methods, reason = "this is the only place")]
pub(crate) fn now() -> Instant {
    Instant::now()
}
