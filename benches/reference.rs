//! The tracer's pictures and the figures of their scenes, for another path tracer to check:
//! `scripts/reference` does.
//!
//! `cargo bench --package fluid_benches --bench reference -- --out DIR`, with `--scene NAME` for a part.

use std::process::ExitCode;

use fluid_report::reference;

fn main() -> ExitCode {
    // Cargo starts benches in their package's folder: paths are meant from the repository's.
    let _ = std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    fluid_report::exit_code(reference::run(std::env::args_os()))
}
