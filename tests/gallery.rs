//! The examples, `scripts/gallery`, `docs/gallery.md`, `docs/images` and the README's list are about
//! the same programs.

use std::{collections::BTreeSet, fs, path::Path};

const GALLERY: &str = include_str!("../docs/gallery.md");
const SCRIPT: &str = include_str!("../scripts/gallery");
const README: &str = include_str!("../README.md");
const MANIFEST: &str = include_str!("../Cargo.toml");

/// It keeps a file of particles, and draws nothing.
const DRAWS_NOTHING: &str = "bake";

/// What is in a folder of the repository.
fn entries(folder: &str) -> impl Iterator<Item = std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(folder).unwrap();
    entries.map(|entry| entry.unwrap().path())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_str().unwrap().to_owned()
}

/// Files, and folders with a `main.rs`.
fn examples() -> BTreeSet<String> {
    entries("examples")
        .filter(|path| path.is_file() || path.join("main.rs").exists())
        .map(|path| stem(&path))
        .collect()
}

/// Pictures and the commands that draw them, by the script.
fn drawn() -> Vec<(&'static str, &'static str)> {
    let (_, list) = SCRIPT.split_once("gallery=(\n").unwrap();
    let (list, _) = list.split_once("\n)").unwrap();
    let lines = list.lines().map(|line| line.trim().trim_matches('"'));
    lines
        .map(|line| line.split_once(' ').unwrap())
        .map(|(picture, command)| (picture, command.trim()))
        .collect()
}

/// Pictures, commands and the rest of their lines, by the gallery.
fn shown() -> Vec<(&'static str, &'static str, &'static str)> {
    let lines = GALLERY.lines().filter(|line| line.starts_with("| !["));
    lines
        .map(|line| {
            let (_, rest) = line.split_once("](images/").unwrap();
            let (picture, rest) = rest.split_once(".png) | `").unwrap();
            let (command, rest) = rest.split_once('`').unwrap();
            (picture, command, rest)
        })
        .collect()
}

/// The feature that an example needs.
fn feature(example: &str) -> Option<&'static str> {
    let name = format!("[[example]]\nname = \"{example}\"");
    let (_, after) = MANIFEST.split_once(&name)?;
    let (section, _) = after.split_once("\n\n").unwrap();
    let (_, feature) = section.split_once("required-features = [\"")?;
    Some(feature.split_once('"').unwrap().0)
}

fn program(command: &str) -> &str {
    command.split(' ').next().unwrap()
}

#[test]
fn every_example_is_drawn_and_every_picture_is_there() {
    let mut expected = examples();
    assert!(expected.remove(DRAWS_NOTHING));
    let drawn = drawn();
    let programs = drawn.iter().map(|(_, command)| program(command).to_owned());
    assert_eq!(programs.collect::<BTreeSet<_>>(), expected);

    let there: BTreeSet<_> = entries("docs/images").map(|path| stem(&path)).collect();
    let pictures: BTreeSet<_> = drawn.iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(there, pictures);
    for picture in entries("docs/images") {
        let (width, height) = image::image_dimensions(&picture).unwrap();
        assert!(width >= 640 && height >= 360, "{}", picture.display());
    }
}

#[test]
fn the_gallery_has_a_line_for_every_picture() {
    let (drawn, shown) = (drawn(), shown());
    let pictures: BTreeSet<_> = shown.iter().map(|(picture, ..)| *picture).collect();
    assert_eq!(
        pictures,
        drawn.iter().map(|(picture, _)| *picture).collect()
    );
    assert_eq!(pictures.len(), shown.len());
    for (picture, command, text) in shown {
        let drawn = drawn.iter().find(|(name, _)| *name == picture);
        // All but its size and its moment.
        let (_, whole) = drawn.unwrap();
        assert!(whole.starts_with(command), "{picture}: {command}");
        let said = feature(program(command)).map(|feature| format!("(feature `{feature}`):"));
        match said {
            Some(said) => assert!(text.contains(&said), "{picture}: {said}"),
            None => assert!(!text.contains("(feature"), "{picture}"),
        }
        assert!(text.len() > 20, "{picture}: what is seen?");
    }
}

#[test]
fn the_readme_lists_every_example_and_shows_pictures_that_are_there() {
    for example in examples() {
        let feature = feature(&example).map(|feature| format!("--features {feature} "));
        let feature = feature.unwrap_or_default();
        let command = format!("| `cargo run --release {feature}--example {example}");
        assert!(README.contains(&command), "{command}");
    }
    let images = README.split("](docs/").skip(1);
    for image in images.filter_map(|rest| Some(rest.split_once(".png)")?.0)) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR"));
        let file = file.join("docs").join(format!("{image}.png"));
        assert!(file.exists(), "{}", file.display());
    }
}
