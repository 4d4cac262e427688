//! The report on speed against error: a quick run, and what it says to bad requests.

use std::{
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
};

use fluid_report::{Options, ReportError, run};
use fluid_stage::StageError;

/// A folder of its own for a test, empty.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("speed_error")
        .join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

fn parse(words: &[&str], out: &Path) -> Result<Options, ReportError> {
    let out = out.to_str().unwrap();
    Options::parse_from([&["speed_error"], words, &["--out", out]].concat())
}

const COLUMNS: [&str; 10] = [
    "scene",
    "particles",
    "width",
    "height",
    "method",
    "parameters",
    "quantity",
    "region",
    "value",
    "unit",
];

/// A line of the table.
struct Line(csv::StringRecord);

impl Line {
    fn text(&self, column: &str) -> &str {
        &self.0[COLUMNS.iter().position(|c| *c == column).unwrap()]
    }

    fn value(&self) -> f64 {
        self.text("value").parse().unwrap()
    }
}

/// The accuracy that is aimed for, as far as small pictures show it. Times are never asserted.
#[test]
fn a_quick_run_writes_a_table_without_gaps_and_is_as_exact_as_aimed_for() {
    let out = folder("quick");
    run(&parse(&["--quick"], &out).unwrap()).unwrap();
    let mut reader = csv::Reader::from_path(out.join("speed_error.csv")).unwrap();
    assert_eq!(reader.headers().unwrap(), COLUMNS.as_slice());
    let lines: Vec<_> = reader.records().map(|line| Line(line.unwrap())).collect();
    assert!(lines.len() > 1000, "{}", lines.len());
    let mut keys = HashSet::new();
    for line in &lines {
        assert!(line.value().is_finite(), "{:?}", line.0);
        let key = ["scene", "method", "parameters", "quantity", "region"].map(|c| line.text(c));
        // What is both a smoothing and a frame is measured as either.
        assert!(keys.insert(key.map(str::to_owned)), "twice: {key:?}");
    }
    let values = |wanted: [&str; 5]| {
        let columns = ["scene", "method", "parameters", "quantity", "region"];
        let fits = |line: &&Line| {
            let pairs = columns.iter().zip(wanted);
            pairs
                .clone()
                .all(|(column, wanted)| wanted == "*" || line.text(column) == wanted)
        };
        let values: Vec<_> = lines.iter().filter(fits).map(Line::value).collect();
        assert!(!values.is_empty(), "{wanted:?}");
        values
    };
    let most = |wanted| values(wanted).into_iter().fold(f64::MIN, f64::max);
    let least = |wanted| values(wanted).into_iter().fold(f64::MAX, f64::min);

    let layers = "layers-bulk";
    assert!(most(["*", layers, "*", "front_depth_rmse", "interior"]) <= 1e-3);
    assert!(least(["*", layers, "*", "silhouette_iou", "all"]) >= 0.998);

    for (scene, region) in [
        ("plane-0-at-6px", "interior"),
        ("plane-80-at-6px", "all"),
        ("sphere-at-6px", "interior"),
    ] {
        let fit = |quantity| {
            most([
                scene,
                "plane-fit-separable",
                "9x9 x2 1.7r",
                quantity,
                region,
            ])
        };
        assert!(
            fit("normal_p50") <= 2.5 && fit("normal_p95") <= 8.0,
            "{scene}"
        );
        // Where the particles' own surfaces end; 0.27 on a ball of twelve radii, as planes lie below
        // what bends: 0.05 more than fits over one such window, whose normals are twice as far off.
        assert!(fit("surface_offset").abs() < 0.28, "{scene}");
    }

    assert!(least(["sphere", "bracketed", "0 coarse", "search_right", "all"]) >= 0.995);
    assert!(least(["depth-step", "bracketed", "0 coarse", "search_right", "all"]) >= 0.97);
    assert!(most(["*", "bracketed", "0 coarse", "evaluations_mean", "all"]) <= 6.0);
    // Half floats hold light to a two-thousandth.
    assert!(most(["*", "furnace", "*", "furnace_max", "all"]) <= 1e-3);

    assert!(most(["*", "closed-form", "*", "relative_error_max", "all"]) <= 1e-6);
    let thickness = |way| most(["two-puffs", "thickness", way, "thickness_rmse", "behind"]);
    // The gap between the puffs is sixteen radii deep, and full where only layers are known.
    assert!(thickness("summed, softness 0") < 0.5 * thickness("layers"));

    let flip = |scene, method, parameters| most([scene, method, parameters, "flip", "all"]);
    assert!(flip("sphere", "refractions", "2") < flip("sphere", "refractions", "1"));
    let pool = "pool-and-droplets";
    assert!(flip(pool, "default", "") < flip(pool, "refractions", "2"));
    for scene in ["sphere", pool] {
        assert!(
            flip(scene, "default", "") < flip(scene, "thesis", ""),
            "{scene}"
        );
    }

    let summary = fs::read_to_string(out.join("summary.md")).unwrap();
    for heading in [
        "## What was aimed for",
        "## Fronts",
        "## Where each method fails",
    ] {
        assert!(summary.contains(heading), "{heading}");
    }
    for file in [
        "sphere_flip.svg",
        "sphere_flip.png",
        "depth-step_normal_p50.svg",
    ] {
        assert!(fs::metadata(out.join(file)).unwrap().len() > 1000, "{file}");
    }
}

#[test]
fn requests_that_cannot_be_met_are_one_line_and_exit_code_2() {
    let out = folder("bad");
    let file = out.join("file");
    fs::write(&file, []).unwrap();
    let requests = [
        (parse(&["--scene", "ocean"], &out), "ocean"),
        (parse(&["--method", "magic"], &out), "magic"),
        (parse(&["--quick"], &file.join("below")), "below"),
        (Err(StageError::NoAdapter.into()), "adapter"),
    ];
    for (request, named) in requests {
        let error = request.unwrap_err();
        let text = error.to_string();
        assert_eq!(error.exit_code(), 2, "{text}");
        assert!(text.contains(named) && text.lines().count() == 1, "{text}");
    }
    for words in [
        &["--size", "640"][..],
        &["--size", "1x1"],
        &["--fast"],
        &["stray"],
    ] {
        let error = parse(words, &out).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
    }
    assert_eq!(parse(&["--help"], &out).unwrap_err().exit_code(), 0);
}

/// A scene's name asks for that scene, whether it is among the quick ones or not.
#[test]
fn one_scene_and_one_method_can_be_asked_for() {
    let out = folder("one");
    let words = [
        "--quick",
        "--scene",
        "slab",
        "--method",
        "plane-fit-separable",
    ];
    run(&parse(&words, &out).unwrap()).unwrap();
    let mut reader = csv::Reader::from_path(out.join("speed_error.csv")).unwrap();
    let lines: Vec<_> = reader.records().map(|line| Line(line.unwrap())).collect();
    assert!(lines.iter().all(|line| line.text("scene") == "slab"));
    let offset = |line: &&Line| line.text("quantity") == "surface_offset";
    assert!(
        lines
            .iter()
            .filter(offset)
            .all(|line| line.text("method") == "plane-fit-separable")
    );
    assert!(lines.iter().any(|line| offset(&line)));
}
