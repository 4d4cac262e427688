//! How far pictures are from the mean of many that see other places of each pixel.
//!
//! `cargo bench --package fluid_benches --bench aliasing -- --out DIR`, with `--scene NAME`,
//! `--method NAME`, `--size WxH` and `--jitters N` for a part, and `--still` for no moving camera.
//! With `--truths DIR` the truths are kept there: the next run, after a change of how pictures are
//! antialiased, draws its own pictures alone. Prints a line for each scene and method; the folder gets the pictures, their truths, maps of the
//! errors, and crops.

use std::process::ExitCode;

use fluid_report::{Options, aliasing};

fn main() -> ExitCode {
    // Cargo starts benches in their package's folder: paths are meant from the repository's.
    let _ = std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    fluid_report::exit_code(
        Options::parse_from(std::env::args_os()).and_then(|options| aliasing::run(&options)),
    )
}
