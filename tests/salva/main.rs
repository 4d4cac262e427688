//! Live simulation against what is known in closed form, and that nothing leaks, whatever happens.

#![cfg(feature = "salva")]

mod cost;
mod coupling;
mod leaks;
mod life;
mod limits;
mod pool;
mod rest;
