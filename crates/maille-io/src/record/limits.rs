//! `limits.csv`.

use super::columns::{Cell, Column, EARLIER_COLUMNS, LIMIT_COLUMNS};
use super::error::{RecordError, complete};
use csv::{ReaderBuilder, StringRecord};
use maille::record::{LimitRow, Status};
use std::fmt::Display;
use std::str::FromStr;

/// The table as text. `design` and `cell` are always quoted: `"1.10"` is a name, not a number.
///
/// Fails with [`RecordError::NotFinite`] on a number that is there but infinite or NaN.
pub fn write_limits(rows: &[LimitRow]) -> Result<String, RecordError> {
    let mut out = LIMIT_COLUMNS.map(|column| column.name).join(",") + "\n";
    for row in rows {
        for (i, column) in LIMIT_COLUMNS.iter().enumerate() {
            let cell = column.values.of(row);
            if let Cell::Number(value) = cell
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

/// A value as it stands in a table of commas; numbers with the fewest digits that read back bit for bit.
pub(crate) fn csv_cell(column: &str, cell: Cell<'_>) -> String {
    let quote = |text: &str| matches!(column, "design" | "cell") || text.contains([',', '"', '\n', '\r']);
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) if quote(text) => format!("\"{}\"", text.replace('"', "\"\"")),
        Cell::Text(text) => text.to_owned(),
        Cell::Number(x) => format!("{x:?}"),
        Cell::Count(n) => n.to_string(),
        Cell::Flag(flag) => flag.to_string(),
    }
}

/// Reads the table; `file` is the name to show in errors. Columns after [`LIMIT_COLUMNS`] are ignored, and those that an
/// older table does not have are empty.
pub fn read_limits(file: &str, text: &str) -> Result<Vec<LimitRow>, RecordError> {
    complete(file, text)?;
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut records = reader.records();
    let header = match records.next() {
        None => return Err(RecordError::malformed(file, 1, "the header is missing")),
        Some(header) => header.map_err(|e| RecordError::malformed(file, 1, e.to_string()))?,
    };
    let known = EARLIER_COLUMNS.into_iter().find(|&n| n == header.len()).unwrap_or(LIMIT_COLUMNS.len());
    for (i, Column { name: expected, .. }) in LIMIT_COLUMNS.iter().enumerate().take(known) {
        let found = header.get(i).unwrap_or_default();
        if found != *expected {
            let problem = format!("column {} is \"{found}\", expected \"{expected}\"", i + 1);
            return Err(RecordError::malformed(file, 1, problem));
        }
    }
    let mut rows = Vec::new();
    for record in records {
        let record = record.map_err(|e| RecordError::malformed(file, rows.len() + 2, e.to_string()))?;
        let line = record.position().map_or(rows.len() + 2, |p| p.line() as usize);
        if record.len() != header.len() {
            let problem = format!("{} columns, expected {}", record.len(), header.len());
            return Err(RecordError::malformed(file, line, problem));
        }
        rows.push(row(&record).map_err(|problem| RecordError::malformed(file, line, problem))?);
    }
    Ok(rows)
}

fn row(record: &StringRecord) -> Result<LimitRow, String> {
    let mut cells = LIMIT_COLUMNS.iter().map(|column| column.name).zip(record);
    // A cell that an older table does not have reads as an empty one.
    let mut next = || cells.next().unwrap_or_default();
    Ok(LimitRow {
        design: next().1.to_owned(),
        minor_radius: optional(next())?,
        direction_deg: number(next())?,
        l2: number(next())?,
        method: next().1.to_owned(),
        cell: next().1.to_owned(),
        status: status(next())?,
        l1: optional(next())?,
        lambda1: optional(next())?,
        lambda2: optional(next())?,
        stretch1: optional(next())?,
        stretch2: optional(next())?,
        max_overlap: optional(next())?,
        min_gap: optional(next())?,
        iterations: parse(next(), "a whole number")?,
        runs: parse(next(), "a whole number")?,
        wall_s: number(next())?,
        bound_l1: optional(next())?,
        bound_kind: some(next(), "a word")?,
        bound_gap: optional(next())?,
        dual_residual: optional(next())?,
        complementarity: optional(next())?,
        min_multiplier: optional(next())?,
        min_curvature: optional(next())?,
        zero_modes: some(next(), "a whole number")?,
        links_ok: some(next(), "true or false")?,
        n_starts: some(next(), "a whole number")?,
        n_distinct: some(next(), "a whole number")?,
        own_image_force: optional(next())?,
        l1_uncertified: optional(next())?,
        lateral: some(next(), "a word")?,
        shear: some(next(), "a word")?,
        l2_min: optional(next())?,
        l2_max: optional(next())?,
        shear_min: optional(next())?,
        shear_max: optional(next())?,
        a1_x: optional(next())?,
        a1_y: optional(next())?,
        a2_x: optional(next())?,
        a2_y: optional(next())?,
        end: some(next(), "a word")?,
        by_cell: some(next(), "a text")?,
        image_of_deg: optional(next())?,
        grows_with_cell: some(next(), "true or false")?,
    })
}

/// Column and text.
type Found<'a> = (&'static str, &'a str);

fn parse<T: FromStr<Err: Display>>((column, text): Found<'_>, expected: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("column {column}: \"{text}\" is not {expected}"))
}

fn number(cell: Found<'_>) -> Result<f64, String> {
    let x: f64 = parse(cell, "a number")?;
    if x.is_finite() { Ok(x) } else { Err(format!("column {}: \"{}\" is not finite", cell.0, cell.1)) }
}

fn optional(cell: Found<'_>) -> Result<Option<f64>, String> {
    if cell.1.is_empty() { Ok(None) } else { number(cell).map(Some) }
}

fn some<T: FromStr<Err: Display>>(cell: Found<'_>, expected: &str) -> Result<Option<T>, String> {
    if cell.1.is_empty() { Ok(None) } else { parse(cell, expected).map(Some) }
}

fn status((column, text): Found<'_>) -> Result<Status, String> {
    let found = Status::ALL.into_iter().find(|s| s.name() == text);
    found.ok_or_else(|| format!("column {column}: \"{text}\" is no status"))
}
