//! The README's program is a whole one, short, and that of the picture below it. That it compiles is
//! seen to by the doc tests.

const README: &str = include_str!("../../README.md");
const EXAMPLE: &str = include_str!("../../examples/first_water.rs");

fn program() -> &'static str {
    let (_, after) = README.split_once("```rust,no_run\n").unwrap();
    after.split_once("```\n").unwrap().0
}

/// Code without its comments, and without what `rustfmt` decides.
fn dense(code: &str) -> String {
    let lines = code
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let text: String = lines.collect::<String>().replace(char::is_whitespace, "");
    text.replace(",)", ")").replace(",}", "}")
}

#[test]
fn a_stranger_has_water_in_less_than_thirty_lines() {
    let lines = program().lines();
    assert!(lines.clone().count() < 30);
    assert!(lines.clone().all(|line| line.len() <= 100));
    for part in [
        "fn main()",
        "ParticleEmitter",
        "Camera3d",
        "DirectionalLight",
        "floor",
    ] {
        assert!(program().contains(part), "{part}");
    }
}

#[test]
fn the_picture_is_the_programs() {
    let example = dense(EXAMPLE)
        .replace("usefluid_stage::StagePlugins;", "")
        .replace("StagePlugins::from_args()", "DefaultPlugins");
    assert_eq!(example, dense(program()));
}

#[test]
fn versions_are_those_of_the_manifest() {
    let manifest = include_str!("../../Cargo.toml");
    let field = |name: &str| {
        let (_, after) = manifest.split_once(name).unwrap();
        after.split_once('"').unwrap().0
    };
    let bevy = field("bevy = { version = \"");
    assert!(README.contains(&format!("bevy = \"{bevy}\"")));
    let [version, rust] = [field("\nversion = \""), field("rust-version = \"")];
    let (version, _) = version.rsplit_once('.').unwrap();
    assert!(README.contains(&format!("| {version} | {bevy} | {rust} |")));
}
