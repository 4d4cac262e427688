//! What reads and writes files: recordings, the report, and the examples as programs.

mod examples;
mod program;
mod recording;
mod speed_error;
mod viewer;
