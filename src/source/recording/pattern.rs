//! Names of numbered files.

use std::fmt;

use super::{error::RecordingError, format::ParticleFormat};

/// A file name with a number in it: `frames/dam_####.vtk`, as Blender and Houdini write it, or
/// `frames/dam_{}.vtk`, as splashsurf does.
///
/// Files match with any number of digits; written names have at least one digit for each `#`.
/// Without a `#` or `{}` the pattern is the name of one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FramePattern {
    /// With the slash at its end, or empty.
    folder: String,
    before: String,
    /// `None` where the name is that of one file.
    digits: Option<usize>,
    after: String,
}

impl FramePattern {
    /// Parses a pattern.
    ///
    /// # Errors
    /// [`RecordingError::Pattern`] for two numbers, or one in the folder's name, and
    /// [`RecordingError::Frame`] for an unknown extension.
    pub fn parse(pattern: &str) -> Result<Self, RecordingError> {
        let refuse = |reason| {
            Err(RecordingError::Pattern {
                pattern: pattern.into(),
                reason,
            })
        };
        let (folder, name) = pattern.split_at(
            pattern
                .rfind(std::path::is_separator)
                .map_or(0, |at| at + 1),
        );
        let is_sign = |text: &str| text.contains('#') || text.contains("{}");
        if is_sign(folder) {
            return refuse("the number must be in the file's name, not the folder's");
        }
        ParticleFormat::of(name)?;
        let (before, digits, after) = if let Some(start) = name.find('#') {
            let length = name[start..]
                .bytes()
                .take_while(|&byte| byte == b'#')
                .count();
            (&name[..start], Some(length), &name[start + length..])
        } else if let Some((before, after)) = name.split_once("{}") {
            (before, Some(1), after)
        } else {
            (name, None, "")
        };
        if is_sign(before) || is_sign(after) {
            return refuse("there must be one number");
        }
        Ok(Self {
            folder: folder.into(),
            before: before.into(),
            digits,
            after: after.into(),
        })
    }

    /// Whether there is a number in the name.
    pub fn is_numbered(&self) -> bool {
        self.digits.is_some()
    }

    /// The folder, with the slash at its end; empty if there is none.
    pub fn folder(&self) -> &str {
        &self.folder
    }

    /// The name of a frame's file, without the folder.
    pub fn file_name(&self, number: u32) -> String {
        match self.digits {
            Some(digits) => format!("{}{number:0digits$}{}", self.before, self.after),
            None => self.before.clone(),
        }
    }

    /// The number in a file's name, or `None` if the name does not match.
    pub fn number(&self, file_name: &str) -> Option<u32> {
        self.digits?;
        let middle = file_name.strip_prefix(self.before.as_str())?;
        let middle = middle.strip_suffix(self.after.as_str())?;
        // Else "+1" would be a number.
        let is_number = middle.bytes().all(|byte| byte.is_ascii_digit());
        middle.parse().ok().filter(|_| is_number)
    }

    /// The common part of the files' names: `dam` of `frames/dam_####.vtk`.
    pub(super) fn stem(&self) -> &str {
        let stem = self.before.trim_end_matches(['_', '-', '.', ' ']);
        if stem.is_empty() { "recording" } else { stem }
    }
}

impl fmt::Display for FramePattern {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let signs = "#".repeat(self.digits.unwrap_or(0));
        write!(
            formatter,
            "{}{}{signs}{}",
            self.folder, self.before, self.after
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_belong_together() {
        for (pattern, number, name) in [
            ("a/b/dam_####.vtk", 7, "dam_0007.vtk"),
            ("dam_####.vtk", 12345, "dam_12345.vtk"),
            ("dam_{}.xyz", 10, "dam_10.xyz"),
            ("#.ply", 0, "0.ply"),
            ("f#_x2.bgeo", 3, "f3_x2.bgeo"),
        ] {
            let pattern = FramePattern::parse(pattern).unwrap();
            assert_eq!(pattern.file_name(number), name);
            assert_eq!(pattern.number(name), Some(number));
        }
        let pattern = FramePattern::parse("a/dam_##.vtk").unwrap();
        assert_eq!(pattern.folder(), "a/");
        assert_eq!(pattern.stem(), "dam");
        assert_eq!(pattern.to_string(), "a/dam_##.vtk");
        assert_eq!(pattern.number("dam_9.vtk"), Some(9), "any number of digits");
        for other in [
            "dam_.vtk",
            "dam_x.vtk",
            "dam_+1.vtk",
            "dam_1.vtk.bak",
            "xdam_1.vtk",
            "dam_99999999999.vtk",
        ] {
            assert_eq!(pattern.number(other), None, "{other}");
        }
    }

    #[test]
    fn what_is_no_pattern_is_named() {
        for bad in [
            "a#/b.vtk",
            "a#b#.vtk",
            "a_{}_{}.vtk",
            "a#_{}.vtk",
            "a_###.txt",
            "a_###",
            "",
        ] {
            let error = FramePattern::parse(bad).unwrap_err().to_string();
            assert!(error.contains(bad), "{error}");
        }
        assert!(!FramePattern::parse("dam.vtk").unwrap().is_numbered());
    }
}
