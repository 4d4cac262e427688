//! The viewer as a program: what it says, writes and returns.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;

use crate::program::{assert_picture, assert_refused, example, lines};

fn viewer() -> Command {
    example("viewer")
}

fn folder(test: &str) -> PathBuf {
    crate::program::folder("viewer", test)
}

/// A drop of 27 particles and as many other triples as given, in the `.xyz` format.
fn xyz(folder: &Path, others: &[[f32; 3]]) -> PathBuf {
    let cells = (0..27).map(|i| [i % 3, i / 3 % 3, i / 9].map(|c| 0.05 * c as f32));
    let bytes: Vec<u8> = cells
        .chain(others.iter().copied())
        .flatten()
        .flat_map(f32::to_le_bytes)
        .collect();
    let path = folder.join("particles.xyz");
    fs::write(&path, bytes).unwrap();
    path
}

fn run(file: &Path, folder: &Path, options: &[&str]) -> Output {
    viewer()
        .arg(file)
        .args(["--radius", "0.025", "--size", "96x64", "--frames", "1"])
        .arg("--out")
        .arg(folder.join("picture.png"))
        .args(options)
        .output()
        .unwrap()
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let folder = folder("files");
    let file = |name: &str, content: &[u8]| {
        let path = folder.join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let vtk = b"# vtk DataFile Version 4.1\nparticles\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 100 float\n\x3f\x80";
    for (path, reason) in [
        (folder.join("missing.vtk"), "cannot read"),
        (file("truncated.vtk", vtk), "damaged"),
        (file("foreign.vtk", b"GIF89a, and no particles"), "a GIF"),
        (file("foreign.ply", b"GIF89a, and no particles"), "a GIF"),
        (file("foreign.bgeo", b"GIF89a, and no particles"), "a GIF"),
        (file("foreign.xyz", b"no particles at all"), "text"),
        (file("foreign.txt", b"1 2 3"), "format"),
        (file("foreign.vtu", b"<?xml version=\"1.0\"?>"), "XML"),
        (file("odd.xyz", &[0; 13]), "12"),
        (file("empty.vtk", b""), "empty"),
        (file("empty.xyz", b""), "empty"),
    ] {
        let output = run(&path, &folder, &[]);
        let name = path.file_name().unwrap().to_str().unwrap();
        assert_refused(&output, &folder, &[name, reason]);
    }
}

#[test]
fn an_option_that_makes_no_sense_is_named() {
    let folder = folder("options");
    let file = xyz(&folder, &[]);
    let cases: &[(&[&str], &str)] = &[
        (&["--radius", "0"], "--radius"),
        (&["--radius", "-1"], "-1"),
        (&["--radius", "NaN"], "--radius"),
        (&["--size", "0x5"], "0x5"),
        (&["--size", "5"], "--size"),
        (&["--frames", "0"], "--frames"),
        (&["--orbit", "0"], "--orbit"),
        (&["--refractions", "3"], "--refractions"),
        (&["--smoothing", "nicely"], "nicely"),
        (&["--debug-view", "feelings"], "feelings"),
        (&["--eye", "1,2"], "--eye"),
        (&["--no-such-option"], "--no-such-option"),
    ];
    for (options, name) in cases {
        // The last of two equal options would be an error of its own.
        let given = |option: &str| options.contains(&option);
        let mut command = viewer();
        command
            .arg(&file)
            .arg("--out")
            .arg(folder.join("picture.png"));
        for (option, value) in [("--radius", "0.025"), ("--size", "96x64")] {
            if !given(option) {
                command.args([option, value]);
            }
        }
        let output = command.args(*options).output().unwrap();
        assert_refused(&output, &folder, &[name]);
    }
}

#[test]
fn a_picture_that_cannot_be_written_is_named() {
    let folder = folder("unwritable");
    let file = xyz(&folder, &[]);
    let no_such = folder.join("no such folder");
    for option in ["--out", "--stats"] {
        let output = viewer()
            .arg(&file)
            .args(["--radius", "0.025", option])
            .arg(no_such.join("result.png"))
            .output()
            .unwrap();
        assert_refused(&output, &folder, &["no such folder"]);
    }
}

#[test]
fn without_an_adapter_it_says_what_to_install() {
    let folder = folder("adapter");
    let file = xyz(&folder, &[]);
    let output = viewer()
        .arg(&file)
        .args(["--radius", "0.025", "--out"])
        .arg(folder.join("picture.png"))
        .env("VK_DRIVER_FILES", "/nonexistent")
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .output()
        .unwrap();
    assert_refused(&output, &folder, &["install", "mesa-vulkan-drivers"]);
}

#[test]
fn an_orbit_is_several_pictures_in_one_each_turned_a_little() {
    let folder = folder("orbit");
    let file = xyz(&folder, &[]);
    let output = run(&file, &folder, &["--orbit", "5"]);
    assert!(output.status.success(), "{:?}", lines(&output.stderr));
    let path = folder.join("picture.png");
    // Rows of four; what is left of the last is black.
    assert_picture(&path, (4 * 96, 2 * 64));
    let sheet = image::open(&path).unwrap().into_rgb8();
    let tile =
        |x: u32, y: u32| image::imageops::crop_imm(&sheet, 96 * x, 64 * y, 96, 64).to_image();
    let difference = |a: &image::RgbImage, b: &image::RgbImage| -> f64 {
        let pairs = a.as_raw().iter().zip(b.as_raw());
        let sum: u32 = pairs.map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
        f64::from(sum) / a.as_raw().len() as f64
    };
    let [first, second, last] = [(0, 0), (1, 0), (0, 1)].map(|(x, y)| tile(x, y));
    let [near, far] = [&second, &last].map(|other| difference(&first, other));
    assert!(0.0 < near && near < far && far < 20.0, "{near}, {far}");
    assert!(tile(1, 1).as_raw().iter().all(|byte| *byte == 0));
}

#[test]
fn a_good_run_writes_a_picture_and_statistics() {
    let folder = folder("good");
    let file = xyz(&folder, &[[f32::NAN; 3], [0.5, f32::INFINITY, 0.0]]);
    let stats = folder.join("stats.json");
    let output = run(&file, &folder, &["--stats", stats.to_str().unwrap()]);
    assert!(output.status.success(), "{:?}", lines(&output.stderr));

    assert_picture(&folder.join("picture.png"), (96, 64));

    let stats: Value = serde_json::from_slice(&fs::read(stats).unwrap()).unwrap();
    let number = |key: &str| {
        stats[key]
            .as_u64()
            .unwrap_or_else(|| panic!("{key}: {stats}"))
    };
    assert_eq!([number("particles"), number("dropped")], [29, 2]);
    let classes = ["bulk", "interior", "spray"].map(number);
    assert_eq!(classes.iter().sum::<u64>(), 27);
    assert_eq!([number("width"), number("height")], [96, 64]);
    let pixels = number("fluid_pixels");
    assert!(pixels > 100 && pixels < 96 * 64, "{pixels}");
    assert!(!stats["adapter"].as_str().unwrap().is_empty());
    let times: &[(&str, &[&str])] = &[
        ("cpu_ms", &["shape", "grid", "classify", "anisotropy"]),
        (
            "gpu_ms",
            &["splat", "smooth", "normals", "refract", "composite"],
        ),
    ];
    for (group, passes) in times {
        for pass in *passes {
            let time = stats[group]
                .get(pass)
                .unwrap_or_else(|| panic!("{pass}: {stats}"));
            // An adapter without timestamps has no times of the GPU.
            let known = time.as_f64().is_some_and(|ms| ms >= 0.0);
            assert!(
                known || (*group == "gpu_ms" && time.is_null()),
                "{group}, {pass}: {time}"
            );
        }
    }
}
