//! What is drawn, held against the f64 reference and analytic truth.

#[path = "../common/mod.rs"]
mod common;

mod antialiasing;
mod citizen;
mod classes;
mod debug_views;
mod fallbacks;
mod frames;
mod hard_cases;
mod layers;
mod medium;
mod motion;
mod order;
mod rain;
mod random_cameras;
mod refraction;
mod relocation;
mod sheets;
mod small_particles;
mod smoothing;
mod textures;
