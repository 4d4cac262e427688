//! Speed against error: every method with its parameters on every scene, in one run.
//!
//! `cargo bench --package fluid_benches --bench speed_error -- --out DIR`, with `--quick` for a few small pictures,
//! `--scene NAME` and `--method NAME` for a part, `--size WxH` for the two simulated scenes. The
//! folder gets a table (CSV), plots (SVG and PNG) and a summary.

use std::process::ExitCode;

use fluid_report::{Options, run_apart};

fn main() -> ExitCode {
    // Cargo starts benches in their package's folder: paths are meant from the repository's.
    let _ = std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    match Options::parse_from(std::env::args_os()).and_then(|options| run_apart(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if error.exit_code() == 0 {
                print!("{error}");
            } else {
                eprintln!("{}", error.to_string().trim_end());
            }
            ExitCode::from(error.exit_code())
        }
    }
}
