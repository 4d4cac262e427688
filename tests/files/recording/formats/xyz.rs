//! Positions alone: triples of floats, or text.

use bevy::prelude::*;
use proptest::prelude::*;

use bevy_fluid::recording::ParticleFrame;

use super::{NOT_FINITE, damaged, first_is_finite, parse, refused, two};

#[test]
fn text_is_read_as_text() {
    // A multiple of twelve bytes, as the floats would be.
    let lines = "0.1 0.2 0.3\n".repeat(100);
    assert_eq!(lines.len() % 12, 0);
    let frame = parse("lines.xyz", &lines);
    assert_eq!(frame.positions, vec![vec3(0.1, 0.2, 0.3); 100]);
    for text in [
        "0 0 0\n1 0 0\n",
        "0 0 0\r\n1 0 0",
        "\u{feff}# x y z\n\n0\t0\t0\n//\n  1e0 0 -0.0\n",
        "0 0 0 255 0 0\n1 0 0 0 0 255\n",
    ] {
        two("text.xyz", text);
    }
    for (word, is_finite) in NOT_FINITE {
        first_is_finite(
            &parse("finite.xyz", format!("0 0 {word}\n1 0 0\n")),
            word,
            is_finite,
        );
    }
}

#[test]
fn atoms_are_read_at_their_places() {
    for text in [
        "2\nwater\nO 0.0 0.0 0.0\nH 1.0 0.0 0.0\n",
        "2\n\n8 0.0 0.0 0.0\n1 1.0 0.0 0.0\n",
        "  2  \r\nwater at 3 K\r\nO 0 0 0 -0.8\r\nH 1 0 0 0.4\r\n",
        "2\nw\u{e4}sserchen\n0 0 0\n1 0 0\n",
        "O 0 0 0\nH 1 0 0\n",
        "2\nProperties=species:S:1:pos:R:3:forces:R:3\nO 0 0 0 1 1 1\nH 1 0 0 1 1 1\n",
        "2\nfirst\nO 0 0 0\nH 1 0 0\n2\nsecond\nO 0 0 5\nH 1 0 5\n",
    ] {
        two("atoms.xyz", text);
    }
    // A title in another encoding.
    two(
        "latin.xyz",
        b"2\nw\xe4sser, unter der linde\nO 0 0 0\nH 1 0 0\n",
    );
    damaged(
        "few.xyz",
        "3\nwater\nO 0 0 0\nH 1 0 0\n",
        "claims 3 atoms and holds 2",
    );
    let other = "2\nProperties=pos:R:3:species:S:1\n0 0 0 O\n1 0 0 H\n";
    refused("columns.xyz", other, "species:S:1:pos:R:3");
}

#[test]
fn other_text_is_refused_by_its_line() {
    refused(
        "words.xyz",
        "no list of particles\n",
        "line 1 is not `x y z`",
    );
    refused("words.xyz", "0 0 0\n\n1 0\n", "line 3 is not `x y z`");
    refused("comma.xyz", "0,1 0,2 0,3\n", "line 1: `0,1`");
    let wide: Vec<u8> = "\u{feff}0 0 0\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    refused("wide.xyz", wide, "UTF-16");
    refused("ply.xyz", "ply\nformat ascii 1.0\n", "a .ply");
    damaged("odd.xyz", [0; 25], "no multiple of 12");
}

#[test]
fn floats_are_still_floats() {
    let floats = |numbers: &[f32]| -> Vec<u8> {
        numbers.iter().copied().flat_map(f32::to_le_bytes).collect()
    };
    two("floats.xyz", floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]));
    assert_eq!(parse("none.xyz", "").positions, []);
    for (number, is_finite) in [(f32::NAN, false), (f32::INFINITY, false), (1e-40, true)] {
        let frame = parse("floats.xyz", floats(&[number, 0.0, 0.0, 1.0, 0.0, 0.0]));
        first_is_finite(&frame, "floats", is_finite);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..default() })]

    /// Whatever is printable has only particles that stand there in digits.
    #[test]
    fn printable_text_is_never_taken_for_floats(
        lines in prop::collection::vec("\\PC{0,40}", 1..40),
    ) {
        let mut text = lines.join("\n");
        // As many bytes as triples have.
        while text.len() % 12 != 0 {
            text.push(' ');
        }
        if let Ok(frame) = ParticleFrame::parse("printable.xyz", text.as_bytes()) {
            let lines = text.lines().filter(|line| line.contains(|c: char| c.is_ascii_digit()));
            prop_assert!(frame.positions.len() <= lines.count());
        }
    }

    #[test]
    fn random_positions_are_never_taken_for_text(
        positions in prop::collection::vec(prop::array::uniform3(-10.0_f32..10.0), 2..50),
    ) {
        let bytes: Vec<u8> = positions.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        let frame = ParticleFrame::parse("random.xyz", &bytes).unwrap();
        let expected: Vec<_> = positions.into_iter().map(Vec3::from).collect();
        prop_assert_eq!(frame.positions, expected);
    }
}
