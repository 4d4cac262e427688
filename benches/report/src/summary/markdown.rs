//! Tables in Markdown.

use std::fmt::Write;

/// A table that is written row by row.
pub(super) struct Rows {
    text: String,
}

impl Rows {
    /// With these headings; all columns but the first are numbers.
    pub(super) fn new<S: AsRef<str>>(headings: impl IntoIterator<Item = S>) -> Self {
        let mut rows = Self {
            text: String::new(),
        };
        let headings: Vec<S> = headings.into_iter().collect();
        rows.add(&headings);
        let rules = (0..headings.len()).map(|i| if i == 0 { "---" } else { "---:" });
        rows.add(&rules.collect::<Vec<_>>());
        rows
    }

    pub(super) fn add<S: AsRef<str>>(&mut self, cells: &[S]) {
        self.text.push('|');
        for cell in cells {
            // Writing to a string cannot fail.
            let _ = write!(self.text, " {} |", cell.as_ref());
        }
        self.text.push('\n');
    }

    /// A named row of numbers, of which some may be missing.
    pub(super) fn numbers(&mut self, name: &str, numbers: impl IntoIterator<Item = Option<f64>>) {
        let cells = numbers.into_iter().map(number);
        self.add(
            &[name.to_owned()]
                .into_iter()
                .chain(cells)
                .collect::<Vec<_>>(),
        );
    }

    pub(super) fn finish(self) -> String {
        self.text
    }
}

/// Three digits that count.
pub(super) fn number(value: Option<f64>) -> String {
    let Some(value) = value else {
        return "–".into();
    };
    let size = value.abs();
    if size >= 99.95 {
        format!("{value:.0}")
    } else if size >= 9.995 {
        format!("{value:.1}")
    } else if size >= 0.0995 || size == 0.0 {
        format!("{value:.2}")
    } else if size >= 0.000_995 {
        format!("{value:.4}")
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits() {
        let texts = [123.4, 12.34, 1.234, 0.1234, 0.012_34, 1.23e-5, 0.0].map(|v| number(Some(v)));
        assert_eq!(
            texts,
            ["123", "12.3", "1.23", "0.12", "0.0123", "1.2e-5", "0.00"]
        );
        assert_eq!(number(None), "–");
    }

    #[test]
    fn a_table_has_a_line_for_each_row() {
        let mut rows = Rows::new(["name", "ms"]);
        rows.numbers("a", [Some(1.0)]);
        assert_eq!(
            rows.finish(),
            "| name | ms |\n| --- | ---: |\n| a | 1.00 |\n"
        );
    }
}
