//! Legacy VTK.

use bevy::prelude::*;
use fluid_stage::log;

use super::{NOT_FINITE, damaged, first_is_finite, logged, parse, refused, seven_and_eight, two};

const POINTS: &str = "POINTS 2 float\n0 0 0\n1 0 0\n";
const CELLS: &str = "CELLS 2 4\n1 0\n1 1\nCELL_TYPES 2\n1\n1\n";
const OFFSETS: &str = "CELLS 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY vtktypeint64\n0 1\n\
                       CELL_TYPES 2\n1\n1\n";
const IDS: &str = "POINT_DATA 2\nFIELD FieldData 1\nid 1 2 int\n7 8\n";

fn text(parts: &[&str]) -> String {
    let header = "# vtk DataFile Version 4.2\nfluid\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    header.to_owned() + &parts.concat()
}

/// A binary file with these arrays of the points: name, components, type, bytes.
fn binary(arrays: &[(&str, &str, &[u8])]) -> Vec<u8> {
    let mut file =
        b"# vtk DataFile Version 5.1\nfluid\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n".to_vec();
    file.extend(
        [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]
            .into_iter()
            .flat_map(f32::to_be_bytes),
    );
    file.extend(b"\nVERTICES 3 2\nOFFSETS vtktypeint64\n");
    file.extend([0_i64, 1, 2].into_iter().flat_map(i64::to_be_bytes));
    file.extend(b"\nCONNECTIVITY vtktypeint64\n");
    file.extend([0_i64, 1].into_iter().flat_map(i64::to_be_bytes));
    file.extend(format!("\nPOINT_DATA 2\nFIELD FieldData {}\n", arrays.len()).as_bytes());
    for (name, kind, bytes) in arrays {
        file.extend(format!("{name} 1 2 {kind}\n").as_bytes());
        file.extend(*bytes);
        file.push(b'\n');
    }
    file
}

#[test]
fn every_version_and_section_is_read() {
    let parts: [&[&str]; 12] = [
        &[POINTS, CELLS, IDS],
        &[POINTS, OFFSETS, IDS],
        &[
            "FIELD FieldData 2\nTIME 1 1 double\n0.5\nCYCLE 1 1 int\n42\n",
            POINTS,
            CELLS,
            IDS,
        ],
        &[
            POINTS,
            "METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n",
            CELLS,
            IDS,
        ],
        &[
            POINTS,
            CELLS,
            "CELL_DATA 2\nSCALARS id int 1\nLOOKUP_TABLE default\n1\n1\n",
            IDS,
        ],
        &[
            POINTS,
            CELLS,
            "POINT_DATA 2\nSCALARS id int 1\nLOOKUP_TABLE default\n7\n8\n",
        ],
        &[
            POINTS,
            CELLS,
            "POINT_DATA 2\nSCALARS id int\nLOOKUP_TABLE default\n7\n8\n",
        ],
        &[POINTS, CELLS, "POINT_DATA 2\nSCALARS id int\n7\n8\n"],
        &[
            POINTS,
            "POINT_DATA 2\nCOLOR_SCALARS paint 3\n0 0 1 1 0 0\nSCALARS heat float 1\n\
             LOOKUP_TABLE mine\n1 2\nLOOKUP_TABLE mine 2\n0 0 0 1 1 1 1 1\nNORMALS n float\n\
             0 0 1 0 0 1\nTENSORS t float\n1 0 0 0 1 0 0 0 1 1 0 0 0 1 0 0 0 1\n\
             TEXTURE_COORDINATES uv 2 float\n0 0 1 1\nGLOBAL_IDS id vtkIdType\n7 8\n",
        ],
        &[
            POINTS,
            "POINT_DATA 2\nFIELD FieldData 3\nnormals 3 2 float\n0 0 1 0 0 1\nMETADATA\n\
             COMPONENT_NAMES\nX\nY\nZ\n\ndensity 1 2 float\n1000 1001\nID 1 2 float\n7 8\n",
        ],
        // A field that claims more arrays than it has.
        &[
            POINTS,
            "POINT_DATA 2\nFIELD FieldData 9\nid 1 2 int\n7 8\n",
            CELLS,
        ],
        &[
            "points 2 DOUBLE\n0 0 0 1\n0 0\n",
            "point_data 2\nfield f 1\nid 1 2 INT\n7 8",
        ],
    ];
    for parts in parts {
        let file = text(parts);
        seven_and_eight("sections.vtk", &file);
        let lines = file.replace('\n', "\r\n");
        seven_and_eight("sections_crlf.vtk", lines);
        seven_and_eight("sections_untitled.vtk", file.replace("fluid", ""));
    }
    assert_eq!(logged("sections", ""), 0, "all of it is known");
}

