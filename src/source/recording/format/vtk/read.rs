//! Reads legacy `.vtk`.
//!
//! A file is read line by line. A line that announces numbers is followed by them, whether they
//! are needed or not. Any other line is passed over, up to the next one that is known: so an
//! unknown word costs what it announces and nothing else.

use super::{
    super::{
        content,
        found::{Fault, Found},
        scan::{Scan, shown, words},
    },
    header::Header,
    values::Values,
};

pub(in super::super) fn read(bytes: &[u8]) -> Result<Found, Fault> {
    const MAGIC: &[u8] = b"# vtk DataFile";
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let begins = bytes
        .get(..MAGIC.len().min(bytes.len()))
        .unwrap_or_default();
    if begins.is_empty() || !MAGIC[..begins.len()].eq_ignore_ascii_case(begins) {
        let what = content::described(bytes);
        return Err(Fault::Unsupported(format!("no legacy .vtk: {what}")));
    }
    let mut scan = Scan::new(bytes);
    let _version = scan.line();
    let _title = scan.line();
    let kind = scan.word().unwrap_or_default();
    let is_text = kind.eq_ignore_ascii_case(b"ascii");
    if !is_text && !kind.eq_ignore_ascii_case(b"binary") {
        let kind = shown(kind);
        return Err(Fault::Damaged(format!(
            "its third line is {kind}, neither ASCII nor BINARY"
        )));
    }
    scan.line();
    let mut reader = Reader {
        scan,
        is_text,
        section: Section::DataSet,
        has_points: false,
        is_lost: false,
        found: Found::default(),
    };
    while let Some(line) = reader.scan.line() {
        reader.section(line)?;
    }
    if !reader.has_points {
        return Err(Fault::Damaged("it has no POINTS".into()));
    }
    Ok(reader.found)
}

/// What arrays belong to.
#[derive(Clone, Copy)]
enum Section {
    DataSet,
    /// So many points.
    Points(usize),
    /// So many cells.
    Cells(usize),
}

struct Reader<'a> {
    scan: Scan<'a>,
    is_text: bool,
    section: Section,
    has_points: bool,
    /// Whether the lines are those of something unknown, which is noted.
    is_lost: bool,
    found: Found,
}

impl<'a> Reader<'a> {
    /// What a line announces, and the numbers after it.
    fn section(&mut self, line: &'a [u8]) -> Result<(), Fault> {
        let header = Header::of(line);
        if let Header::Unknown = header {
            return self.unknown(line);
        }
        self.is_lost = false;
        match header {
            Header::DataSet(kind) => check_data_set(kind)?,
            Header::Points { count, kind } => self.points(count, kind)?,
            Header::Cells {
                offsets,
                connectivity,
            } => self.cells(offsets, connectivity)?,
            Header::CellTypes(count) => self.pass("CELL_TYPES", b"int", count)?,
            Header::PointData(count) => self.section = Section::Points(count),
            Header::CellData(count) => self.section = Section::Cells(count),
            Header::Array {
                name,
                kind,
                components,
                tuples,
            } => self.array(name, kind, components, tuples)?,
            Header::Colors(components) => {
                let count = components.saturating_mul(self.tuples());
                self.pass("COLOR_SCALARS", b"unsigned_char", count)?;
            }
            Header::LookupTable(colors) => {
                self.pass("LOOKUP_TABLE", b"unsigned_char", colors.saturating_mul(4))?;
            }
            Header::MetaData => while self.scan.line().is_some_and(|line| !line.is_empty()) {},
            Header::Field | Header::Unknown => {}
        }
        Ok(())
    }

    fn unknown(&mut self, line: &[u8]) -> Result<(), Fault> {
        let Some(first) = words(line).next() else {
            return Ok(());
        };
        if first.eq_ignore_ascii_case(b"POINTS") {
            let line = shown(line);
            return Err(Fault::Damaged(format!(
                "{line} is no number of points and their type"
            )));
        }
        if !self.is_lost {
            let first = shown(first);
            let text = format!("its {first} is unknown and left out");
            self.found.note(&first, text);
            self.is_lost = true;
        }
        Ok(())
    }

    /// How many things the section is about.
    fn tuples(&self) -> usize {
        match self.section {
            Section::DataSet => 0,
            Section::Points(count) | Section::Cells(count) => count,
        }
    }

    fn values(&mut self, kind: &[u8], count: usize) -> Result<Values<'a>, Fault> {
        Values::read(&mut self.scan, self.is_text, kind, count)
    }

    fn points(&mut self, count: usize, kind: &[u8]) -> Result<(), Fault> {
        let values = self.values(kind, count.saturating_mul(3))?;
        if let Values::Binary(number, bytes) = values
            && number.is_float()
            && content::is_text(bytes)
        {
            let reason = "it says that it is binary, and its points are text";
            return Err(Fault::Unsupported(reason.into()));
        }
        let numbers = values.numbers()?;
        if !self.has_points {
            self.found.set_positions(&numbers);
            self.has_points = true;
        }
        Ok(())
    }

    fn cells(&mut self, offsets: usize, connectivity: usize) -> Result<(), Fault> {
        let Some(kind) = self.list("OFFSETS") else {
            return self.pass("CELLS", b"int", connectivity);
        };
        self.pass("OFFSETS", kind, offsets)?;
        match self.list("CONNECTIVITY") {
            Some(kind) => self.pass("CONNECTIVITY", kind, connectivity),
            None => Ok(()),
        }
    }

    /// The type of the list of cells that comes next, if it has this name.
    fn list(&mut self, name: &str) -> Option<&'a [u8]> {
        let mut ahead = self.scan;
        if !ahead.word()?.eq_ignore_ascii_case(name.as_bytes()) {
            return None;
        }
        let kind = ahead.word()?;
        ahead.line();
        self.scan = ahead;
        Some(kind)
    }

    fn array(
        &mut self,
        name: &[u8],
        kind: &[u8],
        components: usize,
        tuples: Option<usize>,
    ) -> Result<(), Fault> {
        let mut ahead = self.scan;
        if tuples.is_none()
            && let Some(line) = ahead.line()
            && words(line)
                .next()
                .is_some_and(|word| word.eq_ignore_ascii_case(b"LOOKUP_TABLE"))
        {
            self.scan = ahead;
        }
        let count = components.saturating_mul(tuples.unwrap_or_else(|| self.tuples()));
        let name = String::from_utf8_lossy(name);
        match (self.values(kind, count)?, self.section) {
            (Values::Unknown(fault), _) => self.leave_out(&name, &fault),
            (values, Section::Points(_)) => {
                self.found.attribute(&name, components, || values.numbers());
            }
            _ => {}
        }
        Ok(())
    }

    /// Passes numbers that nobody needs.
    fn pass(&mut self, name: &str, kind: &[u8], count: usize) -> Result<(), Fault> {
        if let Values::Unknown(fault) = self.values(kind, count)? {
            self.leave_out(name, &fault);
        }
        Ok(())
    }

    fn leave_out(&mut self, name: &str, fault: &Fault) {
        self.found.leave_out(name, fault);
        self.is_lost = true;
    }
}

fn check_data_set(kind: &[u8]) -> Result<(), Fault> {
    let known: [&[u8]; 2] = [b"UNSTRUCTURED_GRID", b"POLYDATA"];
    if known.iter().any(|known| known.eq_ignore_ascii_case(kind)) {
        return Ok(());
    }
    Err(Fault::Unsupported(format!(
        "it is {}; UNSTRUCTURED_GRID or POLYDATA is expected",
        shown(kind)
    )))
}
