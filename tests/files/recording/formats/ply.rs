//! PLY.

use super::{NOT_FINITE, damaged, first_is_finite, logged, parse, refused, seven_and_eight, two};

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

fn header(format: &str, properties: &str) -> String {
    format!("ply\nformat {format} 1.0\nelement vertex 2\n{properties}end_header\n")
}

fn text(more: &str, rows: &str) -> String {
    header("ascii", &(XYZ.to_owned() + more)) + rows
}

/// Two particles with a property of so many bytes after the position, which ends in 7 and 8.
fn binary(format: &str, kind: &str, name: &str, size: usize) -> Vec<u8> {
    let is_big = format == "binary_big_endian";
    let mut file = header(format, &format!("{XYZ}property {kind} {name}\n")).into_bytes();
    for (x, last) in [(0.0_f32, 7), (1.0, 8)] {
        for float in [x, 0.0, 0.0] {
            file.extend(if is_big {
                float.to_be_bytes()
            } else {
                float.to_le_bytes()
            });
        }
        let mut number = [vec![0; size - 1], vec![last]].concat();
        if !is_big {
            number.reverse();
        }
        file.extend(number);
    }
    file
}

#[test]
fn text_is_read_as_it_is_written() {
    let rows = "0 0 0\n1 0 0\n";
    for rows in [
        "0 0 0\n1 0 0\n",
        "0 0 0 \n1 0 0 \n\n\n",
        "0\t0\t0\n1\t0\t0\n",
        "\n0 0 0\n\n1 0 0",
        "0 0 0\n1 0 0\n9 9 9\n",
        "0.0e0 -0. +0\n1.0D+00 0 0\n",
    ] {
        two("rows.ply", text("", rows));
        two("rows_crlf.PLY", text("", rows).replace('\n', "\r\n"));
    }
    let commented = text("", rows).replace("element", "obj_info by hand\ncomment  \nelement");
    two("commented.ply", commented);
    let faces = "element face 1\nproperty list uchar int vertex_indices\n";
    two("faces.ply", text(faces, rows));
    let before = text("", "1 2\n3 0 0 0\n\n0 0 0\n1 0 0\n").replace(
        "element vertex",
        "element camera 2\nproperty list uchar float view\nelement nothing 4294967295\n\
         element vertex",
    );
    two("before.ply", before);
    two(
        "capitals.ply",
        text("", rows)
            .replace(" x", " X")
            .replace("vertex", "Vertex"),
    );
}

#[test]
fn properties_nobody_needs_are_passed_over() {
    for (property, rows) in [
        ("property uint8 red\n", "0 0 0 1\n1 0 0 2\n"),
        ("property float Velocity\n", "0 0 0 1\n1 0 0 1\n"),
        ("property list uchar int near\n", "0 0 0 1 5\n1 0 0 2 5 6\n"),
        ("property string material\n", "0 0 0 water\n1 0 0 ice\n"),
        ("property float128 pressure\n", "0 0 0 1\n1 0 0 1,5\n"),
    ] {
        two("needless.ply", text(property, rows));
        let id = format!("{property}property int64 id\n");
        let rows = rows.replacen('\n', " 7\n", 1);
        let rows = rows.trim_end().to_owned() + " 8\n";
        seven_and_eight("needless.ply", text(&id, &rows));
    }
}

