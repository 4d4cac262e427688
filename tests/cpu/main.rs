//! What needs the CPU alone: shaping, emission, live simulation.

#[path = "../../src/shape/oracle.rs"]
#[allow(dead_code, reason = "the unit tests use the rest")]
mod oracle;

mod columns;
mod emitter;
mod headless;
mod random_clouds;
mod readme;
mod salva;
mod settings;
mod shape;
