//! What is allocated. A binary of its own, as its allocator counts for the whole process.

#[path = "../common/mod.rs"]
mod common;

mod allocations;
mod heap;
mod soak;
