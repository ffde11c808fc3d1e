//! `limits.csv`.

use super::{
    csv::{csv_lines, csv_number, csv_quoted, csv_text},
    error::RecordError,
};
use ::csv::StringRecord;
use maille::record::{Entry, LIMIT_COLUMNS, LimitRow};

/// Lengths of earlier tables: one that ends after so many columns is read too, the others being empty.
const EARLIER_COLUMNS: [usize; 5] = [30, 36, 40, 42, 44];

/// The table as text. `design` and `cell` are always quoted: `"1.10"` is a name, not a number.
///
/// Fails with [`RecordError::NotFinite`] on a number that is there but infinite or NaN.
pub fn write_limits(rows: &[LimitRow]) -> Result<String, RecordError> {
    let mut out = LIMIT_COLUMNS.map(|column| column.name).join(",") + "\n";
    for row in rows {
        for (i, column) in LIMIT_COLUMNS.iter().enumerate() {
            let cell = (column.get)(row);
            if let Entry::Number(value) = cell
                && !value.is_finite()
            {
                let (direction_deg, l2, field) = (row.direction_deg, row.l2, column.name);
                return Err(RecordError::NotFinite { direction_deg, l2, field, value });
            }
            out.push_str(if i == 0 { "" } else { "," });
            out.push_str(&csv_cell(column.name, cell));
        }
        out.push('\n');
    }
    Ok(out)
}

/// A value as it stands in a table of commas.
pub(crate) fn csv_cell(column: &str, cell: Entry<'_>) -> String {
    match cell {
        Entry::Empty => String::new(),
        Entry::Text(text) if matches!(column, "design" | "cell") => csv_quoted(text),
        Entry::Text(text) => csv_text(text),
        Entry::Number(x) => csv_number(Some(x)),
        Entry::Count(n) => n.to_string(),
        Entry::Flag(flag) => flag.to_string(),
    }
}

/// Reads the table; `file` is the name to show in errors. Columns after [`LIMIT_COLUMNS`] are ignored, and those that an
/// older table does not have are empty.
pub fn read_limits(file: &str, text: &str) -> Result<Vec<LimitRow>, RecordError> {
    let (header, lines) = csv_lines(file, text)?;
    let known = EARLIER_COLUMNS.into_iter().find(|&n| n == header.len()).unwrap_or(LIMIT_COLUMNS.len());
    for (i, column) in LIMIT_COLUMNS.iter().enumerate().take(known) {
        let (found, expected) = (header.get(i).unwrap_or_default(), column.name);
        if found != expected {
            let problem = format!("column {} is \"{found}\", expected \"{expected}\"", i + 1);
            return Err(RecordError::malformed(file, 1, problem));
        }
    }
    let row = |(line, cells): (usize, StringRecord)| {
        let malformed = |problem| RecordError::malformed(file, line, problem);
        if cells.len() != header.len() {
            return Err(malformed(format!("{} columns, expected {}", cells.len(), header.len())));
        }
        let mut row = LimitRow::default();
        for (column, text) in LIMIT_COLUMNS.iter().zip(&cells) {
            let wrong = |what| malformed(format!("column {}: \"{text}\" is {what}", column.name));
            (column.set)(&mut row, text).map_err(wrong)?;
        }
        Ok(row)
    };
    lines.into_iter().map(row).collect()
}