#[test]
fn binary_is_read_in_either_order_and_of_any_type() {
    for format in ["binary_little_endian", "binary_big_endian"] {
        for (kind, size) in [
            ("char", 1),
            ("uchar", 1),
            ("int8", 1),
            ("uint8", 1),
            ("short", 2),
            ("ushort", 2),
            ("int16", 2),
            ("uint16", 2),
            ("int", 4),
            ("uint", 4),
            ("int32", 4),
            ("uint32", 4),
            ("int64", 8),
            ("uint64", 8),
        ] {
            seven_and_eight("binary.ply", binary(format, kind, "id", size));
        }
        two("halves.ply", binary(format, "float16", "heat", 2));
        two("doubles.ply", binary(format, "double", "heat", 8));
        // A list of seven bytes, then of eight.
        let mut file =
            header(format, &format!("{XYZ}property list uchar uchar near\n")).into_bytes();
        for (x, count) in [(0.0_f32, 7), (1.0, 8)] {
            let x = match format {
                "binary_big_endian" => x.to_be_bytes(),
                _ => x.to_le_bytes(),
            };
            file.extend([&x[..], &[0; 8], &[count], &vec![9; count.into()]].concat());
        }
        two("lists.ply", file);
        refused(
            "sizeless.ply",
            binary(format, "float128", "heat", 16),
            "`float128`",
        );
    }
    let mut crlf = text("", "")
        .replace("ascii", "binary_little_endian")
        .replace('\n', "\r\n")
        .into_bytes();
    crlf.extend(
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
            .into_iter()
            .flat_map(f32::to_le_bytes),
    );
    two("crlf.ply", crlf);
    let shorts = header("binary_little_endian", &XYZ.replace("float", "short"));
    let shorts = [shorts.as_bytes(), &[0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0]].concat();
    two("shorts.ply", shorts);
}

#[test]
fn what_is_unknown_costs_itself() {
    let unknown = text("", "0 0 0\n1 0 0\n").replace("element", "author us\nelement");
    two("unknown.ply", unknown);
    assert_eq!(logged("unknown.ply", "header's `author` is left out"), 1);

    let frame = two(
        "words.ply",
        text("property int id\n", "0 0 0 seven\n1 0 0 8\n"),
    );
    assert!(frame.ids.is_empty());
    assert_eq!(logged("words.ply", "`id` is left out: line 9: `seven`"), 1);
}

#[test]
fn particles_that_are_not_finite_leave_the_others() {
    for (word, is_finite) in NOT_FINITE {
        let rows = format!("{word} 0 0\n1 0 0\n");
        first_is_finite(&parse("finite.ply", text("", &rows)), word, is_finite);
    }
    assert_eq!(logged("finite.ply", ""), 0);
    assert_eq!(
        fluid_stage::log::count("finite.ply: 1 of its 2 particles are not drawn"),
        1
    );
}

#[test]
fn what_is_something_else_is_refused_by_its_name() {
    let rows = "0 0 0\n1 0 0\n";
    refused("comma.ply", text("", "0,0 0 0\n1,0 0 0\n"), "line 8: `0,0`");
    refused(
        "order.ply",
        text("", rows).replace("ascii", "binary_middle_endian"),
        "middle",
    );
    refused("flat.ply", text("", rows).replace(" z", " w"), "`z`");
    refused(
        "points.ply",
        text("", rows).replace("vertex", "point"),
        "`vertex`",
    );
    for format in ["binary_little_endian", "binary_big_endian"] {
        refused("lie.ply", text("", rows).replace("ascii", format), "text");
    }
    refused("vtk.ply", "# vtk DataFile Version 4.2\n", "a legacy .vtk");
}

#[test]
fn only_what_is_damaged_is_called_so() {
    for (rows, reason) in [
        ("0 0 0\n", "claims 2 of `vertex` and holds 1"),
        ("0 0\n1 0 0\n", "line 8 has fewer"),
        ("0 0 0 0\n1 0 0\n", "line 8 has more"),
        ("0 0 0\n\n1 0 zero\n", "line 10: `zero`"),
    ] {
        damaged("damaged.ply", text("", rows), reason);
    }
    let whole = binary("binary_big_endian", "int", "id", 4);
    damaged(
        "cut.ply",
        &whole[..whole.len() - 1],
        "claims 2 of `vertex` and holds 1",
    );
    damaged(
        "endless.ply",
        text("", "").replace("end_header", ""),
        "does not end",
    );
    damaged(
        "number.ply",
        text("", "").replace("vertex 2", "vertex -2"),
        "`-2`",
    );
}