#[test]
fn points_need_no_cells() {
    for parts in [
        &[POINTS, "CELLS 0 0\nCELL_TYPES 0\n"][..],
        &[
            POINTS,
            "CELLS 1 0\nOFFSETS vtktypeint64\n0\nCONNECTIVITY vtktypeint64\n\n",
        ],
        &[POINTS],
    ] {
        two("cells.vtk", text(parts));
        two(
            "cells.vtk",
            text(parts).replace("UNSTRUCTURED_GRID", "POLYDATA"),
        );
        two("cells.vtk", text(parts).to_lowercase());
    }
    let empty = text(&["POINTS 0 float\nCELLS 0 0\nCELL_TYPES 0\n"]);
    assert_eq!(parse("empty.vtk", empty).positions, []);
    let whole = text(&["POINTS 2 short\n0 0 0 1 0 0\n"]);
    two("whole_numbers.vtk", whole);
}

#[test]
fn ids_are_of_any_type() {
    for kind in [
        "char",
        "unsigned_char",
        "short",
        "unsigned_short",
        "int",
        "unsigned_int",
        "long",
        "unsigned_long",
        "float",
        "double",
        "vtkIdType",
        "vtktypeint32",
        "vtktypeint64",
        "vtktypeuint64",
        "int128",
    ] {
        let ids = IDS.replace("int", kind);
        seven_and_eight("types.vtk", text(&[POINTS, CELLS, &ids]));
    }
    let (seven, eight) = (7_u8, 8_u8);
    let bytes = |size: usize| {
        let number = |last| [vec![0; size - 1], vec![last]].concat();
        [number(seven), number(eight)].concat()
    };
    for (kind, size) in [
        ("char", 1),
        ("unsigned_char", 1),
        ("short", 2),
        ("unsigned_short", 2),
        ("int", 4),
        ("unsigned_int", 4),
        ("vtkIdType", 4),
        ("long", 8),
        ("unsigned_long", 8),
        ("vtktypeint8", 1),
        ("vtktypeint16", 2),
        ("vtktypeint32", 4),
        ("vtktypeint64", 8),
        ("vtktypeuint64", 8),
    ] {
        let others = [2.5_f32, 3.5].map(f32::to_be_bytes).concat();
        let file = binary(&[("pressure", "float", &others), ("id", kind, &bytes(size))]);
        seven_and_eight("binary_types.vtk", file);
    }
    assert_eq!(logged("types.vtk", ""), 0);
}

#[test]
fn what_is_unknown_costs_itself() {
    for (number, array) in [
        "material 1 2 string\nclear water\n\n",
        "material 1 2 variant\n13 water\n13 ice\n",
        "weight 1 2 float\n0,5 0,5\n",
    ]
    .iter()
    .enumerate()
    {
        let name = format!("unknown_{number}.vtk");
        let ids = "id 1 2 int\n7 8\n";
        let point_data = "POINT_DATA 2\nFIELD FieldData 2\n";
        seven_and_eight(&name, text(&[POINTS, CELLS, point_data, array, ids]));
        seven_and_eight(&name, text(&[POINTS, CELLS, point_data, ids, array]));
        // Of the whole data set, before its points.
        seven_and_eight(
            &name,
            text(&["FIELD FieldData 1\n", array, POINTS, CELLS, IDS]),
        );
    }
    // One series: its second file has nothing to add.
    assert_eq!(logged("unknown_0.vtk", "`material` is left out"), 1);
    assert_eq!(log::count("unknown_1.vtk"), 0);
    assert_eq!(logged("unknown_2.vtk", "`weight` is left out"), 1);

    // Lengths, strings and numbers, behind each other as VTK writes them.
    let strings = b"\xc5water\xc3ice";
    let ids = [7_i32, 8].map(i32::to_be_bytes).concat();
    for (kind, bytes) in [
        ("string", &strings[..]),
        ("bit", &[0xc0]),
        ("float128", &[9; 32]),
    ] {
        let file = binary(&[("kind", kind, bytes), ("id", "int", &ids)]);
        seven_and_eight(&format!("unknown_{kind}.vtk"), file);
        assert_eq!(
            logged(&format!("unknown_{kind}.vtk"), "`kind` is left out"),
            1
        );
    }

    let unknown = text(&[POINTS, "WEIGHTS 2 heavy\n1 2\n3 4\n", CELLS, IDS]);
    seven_and_eight("unknown_section.vtk", unknown);
    assert_eq!(logged("unknown_section.vtk", "`WEIGHTS` is unknown"), 1);
}

