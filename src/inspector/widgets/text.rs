//! Names, explanations and numbers as they are read.

/// A field's or a variant's name in words: `half_taps` and `BulkFront` are "half taps" and "bulk
/// front".
pub(in crate::inspector) fn words(name: &str) -> String {
    let mut words = String::with_capacity(name.len() + 4);
    for (i, letter) in name.char_indices() {
        match letter {
            '_' => words.push(' '),
            _ if letter.is_ascii_uppercase() => {
                if i > 0 {
                    words.push(' ');
                }
                words.push(letter.to_ascii_lowercase());
            }
            _ => words.push(letter),
        }
    }
    words
}

/// Docs without the marks of Markdown: links are their text, lines of a paragraph are joined.
pub(super) fn plain(docs: &str) -> String {
    let mut text = String::with_capacity(docs.len());
    for line in docs.lines().map(str::trim) {
        if line.is_empty() {
            text.push_str("\n\n");
        } else {
            if !text.is_empty() && !text.ends_with('\n') {
                text.push(' ');
            }
            text.push_str(line);
        }
    }
    let mut plain = String::with_capacity(text.len());
    let mut rest = text.trim();
    while let Some(at) = rest.find(['`', '[', ']']) {
        plain.push_str(&rest[..at]);
        let mark = rest.as_bytes()[at];
        rest = &rest[at + 1..];
        // Where a link goes to, behind its text.
        if mark == b']'
            && rest.starts_with('(')
            && let Some(end) = rest.find(')')
        {
            rest = &rest[end + 1..];
        }
    }
    plain + rest
}

/// Up to four significant digits: a longer text would make the row jump.
pub(in crate::inspector) fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    if !(1e-4..1e7).contains(&size) {
        return format!("{value:.2e}");
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_words() {
        assert_eq!(words("half_taps"), "half taps");
        assert_eq!(words("BulkFront"), "bulk front");
        assert_eq!(words("None"), "none");
    }

    #[test]
    fn docs_lose_their_marks() {
        let docs =
            " How it is. Default:\n [`PlaneFit::DEFAULT`] (`N_ε`).\n\n See [there](Self::there).";
        assert_eq!(
            plain(docs),
            "How it is. Default: PlaneFit::DEFAULT (N_ε).\n\nSee there."
        );
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (2.828_427, "2.828"),
            (f64::from(0.9_f32), "0.9"),
            (25_000.0, "25000"),
            (-30.0, "-30"),
            (0.001_234_56, "0.001235"),
            (123_456.7, "123457"),
            (1e9, "1.00e9"),
            (-1e-6, "-1.00e-6"),
        ] {
            assert_eq!(digits(value), text);
        }
    }
}
