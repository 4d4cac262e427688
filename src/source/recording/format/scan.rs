//! A walk through a file's bytes.

/// The bytes of a file and the place in them. Nothing is copied.
#[derive(Clone, Copy)]
pub(super) struct Scan<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Scan<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The next bytes, if there are so many.
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let taken = self.rest().get(..count)?;
        self.at += count;
        Some(taken)
    }

    /// The next line without its end, or none after the last.
    pub(super) fn line(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        if rest.is_empty() {
            return None;
        }
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        Some(rest[..length.unwrap_or(rest.len())].trim_ascii())
    }

    /// The next word, on this line or another.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest();
        let start = rest.trim_ascii_start();
        let end = start.iter().position(u8::is_ascii_whitespace);
        let word = &start[..end.unwrap_or(start.len())];
        self.at += rest.len() - start.len() + word.len();
        (!word.is_empty()).then_some(word)
    }

    /// The number of the line that holds the last byte passed, from 1.
    pub(super) fn line_number(&self) -> usize {
        let passed = &self.bytes[..self.at.saturating_sub(1)];
        1 + passed.iter().filter(|&&byte| byte == b'\n').count()
    }
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
}

/// Bytes as a message shows them: printable, on one line, and not too many.
pub(super) fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 32;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let end = if bytes.len() > MOST { "…" } else { "" };
    format!("`{}{end}`", text.escape_debug())
}
