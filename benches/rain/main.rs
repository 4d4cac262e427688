//! Speed of rain against its error: streaks on billboards beside every drop drawn by itself.
//!
//! `cargo bench --package fluid_benches --bench rain`, with `-- --quick` for fewer and smaller runs and `-- --out DIR` for
//! where the table (`rain.csv`) and the summary (`rain.md`) go. The two methods draw in turn, so
//! that a busy machine slows both.

mod measure;
mod report;

use std::{path::PathBuf, process::ExitCode};

use bevy::math::{UVec2, uvec2};

use measure::{Case, Pair, View, bake_ms, extinction_ratio};

fn main() -> ExitCode {
    // Cargo starts benches in their package's folder: paths are meant from the repository's.
    let _ = std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> anyhow::Result<()> {
    let (mut quick, mut out) = (false, PathBuf::from("docs/rain"));
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--quick" => quick = true,
            "--out" => {
                let value = arguments.next();
                out = value
                    .ok_or_else(|| anyhow::anyhow!("`--out` needs a folder"))?
                    .into();
            }
            // Cargo adds it.
            "--bench" => {}
            _ => anyhow::bail!("unknown option `{argument}`: `--quick`, `--out DIR`"),
        }
    }
    let frames = if quick { 4 } else { 12 };
    let baking = bake_ms(if quick { 3 } else { 9 });
    println!("textures: {baking:.0} ms");

    let mut exposures = Vec::new();
    for exposure in [1.0 / 30.0, 1.0 / 60.0, 1.0 / 120.0] {
        let ratios = extinction_ratio(exposure, &[1.0, 5.0, 10.0, 20.0], 2 * frames)?;
        println!(
            "1/{:.0} s: optical depth over βL {ratios:.3?}",
            1.0 / exposure
        );
        exposures.push((exposure, ratios));
    }

    let mut rows = Vec::new();
    for (size, cases) in plan(quick) {
        let mut pair = Pair::new(size)?;
        for case in cases {
            let row = pair.measure(case, frames)?;
            println!("{row}");
            rows.push(row);
        }
    }
    report::write(&out, baking, &exposures, &rows, quick)
}

/// What is measured at which size.
fn plan(quick: bool) -> Vec<(UVec2, Vec<Case>)> {
    let seen = |rate, distance, view| Case {
        rate,
        distance,
        view,
    };
    let case = |rate, distance| seen(rate, distance, View::Perspective);
    let others = [View::Multisampled, View::Orthographic].map(|view| seen(10.0, 10.0, view));
    if quick {
        let mut few = vec![case(10.0, 5.0), case(10.0, 10.0)];
        few.extend(others);
        return vec![(uvec2(320, 180), few)];
    }
    let all = [5.0, 10.0]
        .into_iter()
        .flat_map(|distance| [1.0, 5.0, 10.0, 20.0].map(|rate| case(rate, distance)))
        .chain(others);
    vec![
        (uvec2(320, 180), vec![case(10.0, 5.0), case(10.0, 10.0)]),
        (uvec2(640, 360), all.collect()),
        (uvec2(1280, 720), vec![case(10.0, 5.0), case(10.0, 10.0)]),
    ]
}
