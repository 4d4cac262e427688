//! Sources: where a fluid's particles come from. None of them knows how they are drawn.

pub(crate) mod emitter;
pub(crate) mod particles;
#[cfg(feature = "recordings")]
pub mod recording;
#[cfg(feature = "salva")]
pub mod salva;
pub(crate) mod solid;
