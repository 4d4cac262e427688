//! Live simulation against what is known in closed form, and that nothing leaks, whatever happens.

mod background;
mod cost;
mod coupling;
mod edits;
mod leaks;
mod life;
mod limits;
mod meshes;
mod pool;
mod relocation;
mod rest;
