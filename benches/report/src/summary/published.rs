//! The thesis's tables in their own layout, with ours beside the published figures.

use crate::{
    Table, methods, scenes,
    thesis::{BILATERAL, EARLIER, METHOD, PASSES, PLANES, Published},
};

use super::markdown::Rows;

pub(super) fn text(table: &Table) -> String {
    let mut out = String::from(
        "Published on a GPU of 2013: compare ratios, not times. The thesis's own totals leave out \
         what its pictures are composed with; ours count the composite with the refraction.\n",
    );
    let presets = [
        (&METHOD, methods::THESIS, "5.1"),
        (&EARLIER, methods::EARLIER, "5.2"),
    ];
    let mut any = false;
    for (published, preset, number) in presets {
        let rows = passes(table, published, preset);
        any |= rows.is_some();
        if let Some(rows) = rows {
            out += &format!("\n### Table {number}: ms a frame, `{preset}`\n\n{rows}");
        }
    }
    for (published, bilaterally, number) in [(&PLANES, false, "5.3"), (&BILATERAL, true, "5.4")] {
        if let Some(rows) = smoothing(table, published, bilaterally) {
            any = true;
            out += &format!("\n### Table {number}: ms of smoothing, `wave`\n\n{rows}");
        }
    }
    if any { out } else { String::new() }
}

/// Per scene and pass: published and ours at both sizes, and the default beside them.
fn passes(table: &Table, published: &[Published], preset: &str) -> Option<String> {
    let mut rows = Rows::new([
        "scene, pass",
        "published 640×480",
        "ours",
        "default",
        "published 1024×768",
        "ours",
        "default",
    ]);
    let mut any = false;
    for row in published {
        for (i, (pass, quantities)) in PASSES.iter().enumerate() {
            let ours = |scene: &str, method: &str| {
                let times = quantities
                    .iter()
                    .map(|quantity| table.value(scene, (method, ""), quantity, "all"));
                times.sum::<Option<f64>>()
            };
            let large = format!("{}-1024x768", row.scene);
            let times = [
                Some(row.small[i]),
                ours(row.scene, preset),
                ours(row.scene, methods::DEFAULT),
                Some(row.large[i]),
                ours(&large, preset),
                ours(&large, methods::DEFAULT),
            ];
            any |= times[1].is_some() || times[4].is_some();
            rows.numbers(&format!("{}, {pass}", row.scene), times);
        }
    }
    any.then(|| rows.finish())
}

/// Per size: published and ours for every number of iterations.
fn smoothing(table: &Table, published: &[[f64; 4]; 4], bilaterally: bool) -> Option<String> {
    let ways = methods::table(bilaterally);
    let iterations = if bilaterally {
        [11, 22, 33, 44]
    } else {
        [1, 2, 3, 4]
    };
    let headings = iterations
        .iter()
        .flat_map(|count| [format!("×{count} published"), "ours".into()]);
    let mut rows = Rows::new(["window".to_owned()].into_iter().chain(headings));
    let mut any = false;
    for (row, ways) in published.iter().zip(ways.chunks(4)) {
        let cells = row.iter().zip(ways).flat_map(|(&published, way)| {
            let ours = table.value(
                scenes::WINDOWS,
                (way.name, &way.parameters),
                "time_smooth",
                "all",
            );
            any |= ours.is_some();
            [Some(published), ours]
        });
        let cells: Vec<_> = cells.collect();
        let window = ways[0].parameters.split(' ').next().unwrap_or_default();
        rows.numbers(window, cells);
    }
    any.then(|| rows.finish())
}
