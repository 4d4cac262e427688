//! The report in words and tables.
pub(crate) fn write(_t: &crate::Table, _a: &str, _f: &std::path::Path) -> Result<(), crate::ReportError> { Ok(()) }
