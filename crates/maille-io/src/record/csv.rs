//! Tables of commas: their cells as text, and their lines as they are read.

use super::error::{RecordError, complete};
use ::csv::{ReaderBuilder, StringRecord};

/// A text in quotes where it needs them.
pub(crate) fn csv_text(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { csv_quoted(text) } else { text.to_owned() }
}

/// A text in quotes.
pub(super) fn csv_quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// A number with the fewest digits that read back bit for bit; nothing where there is none.
pub(crate) fn csv_number(x: Option<f64>) -> String {
    x.map_or(String::new(), |x| format!("{x:?}"))
}

/// The header, and the lines below it with their numbers; `file` is the name to show in errors.
pub(super) fn csv_lines(file: &str, text: &str) -> Result<(StringRecord, Vec<(usize, StringRecord)>), RecordError> {
    complete(file, text)?;
    let mut lines = Vec::new();
    for found in ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes()).into_records() {
        let next = lines.len() + 1;
        let found = found.map_err(|e| RecordError::malformed(file, next, e.to_string()))?;
        lines.push((found.position().map_or(next, |p| p.line() as usize), found));
    }
    if lines.is_empty() {
        return Err(RecordError::malformed(file, 1, "the header is missing"));
    }
    Ok((lines.remove(0).1, lines))
}
