//! The other examples as programs: what they write and return without a window. `viewer` has tests
//! of its own.

use crate::program::{assert_picture, assert_refused, example, folder, lines};

/// Draws a small picture; then asks for what there is not.
#[track_caller]
fn draws(name: &str, options: &[&str], wrong: &[(&[&str], &str)]) {
    let folder = folder("examples", name);
    let picture = folder.join("picture.png");
    for (options, named) in wrong {
        let output = example(name)
            .arg("--out")
            .arg(&picture)
            .args(*options)
            .output();
        assert_refused(&output.unwrap(), &folder, &[named]);
    }
    let output = example(name)
        .args(["--size", "96x64", "--out"])
        .arg(&picture)
        .args(options)
        .output()
        .unwrap();
    assert!(output.status.success(), "{:?}", lines(&output.stderr));
    assert_picture(&picture, (96, 64));
}

#[test]
fn first_water() {
    let wrong: &[(&[&str], &str)] = &[
        (&["--size", "0x5"], "0x5"),
        (&["--frames"], "--frames"),
        (&["--no-such-option"], "--no-such-option"),
    ];
    draws("first_water", &["--frames", "5"], wrong);
}

#[test]
fn fountain() {
    let wrong: &[(&[&str], &str)] = &[(&["--frames", "many"], "many")];
    draws("fountain", &["--frames", "5"], wrong);
}

#[test]
fn rain() {
    let wrong: &[(&[&str], &str)] = &[
        (&["--scene", "desert"], "desert"),
        (&["--rate", "much"], "--rate"),
        (&["--wind", "1"], "--wind"),
        (&["--no-such-option"], "--no-such-option"),
    ];
    draws("rain", &["--scene", "lamp", "--frames", "3"], wrong);
}

#[test]
fn recording() {
    let wrong: &[(&[&str], &str)] = &[
        (&["--rate", "often"], "--rate"),
        (&["--file", "frames.doc"], "doc"),
        (&["--time", "soon"], "--time"),
    ];
    let frames = folder("examples", "recorded");
    let frames = frames.to_str().unwrap();
    draws("recording", &["--folder", frames, "--time", "0.3"], wrong);
}

#[test]
fn demo() {
    let wrong: &[(&[&str], &str)] = &[(&["--frames", "-1"], "-1")];
    draws("demo", &["--frames", "3"], wrong);
}

#[test]
fn dam_break() {
    let wrong: &[(&[&str], &str)] = &[(&["--size", "96"], "96")];
    draws("dam_break", &["--frames", "3"], wrong);
}
