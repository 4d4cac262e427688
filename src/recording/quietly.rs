//! Readers that check their assumptions by panicking.

use std::{
    cell::Cell,
    panic::{self, AssertUnwindSafe},
    sync::Once,
};

thread_local!(static IS_QUIET: Cell<bool> = const { Cell::new(false) });

/// What `read` returns, or `None` where it panics, of which nothing is printed.
///
/// The hook that prints belongs to the whole process, and frames are read in many threads at a time:
/// it is wrapped once, and each thread says for itself whether it is quiet.
pub(super) fn quietly<T>(read: impl FnOnce() -> T) -> Option<T> {
    static WRAPPED: Once = Once::new();
    WRAPPED.call_once(|| {
        let say = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_QUIET.get() {
                say(info);
            }
        }));
    });
    IS_QUIET.set(true);
    let result = panic::catch_unwind(AssertUnwindSafe(read)).ok();
    IS_QUIET.set(false);
    result
}
