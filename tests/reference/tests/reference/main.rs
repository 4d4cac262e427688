//! The reference against closed forms.

mod common;

mod camera;
mod edges;
mod ellipsoids;
mod flip;
mod medium;
mod mesh;
mod metrics;
mod sampling;
mod surfaces;
mod tracer;
mod yu_turk;
