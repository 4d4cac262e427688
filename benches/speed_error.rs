//! Speed against error: every method with its parameters on every scene, in one run.
//!
//! `cargo bench --package fluid_benches --bench speed_error -- --out DIR`, with `--quick` for a few small pictures,
//! `--scene NAME` and `--method NAME` for a part, `--size WxH` for simulated scenes and those with
//! many edges. The folder gets a table (CSV), plots (SVG and PNG) and a summary.

use std::process::ExitCode;

use fluid_report::{Options, run_apart};

fn main() -> ExitCode {
    // Cargo starts benches in their package's folder: paths are meant from the repository's.
    let _ = std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    fluid_report::exit_code(
        Options::parse_from(std::env::args_os()).and_then(|options| run_apart(&options)),
    )
}
