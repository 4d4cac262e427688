//! The lines between the numbers of a legacy `.vtk`.

use super::super::scan::words;

/// What a line announces. Keywords are of any case.
pub(super) enum Header<'a> {
    DataSet(&'a [u8]),
    Points {
        count: usize,
        kind: &'a [u8],
    },
    /// One list of so many integers, or since version 5.1 two lists of so many.
    Cells {
        offsets: usize,
        connectivity: usize,
    },
    CellTypes(usize),
    /// What follows belongs to so many points.
    PointData(usize),
    /// What follows belongs to so many cells.
    CellData(usize),
    /// Numbers with a name.
    Array {
        name: &'a [u8],
        kind: &'a [u8],
        components: usize,
        /// Of what the section belongs to, if the line does not say.
        tuples: Option<usize>,
    },
    /// Bytes, or from 0 to 1 in text: so many for each.
    Colors(usize),
    /// Bytes, or from 0 to 1 in text: so many of red, green, blue and alpha.
    LookupTable(usize),
    /// Lines up to an empty one.
    MetaData,
    /// The number of arrays that follow, which say themselves what they are.
    Field,
    Unknown,
}

impl<'a> Header<'a> {
    pub(super) fn of(line: &'a [u8]) -> Self {
        Self::known(line).unwrap_or(Self::Unknown)
    }

    fn known(line: &'a [u8]) -> Option<Self> {
        let mut all = words(line);
        let mut words = [&b""[..]; 5];
        for (word, next) in words.iter_mut().zip(&mut all) {
            *word = next;
        }
        let [first, a, b, c, more] = words;
        if !more.is_empty() {
            return None;
        }
        let array = |name, kind, components| Self::Array {
            name,
            kind,
            components,
            tuples: None,
        };
        // An array of a field may have a keyword for its name.
        if let (Some(components), Some(tuples)) = (count(a), count(b))
            && c.first().is_some_and(u8::is_ascii_alphabetic)
        {
            return Some(Self::Array {
                name: first,
                kind: c,
                components,
                tuples: Some(tuples),
            });
        }
        let keyword = first.to_ascii_uppercase();
        let header = match (keyword.as_slice(), [a, b, c]) {
            (b"DATASET", [kind @ [_, ..], b"", b""]) => Self::DataSet(kind),
            (b"POINTS", [number, kind, b""]) => Self::Points {
                count: count(number)?,
                kind,
            },
            (
                b"CELLS" | b"VERTICES" | b"LINES" | b"POLYGONS" | b"TRIANGLE_STRIPS",
                [offsets, connectivity, b""],
            ) => Self::Cells {
                offsets: count(offsets)?,
                connectivity: count(connectivity)?,
            },
            (b"CELL_TYPES", [number, b"", b""]) => Self::CellTypes(count(number)?),
            (b"POINT_DATA", [number, b"", b""]) => Self::PointData(count(number)?),
            (b"CELL_DATA", [number, b"", b""]) => Self::CellData(count(number)?),
            (b"SCALARS", [name, kind @ [_, ..], b""]) => array(name, kind, 1),
            (b"SCALARS", [name, kind, components]) => array(name, kind, count(components)?),
            (b"VECTORS" | b"NORMALS", [name, kind @ [_, ..], b""]) => array(name, kind, 3),
            (b"TENSORS", [name, kind @ [_, ..], b""]) => array(name, kind, 9),
            (b"TENSORS6", [name, kind @ [_, ..], b""]) => array(name, kind, 6),
            (b"TEXTURE_COORDINATES", [name, components, kind]) => {
                array(name, kind, count(components)?)
            }
            (b"GLOBAL_IDS" | b"PEDIGREE_IDS" | b"EDGE_FLAGS", [name, kind @ [_, ..], b""]) => {
                array(name, kind, 1)
            }
            (b"COLOR_SCALARS", [_, components, b""]) => Self::Colors(count(components)?),
            (b"LOOKUP_TABLE", [_, colors, b""]) => Self::LookupTable(count(colors)?),
            (b"FIELD", [_, arrays, b""]) => {
                count(arrays)?;
                Self::Field
            }
            (b"METADATA", [b"", b"", b""]) => Self::MetaData,
            _ => return None,
        };
        Some(header)
    }
}

fn count(word: &[u8]) -> Option<usize> {
    str::from_utf8(word).ok()?.parse().ok()
}
