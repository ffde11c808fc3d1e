//! A table for the terminal: aligned, rounded, as wide as the terminal.

use super::{Field, Table};
use crate::{numbers::counted, record::NamedRecord};
use maille::record::{Entry, Kind};
use std::fmt::Write;

/// How much of a table is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extent {
    /// Letters in a line; all columns are shown if there is no limit.
    pub width: Option<usize>,
    /// Rows at most.
    pub rows: Option<usize>,
}

/// Columns of a first look, in order of importance.
const FIRST_LOOK: [&str; 13] = [
    "record",
    "design",
    "minor_radius",
    "method",
    "direction_deg",
    "l2",
    "l1",
    "status",
    "bound_l1",
    "grows_with_cell",
    "image_of_deg",
    "iterations",
    "wall_s",
];
/// Decimals of a rounded number.
const DECIMALS: usize = 6;
/// Where the largest number of a column is outside of these, its numbers are shown with powers of ten.
const PLAIN: std::ops::Range<f64> = 1e-3..1e7;
const GAP: &str = "  ";
const EMPTY: &str = "-";

impl Field {
    /// The columns of a first look at records; the numbers that studies have varied stand before the direction.
    pub fn first_look(records: &[NamedRecord]) -> Vec<Self> {
        let all = Self::all(records, records.len() > 1);
        let named = |name: &&str| all.iter().find(|field| field.name() == *name).cloned();
        let mut fields: Vec<Self> = FIRST_LOOK.iter().filter_map(named).collect();
        let at = fields.iter().position(|field| field.name() == "direction_deg").unwrap_or(0);
        fields.splice(at..at, Self::varied_in(records));
        fields
    }
}

/// A column, drawn.
struct Drawn {
    name: String,
    unit: String,
    cells: Vec<String>,
    left: bool,
    width: usize,
}

impl Table<'_> {
    /// The table as text, with a line that says how much of it is shown. Numbers are rounded; the other formats have all
    /// digits.
    pub fn text(&self, extent: Extent) -> String {
        let shown = extent.rows.unwrap_or(usize::MAX).min(self.rows.len());
        let columns: Vec<Drawn> = self.fields.iter().map(|field| self.drawn(field, shown)).collect();
        let mut room = extent.width.unwrap_or(usize::MAX);
        let fits = |column: &&Drawn| {
            let fits = column.width <= room;
            room = room.saturating_sub(column.width + GAP.len());
            fits
        };
        // A column that is wider than the terminal is better than none.
        let count = columns.iter().take_while(fits).count().max(1).min(columns.len());
        let (inside, outside) = columns.split_at(count);
        let mut out = String::new();
        let mut line = |cell: &dyn Fn(&Drawn) -> String| {
            let padded = inside.iter().map(|column| {
                let (cell, width) = (cell(column), column.width);
                if column.left { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            let text = padded.collect::<Vec<_>>().join(GAP);
            let _ = writeln!(out, "{}", text.trim_end());
        };
        line(&|column| column.name.clone());
        line(&|column| column.unit.clone());
        for row in 0..shown {
            line(&|column| column.cells[row].clone());
        }
        out.push_str(&self.count(shown));
        if !outside.is_empty() {
            let names: Vec<&str> = outside.iter().map(|column| column.name.as_str()).collect();
            let _ = writeln!(out, "columns that do not fit: {}", names.join(", "));
        }
        out
    }

    /// `12 of 37 rows that fit, of 185`.
    fn count(&self, shown: usize) -> String {
        let (chosen, total) = (self.rows.len(), self.total);
        let rows = counted(total, "row");
        match (shown == chosen, chosen == total) {
            (true, true) => format!("{rows}\n"),
            (true, false) => format!("{chosen} of {rows}\n"),
            (false, true) => format!("first {shown} of {rows}\n"),
            (false, false) => format!("first {shown} of {chosen} chosen rows, of {total}\n"),
        }
    }

    fn drawn(&self, field: &Field, shown: usize) -> Drawn {
        let values: Vec<Entry<'_>> = self.rows[..shown].iter().map(|row| field.of(row)).collect();
        let numbers = || values.iter().filter_map(|cell| cell.number());
        let largest = numbers().fold(0.0, |most: f64, x| most.max(x.abs()));
        let power = largest > 0.0 && !PLAIN.contains(&largest);
        let decimals = numbers().map(decimals).max().unwrap_or(0);
        let number = |x: f64| match power {
            true if x == 0.0 => "0".to_owned(),
            true => format!("{x:.1e}"),
            false => unsigned_zero(format!("{x:.decimals$}")),
        };
        let text = |cell: &Entry<'_>| match *cell {
            Entry::Empty => EMPTY.to_owned(),
            Entry::Text(text) => text.to_owned(),
            Entry::Number(x) => number(x),
            Entry::Count(n) => n.to_string(),
            Entry::Flag(flag) => flag.to_string(),
        };
        let cells: Vec<String> = values.iter().map(text).collect();
        // A plain number has no unit to show.
        let unit = self.unit(field).filter(|unit| *unit != "1").map(|unit| format!("[{unit}]")).unwrap_or_default();
        let lengths = cells.iter().map(String::as_str).chain([field.name(), &unit]).map(|text| text.chars().count());
        let width = lengths.max().unwrap_or(0);
        Drawn { name: field.name().to_owned(), unit, cells, left: field.kind() == Kind::Text, width }
    }
}

/// Decimals that a rounded number needs.
fn decimals(x: f64) -> usize {
    let text = format!("{x:.DECIMALS$}");
    let fraction = text.split('.').nth(1).unwrap_or_default();
    fraction.trim_end_matches('0').len()
}

fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        _ => text,
    }
}
