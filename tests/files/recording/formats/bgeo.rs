//! Houdini's `.bgeo`.

use std::io::Write;

use flate2::{Compression, write::GzEncoder};

use super::{damaged, logged, refused, seven_and_eight, two};

/// An attribute: name, size, type, the rest of its definition, and the words of both points.
type Attribute<'a> = (&'a str, u16, i32, &'a [u8], [u32; 2]);

const ID: Attribute = ("id", 1, 1, &[0; 4], [7, 8]);

fn bgeo(attributes: &[Attribute]) -> Vec<u8> {
    let mut file = b"BgeoV".to_vec();
    let header = [5, 2, 0, 0, 0, attributes.len() as i32, 0, 0, 0];
    file.extend(header.into_iter().flat_map(i32::to_be_bytes));
    for (name, size, kind, rest, _) in attributes {
        file.extend((name.len() as u16).to_be_bytes());
        file.extend(name.as_bytes());
        file.extend(size.to_be_bytes());
        file.extend(kind.to_be_bytes());
        file.extend(*rest);
    }
    for (point, x) in [0.0_f32, 1.0].into_iter().enumerate() {
        file.extend([x, 0.0, 0.0, 1.0].into_iter().flat_map(f32::to_be_bytes));
        for (_, size, _, _, words) in attributes {
            for _ in 0..*size {
                file.extend(words[point].to_be_bytes());
            }
        }
    }
    file.extend([0x00, 0xff]);
    file
}

fn zip(bytes: &[u8]) -> Vec<u8> {
    let mut zip = GzEncoder::new(Vec::new(), Compression::fast());
    zip.write_all(bytes).unwrap();
    zip.finish().unwrap()
}

#[test]
fn the_classic_one_is_read_under_its_names() {
    let plain = bgeo(&[ID]);
    for name in [
        "plain.bgeo",
        "plain.bhclassic",
        "plain.bgeo.gz",
        "plain.BGEO",
    ] {
        seven_and_eight(name, &plain);
        seven_and_eight(name, zip(&plain));
        // In parts, as parallel programs zip.
        let (one, other) = plain.split_at(40);
        seven_and_eight(name, [zip(one), zip(other)].concat());
    }
}

#[test]
fn strings_cost_themselves() {
    let strings: &[u8] = b"\0\0\0\x02\0\x05water\0\x03ice";
    for name in ["group", "id", "v"] {
        let group = (name, 1, 4, strings, [0, 1]);
        seven_and_eight(&format!("{name}_strings.bgeo"), bgeo(&[group, ID]));
        let pressure = ("pressure", 2, 0, &[0; 8][..], [1, 2]);
        seven_and_eight(
            &format!("{name}_strings.bgeo"),
            bgeo(&[pressure, group, ID]),
        );
        assert_eq!(
            logged(&format!("{name}_strings.bgeo"), &format!("`{name}`")),
            1
        );
    }
    let unknown = ("shape", 1, 9, &[0; 4][..], [1, 2]);
    refused("kind.bgeo", bgeo(&[unknown, ID]), "`shape`");
}

#[test]
fn radii_that_differ_become_their_mean_and_it_is_logged() {
    let radii = |a: f32, b: f32| bgeo(&[("pscale", 1, 0, &[0; 4], [a, b].map(f32::to_bits))]);
    let mixed = two("mixed.bgeo", radii(0.25, 0.5));
    assert_eq!(mixed.radius, Some(0.375));
    assert_eq!(logged("mixed.bgeo", "radii are 0.25 to 0.5: all"), 1);

    assert_eq!(two("equal.bgeo", radii(0.01, 0.01)).radius, Some(0.01));
    // What is no radius does not count.
    assert_eq!(two("equal.bgeo", radii(f32::NAN, 0.01)).radius, Some(0.01));
    assert_eq!(logged("equal.bgeo", ""), 0);
}

#[test]
fn other_kinds_are_refused_by_what_they_are() {
    refused(
        "new.bgeo",
        [&b"\x7fNSJb"[..], &[0; 64]].concat(),
        "Houdini 12",
    );
    refused("blosc.bgeo.sc", [2, 1, 0, 0], "Blosc");
    refused("seekable.bgeo", b"scf1\0\0\0\0", "Blosc");
    refused(
        "text.bgeo",
        "PGEOMETRY V5\nNPoints 2 NPrims 0\n",
        "text .geo",
    );
    let mut version = bgeo(&[ID]);
    version[8] = 6;
    refused("version.bgeo", version, "6");
}

#[test]
fn only_what_is_damaged_is_called_so() {
    let plain = bgeo(&[ID]);
    damaged("cut.bgeo", &plain[..3], "cut short");
    damaged("cut.bgeo", &plain[..50], "cut short");
    damaged(
        "cut.bgeo",
        &plain[..plain.len() - 12],
        "claims 2 points and holds 1",
    );
    let zipped = zip(&plain);
    damaged("cut.bgeo.gz", &zipped[..zipped.len() - 9], "unzipped");
}
