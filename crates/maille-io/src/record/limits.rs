//! `limits.csv`.

use super::error::{RecordError, complete};
use csv::{ReaderBuilder, StringRecord};
use maille::record::{LimitRow, Status};
use std::fmt::Display;
use std::str::FromStr;

/// The columns, in order. A later version may add columns at the end; it renames and moves none.
pub const LIMIT_COLUMNS: [&str; 30] = [
    "design",
    "minor_radius",
    "direction_deg",
    "l2",
    "method",
    "cell",
    "status",
    "l1",
    "lambda1",
    "lambda2",
    "stretch1",
    "stretch2",
    "max_overlap",
    "min_gap",
    "iterations",
    "runs",
    "wall_s",
    "bound_l1",
    "bound_kind",
    "bound_gap",
    "dual_residual",
    "complementarity",
    "min_multiplier",
    "min_curvature",
    "zero_modes",
    "links_ok",
    "n_starts",
    "n_distinct",
    "own_image_force",
    "l1_uncertified",
];

/// The table as text. `design` and `cell` are always quoted: `"1.10"` is a name, not a number.
///
/// Fails with [`RecordError::NotFinite`] on a number that is there but infinite or NaN.
pub fn write_limits(rows: &[LimitRow]) -> Result<String, RecordError> {
    let mut out = LIMIT_COLUMNS.join(",") + "\n";
    for row in rows {
        let number = |field: &'static str, x: Option<f64>| match x {
            None => Ok(String::new()),
            Some(x) if x.is_finite() => Ok(format!("{x:?}")),
            Some(value) => Err(RecordError::NotFinite { direction_deg: row.direction_deg, l2: row.l2, field, value }),
        };
        let cells = [
            quoted(&row.design),
            number("minor_radius", row.minor_radius)?,
            number("direction_deg", Some(row.direction_deg))?,
            number("l2", Some(row.l2))?,
            row.method.clone(),
            quoted(&row.cell),
            row.status.name().to_owned(),
            number("l1", row.l1)?,
            number("lambda1", row.lambda1)?,
            number("lambda2", row.lambda2)?,
            number("stretch1", row.stretch1)?,
            number("stretch2", row.stretch2)?,
            number("max_overlap", row.max_overlap)?,
            number("min_gap", row.min_gap)?,
            row.iterations.to_string(),
            row.runs.to_string(),
            number("wall_s", Some(row.wall_s))?,
            number("bound_l1", row.bound_l1)?,
            row.bound_kind.clone().unwrap_or_default(),
            number("bound_gap", row.bound_gap)?,
            number("dual_residual", row.dual_residual)?,
            number("complementarity", row.complementarity)?,
            number("min_multiplier", row.min_multiplier)?,
            number("min_curvature", row.min_curvature)?,
            shown(row.zero_modes),
            shown(row.links_ok),
            shown(row.n_starts),
            shown(row.n_distinct),
            number("own_image_force", row.own_image_force)?,
            number("l1_uncertified", row.l1_uncertified)?,
        ];
        out.push_str(&cells.join(","));
        out.push('\n');
    }
    Ok(out)
}

fn shown<T: Display>(x: Option<T>) -> String {
    x.map_or(String::new(), |x| x.to_string())
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

/// Reads the table; `file` is the name to show in errors. Columns after [`LIMIT_COLUMNS`] are ignored.
pub fn read_limits(file: &str, text: &str) -> Result<Vec<LimitRow>, RecordError> {
    complete(file, text)?;
    let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut records = reader.records();
    let header = match records.next() {
        None => return Err(RecordError::malformed(file, 1, "the header is missing")),
        Some(header) => header.map_err(|e| RecordError::malformed(file, 1, e.to_string()))?,
    };
    for (i, expected) in LIMIT_COLUMNS.iter().enumerate() {
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
    let mut cells = LIMIT_COLUMNS.iter().copied().zip(record);
    let mut next = || cells.next().expect("as many cells as columns");
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
    })
}

type Cell<'a> = (&'static str, &'a str);

fn parse<T: FromStr<Err: Display>>((column, text): Cell<'_>, expected: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("column {column}: \"{text}\" is not {expected}"))
}

fn number(cell: Cell<'_>) -> Result<f64, String> {
    let x: f64 = parse(cell, "a number")?;
    if x.is_finite() { Ok(x) } else { Err(format!("column {}: \"{}\" is not finite", cell.0, cell.1)) }
}

fn optional(cell: Cell<'_>) -> Result<Option<f64>, String> {
    if cell.1.is_empty() { Ok(None) } else { number(cell).map(Some) }
}

fn some<T: FromStr<Err: Display>>(cell: Cell<'_>, expected: &str) -> Result<Option<T>, String> {
    if cell.1.is_empty() { Ok(None) } else { parse(cell, expected).map(Some) }
}

fn status((column, text): Cell<'_>) -> Result<Status, String> {
    let found = Status::ALL.into_iter().find(|s| s.name() == text);
    found.ok_or_else(|| format!("column {column}: \"{text}\" is no status"))
}
