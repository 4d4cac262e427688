//! What Rust code asks the heap for, in the whole process.

use std::{
    alloc::System,
    sync::{Mutex, MutexGuard, PoisonError},
};

use stats_alloc::{INSTRUMENTED_SYSTEM, Stats, StatsAlloc};

#[global_allocator]
static RUST: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// All since the process began.
pub(crate) fn stats() -> Stats {
    RUST.stats()
}

/// Memory is counted for the whole process: one test at a time.
pub(crate) fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}
