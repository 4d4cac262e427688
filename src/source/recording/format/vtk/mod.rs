//! Legacy VTK.

mod header;
mod read;
mod values;
mod write;

pub(super) use self::{read::read, write::write};
