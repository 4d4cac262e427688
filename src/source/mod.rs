//! Sources: where a fluid's particles come from. None of them knows how they are drawn.

pub mod emitter;
pub mod particles;
#[cfg(feature = "recordings")]
pub mod recording;
#[cfg(feature = "salva")]
pub mod salva;
pub mod solid;
