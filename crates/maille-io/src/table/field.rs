//! Columns and rows of a table.

use crate::nearest::nearest;
use maille::record::{Column, Entry, Kind, LIMIT_COLUMNS, LimitRow, Unit};
use thiserror::Error;

/// A column, condition or order that no table has.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{problem}; {help}")]
pub struct TableError {
    /// What is wrong.
    pub problem: String,
    /// What would be right.
    pub help: String,
}

/// A column of a table: the record that a row comes from, or a column of `limits.csv`.
#[derive(Clone, Copy, Debug)]
pub enum Field {
    /// Name of the record.
    Record,
    /// A column of `limits.csv`.
    Limit(&'static Column),
}

/// Name of [`Field::Record`].
const RECORD: &str = "record";
/// Names that a column has besides its own.
const SHORT: [(&str, &str); 2] = [("direction", "direction_deg"), ("r", "minor_radius")];

impl Field {
    /// The column of that name; `direction` and `r` stand for `direction_deg` and `minor_radius`.
    pub fn parse(name: &str) -> Result<Self, TableError> {
        let name = name.trim();
        let long = SHORT.iter().find(|(short, _)| *short == name).map_or(name, |(_, long)| long);
        if long == RECORD {
            return Ok(Field::Record);
        }
        LIMIT_COLUMNS.iter().find(|column| column.name == long).map(Field::Limit).ok_or_else(|| {
            let known: Vec<&str> = LIMIT_COLUMNS.iter().map(|column| column.name).chain([RECORD]).collect();
            let help = match nearest(name, &known) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("columns are {}", known.join(", ")),
            };
            TableError { problem: format!("there is no column \"{name}\""), help }
        })
    }

    /// Reads `design,l2,l1`.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, TableError> {
        let mut out: Vec<Self> = Vec::new();
        for name in text.split(',') {
            let field = Self::parse(name)?;
            if out.iter().any(|f| f.name() == field.name()) {
                let help = "name each column once".into();
                return Err(TableError { problem: format!("column {} is named twice", field.name()), help });
            }
            out.push(field);
        }
        Ok(out)
    }

    /// All columns; with `record`, the name of the record comes first.
    pub fn all(record: bool) -> Vec<Self> {
        record.then_some(Field::Record).into_iter().chain(LIMIT_COLUMNS.iter().map(Field::Limit)).collect()
    }

    /// Name in the header.
    pub fn name(self) -> &'static str {
        match self {
            Field::Record => RECORD,
            Field::Limit(column) => column.name,
        }
    }

    pub(super) fn unit(self) -> Unit {
        match self {
            Field::Record => Unit::None,
            Field::Limit(column) => column.unit,
        }
    }

    pub(super) fn kind(self) -> Kind {
        match self {
            Field::Record => Kind::Text,
            Field::Limit(column) => column.kind,
        }
    }

    pub(super) fn meaning(self) -> &'static str {
        match self {
            Field::Record => "the record that the row comes from",
            Field::Limit(column) => column.meaning,
        }
    }

    pub(super) fn of<'a>(self, row: &Row<'a>) -> Entry<'a> {
        match self {
            Field::Record => Entry::Text(row.record),
            Field::Limit(column) => (column.get)(row.limit),
        }
    }
}

/// A row with the name of its record.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Name of the record.
    pub record: &'a str,
    /// The row.
    pub limit: &'a LimitRow,
}
