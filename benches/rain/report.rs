//! The table and its summary.

use std::{fmt::Write, fs, path::Path};

use anyhow::Context;

use super::measure::Row;

/// How many times faster than drops one by one streaks are to be, at 10 mm/h and 10 m.
const WANTED: f64 = 10.0;

pub(crate) fn write(
    out: &Path,
    bake_ms: f64,
    exposures: &[(f32, Vec<f64>)],
    rows: &[Row],
    quick: bool,
) -> anyhow::Result<()> {
    let failed = || format!("cannot write to {}", out.display());
    fs::create_dir_all(out).with_context(failed)?;
    let mut table = csv::Writer::from_path(out.join("rain.csv")).with_context(failed)?;
    for row in rows {
        table.serialize(row)?;
    }
    table.flush()?;
    fs::write(
        out.join("rain.md"),
        summary(bake_ms, exposures, rows, quick)?,
    )
    .with_context(failed)?;
    println!("wrote {}", out.display());
    Ok(())
}

fn summary(
    bake_ms: f64,
    exposures: &[(f32, Vec<f64>)],
    rows: &[Row],
    quick: bool,
) -> anyhow::Result<String> {
    let mut text = String::new();
    let adapter = rows.first().map_or("", |row| &row.adapter);
    writeln!(text, "# Rain: speed against error\n")?;
    writeln!(
        text,
        "Written by `cargo bench --package fluid_benches --bench rain{}` on {adapter}, {} threads. Times on a software \
         renderer are ratios, not absolutes.\n",
        if quick { " -- --quick" } else { "" },
        rayon::current_num_threads(),
    )?;
    writeln!(
        text,
        "The textures of streaks take {bake_ms:.0} ms (the rain paper needed 164 s for 24 of them).\n"
    )?;
    writeln!(text, "## Optical depth over βL, 10 m of streaks\n")?;
    writeln!(
        text,
        "| exposure | 1 mm/h | 5 mm/h | 10 mm/h | 20 mm/h |\n|---|---|---|---|---|"
    )?;
    for (exposure, ratios) in exposures {
        write!(text, "| 1/{:.0} s |", 1.0 / exposure)?;
        for ratio in ratios {
            write!(text, " {ratio:.3} |")?;
        }
        writeln!(text)?;
    }
    writeln!(text, "\n## Streaks against every drop by itself\n")?;
    writeln!(
        text,
        "GPU time of the pass, medians, the two in turn. Depth: −ln of the mean transmittance over \
         βL. Difference: RMS of block means of the time-averaged pictures over their mean; in \
         brackets the truth against itself, which is chance. Variance: of pixels over time, streaks \
         over drops.\n"
    )?;
    writeln!(
        text,
        "| size | view | mm/h | m | streaks ms | drops ms | times faster | depth, streaks | depth, drops | difference | variance |\n\
         |---|---|---|---|---|---|---|---|---|---|---|"
    )?;
    for row in rows {
        writeln!(
            text,
            "| {}×{} | {} | {} | {} | {:.1} | {:.1} | {:.1} | {:.3} | {:.3} | {:.3} ({:.3}) | {:.2} |",
            row.width,
            row.height,
            row.view.name(),
            row.rate,
            row.distance,
            row.streaks_ms,
            row.drops_ms,
            row.speedup,
            row.streaks_depth,
            row.drops_depth,
            row.difference,
            row.own_difference,
            row.variance,
        )?;
    }
    let slow: Vec<String> = rows
        .iter()
        .filter(|row| row.rate == 10.0 && row.distance == 10.0 && row.speedup < WANTED)
        .map(|row| format!("{:.1} at {}×{}", row.speedup, row.width, row.height))
        .collect();
    write!(
        text,
        "\nStreaks are to be {WANTED} times faster at 10 mm/h and 10 m. "
    )?;
    if slow.is_empty() {
        writeln!(text, "They are, at every size.")?;
    } else {
        writeln!(text, "They are not everywhere: {}.", slow.join(", "))?;
    }
    Ok(text)
}
