//! Reads PLY.

use super::{
    super::{
        content,
        found::{Fault, Found},
        role::{IDS, RADII, Role, VELOCITIES},
        scan::Scan,
    },
    header::{self, Element, Encoding},
    rows,
};

/// The properties of the same place in [`Columns::numbers`].
const VECTORS: [&str; 6] = ["x", "y", "z", "vx", "vy", "vz"];
const ID: usize = 6;
const RADIUS: usize = 7;

pub(in super::super) fn read(bytes: &[u8]) -> Result<Found, Fault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut scan = Scan::new(bytes);
    let mut found = Found::default();
    let (encoding, elements) = header::read(&mut scan, &mut found)?;
    let mut elements = elements.iter();
    for element in &mut elements {
        if !element.name.eq_ignore_ascii_case("vertex") {
            rows::read(&mut scan, encoding, element, &mut |_, _| {})?;
            continue;
        }
        let mut columns = Columns::of(element)?;
        check_content(&scan, encoding, element, &columns)?;
        rows::read(&mut scan, encoding, element, &mut |property, value| {
            columns.push(property, value);
        })?;
        columns.put_into(&mut found)?;
        return Ok(found);
    }
    Err(Fault::Unsupported("it has no element `vertex`".into()))
}

/// The properties that particles have.
struct Columns {
    /// For each property of the element.
    column: Vec<Option<usize>>,
    has: [bool; 8],
    numbers: [Vec<f64>; 8],
    /// The first that is no number.
    faults: [Option<Fault>; 8],
}

impl Columns {
    fn of(vertex: &Element) -> Result<Self, Fault> {
        let mut columns = Self {
            column: Vec::new(),
            has: [false; 8],
            numbers: Default::default(),
            faults: Default::default(),
        };
        for property in &vertex.properties {
            let name = property.name.as_str();
            let column = match Role::of(name) {
                Some(Role::Id) => Some(ID),
                Some(Role::Radius) => Some(RADIUS),
                _ => VECTORS
                    .iter()
                    .position(|known| known.eq_ignore_ascii_case(name)),
            };
            let column = column.filter(|&at| property.count.is_none() && !columns.has[at]);
            if let Some(at) = column {
                columns.has[at] = true;
            }
            columns.column.push(column);
        }
        match (0..3).find(|&axis| !columns.has[axis]) {
            None => Ok(columns),
            Some(axis) => {
                let missing = VECTORS[axis];
                Err(Fault::Unsupported(format!(
                    "its vertices have no `{missing}`"
                )))
            }
        }
    }

    fn push(&mut self, property: usize, value: Result<f64, Fault>) {
        let Some(Some(column)) = self.column.get(property).copied() else {
            return;
        };
        let value = value.unwrap_or_else(|fault| {
            self.faults[column].get_or_insert(fault);
            f64::NAN
        });
        self.numbers[column].push(value);
    }

    /// The numbers of these columns side by side, or why one is none.
    fn take<const N: usize>(&mut self, columns: [usize; N]) -> Result<Vec<f64>, Fault> {
        if let Some(fault) = columns
            .iter()
            .find_map(|&column| self.faults[column].take())
        {
            return Err(fault);
        }
        let count = self.numbers[columns[0]].len();
        let row = |row: usize| columns.map(|column| self.numbers[column][row]);
        Ok((0..count).flat_map(row).collect())
    }

    fn put_into(mut self, found: &mut Found) -> Result<(), Fault> {
        found.set_positions(&self.take([0, 1, 2])?);
        if self.has[3..6].iter().all(|&has| has) {
            found.attribute(VELOCITIES[0], 3, || self.take([3, 4, 5]));
        }
        for (column, name) in [(ID, IDS[0]), (RADIUS, RADII[0])] {
            if self.has[column] {
                found.attribute(name, 1, || self.take([column]));
            }
        }
        Ok(())
    }
}

/// Refuses text that is said to be binary floats.
fn check_content(
    scan: &Scan,
    encoding: Encoding,
    vertex: &Element,
    columns: &Columns,
) -> Result<(), Fault> {
    let x = columns.column.iter().position(|&column| column == Some(0));
    let is_float = x
        .and_then(|x| vertex.properties[x].item.as_ref().ok())
        .is_some_and(|number| number.is_float());
    if encoding != Encoding::Text && is_float && content::is_text(scan.rest()) {
        let reason = "it says that it is binary, and its vertices are text";
        return Err(Fault::Unsupported(reason.into()));
    }
    Ok(())
}
