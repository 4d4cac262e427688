//! The stage, and that the texels it reads are those that were drawn.

mod arguments;
mod headless;
mod picture;
mod pipelines;
mod read;
