//! The small examples' options, and that a bad one is named.

use std::{ffi::OsString, path::Path};

use bevy::math::UVec2;
use fluid_stage::{ArgumentError, StagePlugins, VIEW_SIZE};

fn parse(line: &str) -> Result<StagePlugins, ArgumentError> {
    StagePlugins::default().parse(line.split_whitespace().map(OsString::from))
}

fn complaint(line: &str) -> String {
    parse(line).unwrap_err().to_string()
}

#[test]
fn options_are_understood() {
    let stage = parse("--out a/b.png --size 320x200 --frames 0").unwrap();
    assert_eq!(stage.out.as_deref(), Some(Path::new("a/b.png")));
    assert_eq!((stage.size, stage.frames), (UVec2::new(320, 200), 0));

    let stage = parse("").unwrap();
    assert_eq!((stage.out, stage.size), (None, VIEW_SIZE));
}

#[test]
fn a_bad_option_is_named() {
    assert!(complaint("--colour red").contains("`--colour`"));
    assert!(complaint("picture.png").contains("`picture.png`"));
    assert!(complaint("--size").contains("`--size` needs a value"));
    for size in [
        "0x10",
        "10x0",
        "10",
        "x",
        "-1x5",
        "10x10x10",
        "9000x9000",
        "tenxten",
    ] {
        let complaint = complaint(&format!("--size {size}"));
        assert!(complaint.contains(&format!("`{size}`")), "{complaint}");
    }
    assert!(complaint("--frames -1").contains("`-1`"));
    assert!(complaint("--out picture.jpg").contains("`picture.jpg`"));
    assert_eq!(parse("--help"), Err(ArgumentError::Help));
    assert!(complaint("--help").contains("--frames N"));
}
