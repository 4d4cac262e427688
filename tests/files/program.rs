//! Examples as programs.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

/// An example's executable, which `cargo test` builds beside the tests.
pub(crate) fn example(name: &str) -> Command {
    let test = std::env::current_exe().unwrap();
    let release = test.ancestors().nth(2).unwrap();
    let program = release.join("examples").join(name);
    assert!(
        program.exists(),
        "{} is not built: run `scripts/test`",
        program.display()
    );
    let mut command = Command::new(program);
    // Some drivers complain on stderr without it.
    command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
    command
}

/// A folder of its own for a test, empty.
pub(crate) fn folder(program: &str, test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join(program)
        .join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

pub(crate) fn lines(stderr: &[u8]) -> Vec<String> {
    let text = String::from_utf8_lossy(stderr);
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.map(str::to_owned).collect()
}

/// Exit code 2, one line that names every one of `names`, and no picture, not even half of one.
#[track_caller]
pub(crate) fn assert_refused(output: &Output, folder: &Path, names: &[&str]) {
    let lines = lines(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{lines:?}");
    let [line] = &lines[..] else {
        panic!("not one line: {lines:#?}");
    };
    for name in names {
        assert!(line.contains(name), "{name} is not in: {line}");
    }
    let pictures = fs::read_dir(folder).unwrap().filter(|entry| {
        let name = entry.as_ref().unwrap().file_name();
        name.to_string_lossy().contains(".png")
    });
    assert_eq!(pictures.count(), 0);
}

/// A picture of this size, and not of one colour.
#[track_caller]
pub(crate) fn assert_picture(file: &Path, size: (u32, u32)) {
    let picture = image::open(file).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), size);
    let first = *picture.get_pixel(0, 0);
    assert!(
        picture.pixels().any(|pixel| *pixel != first),
        "{} is of one colour",
        file.display()
    );
}