#[test]
fn an_attribute_that_does_not_fit_is_left_out() {
    for (number, array) in [
        "id 2 2 int\n7 8 9 10\n",
        "id 1 3 int\n7 8 9\n",
        "id 1 2 float\n7.5 8\n",
        "id 1 2 string\nseven\neight\n",
        "velocity 1 2 float\n7 8\n",
    ]
    .iter()
    .enumerate()
    {
        let name = format!("unfit{}.vtk", ["a", "b", "c", "d", "e"][number]);
        let point_data = "POINT_DATA 2\nFIELD FieldData 1\n";
        let frame = two(&name, text(&[POINTS, CELLS, point_data, array]));
        assert_eq!((frame.ids.len(), frame.velocities.len()), (0, 0));
        assert_eq!(logged(&name, ""), 1, "{array}");
    }
}

#[test]
fn a_series_is_logged_once() {
    let material = "POINT_DATA 2\nFIELD FieldData 1\nmaterial 1 2 string\nwater\nice\n";
    let file = text(&[POINTS, CELLS, material]);
    for number in 0..20 {
        two(&format!("a/series_{number:04}.vtk"), &file);
    }
    assert_eq!(log::count("series_"), 1);
    two("b/series_0.vtk", &file);
    assert_eq!(log::count("series_"), 2);
}

#[test]
fn particles_that_are_not_finite_leave_the_others() {
    for (word, is_finite) in NOT_FINITE {
        let points = POINTS.replacen('0', word, 1);
        let file = text(&[&points, CELLS, IDS]);
        let frame = parse("finite.vtk", file);
        first_is_finite(&frame, word, is_finite);
        assert_eq!(frame.ids, [7, 8]);
    }
    let fortran = text(&["POINTS 2 double\n0.0D0 0.0d+00 0\n1.0D+00 0 0\n"]);
    two("fortran.vtk", fortran);
}

#[test]
fn what_is_something_else_is_refused_by_its_name() {
    let data_set = |kind| text(&[]).replace("UNSTRUCTURED_GRID", kind);
    for kind in [
        "STRUCTURED_POINTS",
        "STRUCTURED_GRID",
        "RECTILINEAR_GRID",
        "TABLE",
    ] {
        refused(
            "other.vtk",
            data_set(kind) + "DIMENSIONS 1 1 1\nORIGIN 0 0 0\n",
            kind,
        );
    }
    refused(
        "xml.vtk",
        "<?xml version=\"1.0\"?><VTKFile></VTKFile>",
        "XML",
    );
    refused(
        "comma.vtk",
        text(&["POINTS 2 float\n0,0 0 0\n1,0 0 0\n"]),
        "line 6: `0,0`",
    );
    let lie = text(&["POINTS 2 float\n0.0 0.0 0.0\n1.0 0.0 0.0\n"]).replace("ASCII", "BINARY");
    refused("lie.vtk", lie, "text");
}

#[test]
fn only_what_is_damaged_is_called_so() {
    for (parts, reason) in [
        (
            &["POINTS 3 float\n0 0 0\n1 0 0\n"][..],
            "9 numbers are claimed",
        ),
        (&["POINTS 2 float\n0 0 zero\n1 0 0\n"], "line 6: `zero`"),
        (&["POINTS many float\n0 0 0\n"], "POINTS many float"),
        (
            &[POINTS, "POINT_DATA 2\nFIELD f 1\nid 1 2 int\n7"],
            "2 numbers are claimed",
        ),
        (&[], "no POINTS"),
    ] {
        damaged("damaged.vtk", text(parts), reason);
    }
    let ids = [7_i32, 8].map(i32::to_be_bytes).concat();
    let file = binary(&[("id", "int", &ids)]);
    damaged("cut.vtk", &file[..file.len() - 3], "2 numbers are claimed");
    damaged(
        "neither.vtk",
        text(&[]).replace("ASCII", "ASKII"),
        "`ASKII`",
    );
}

#[test]
fn vectors_are_read_in_order() {
    let text = text(&[
        "POINTS 2 float\n1 2 3 4 5 6\n",
        "POINT_DATA 2\nVECTORS Velocity double\n1 2 3 4 5 6\n",
    ]);
    let frame = parse("vectors.vtk", text);
    let expected = [vec3(1.0, 2.0, 3.0), vec3(4.0, 5.0, 6.0)];
    assert_eq!(
        (frame.positions, frame.velocities),
        (expected.into(), expected.into())
    );
}
