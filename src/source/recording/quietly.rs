//! Readers that panic on invalid input.

use std::{
    cell::Cell,
    panic::{self, AssertUnwindSafe},
    sync::Once,
};

thread_local!(static IS_QUIET: Cell<bool> = const { Cell::new(false) });

/// The result of `read`, or `None` if it panics, without printing the panic.
///
/// The panic hook belongs to the whole process, and frames are read on many threads at a time: it
/// is wrapped once, and each thread has its own flag that silences it.
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
