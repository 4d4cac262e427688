//! PLY.

mod header;
mod read;
mod rows;
mod write;

pub(super) use self::{read::read, write::write};
