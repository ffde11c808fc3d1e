//! Columns and rows of a table.

use crate::{
    design_toml::NumberPath,
    nearest::nearest,
    record::{NamedRecord, SensitivityRow},
};
use maille::design::{Design, SPACING};
use maille::record::{Column, Entry, Kind, LIMIT_COLUMNS, LimitRow, Unit};
use std::collections::{BTreeSet, HashMap};
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

/// A column of a table: the record that a row comes from, a column of `limits.csv`, a number that a study has varied, or the
/// derivative of the limit by a number.
#[derive(Clone, Debug)]
pub enum Field {
    /// Name of the record.
    Record,
    /// A column of `limits.csv`.
    Limit(&'static Column),
    /// A number of [`Design::varied`], by its name and with its unit.
    Varied(String, Unit),
    /// Derivatives of `sensitivities.csv`, by the name of the column: `dl1/spacing` for a step forward, `dl1_back/spacing` for one back.
    Derivative(String),
}

/// Name of [`Field::Record`].
const RECORD: &str = "record";
/// What stands before the number in the name of [`Field::Derivative`].
const SIDES: [&str; 2] = ["dl1/", "dl1_back/"];
/// Names that a column has besides its own.
const SHORT: [(&str, &str); 2] = [("direction", "direction_deg"), ("r", "minor_radius")];

impl Field {
    /// The column of that name; `direction` and `r` stand for `direction_deg` and `minor_radius`. Other words are taken for
    /// names of parameters: see [`check`](Field::check).
    pub fn parse(name: &str) -> Result<Self, TableError> {
        let name = name.trim();
        let long = SHORT.iter().find(|(short, _)| *short == name).map_or(name, |(_, long)| long);
        if long == RECORD {
            return Ok(Field::Record);
        }
        if SIDES.iter().any(|side| long.starts_with(side)) {
            return Ok(Field::Derivative(long.to_owned()));
        }
        let column = LIMIT_COLUMNS.iter().find(|column| column.name == long).map(Field::Limit);
        column.or_else(|| Self::varied(name)).ok_or_else(|| {
            let known: Vec<&str> = LIMIT_COLUMNS.iter().map(|column| column.name).chain([RECORD, SPACING]).collect();
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

    /// The number that studies vary under this name, if it is one.
    fn varied(name: &str) -> Option<Self> {
        let unit = match name.parse::<NumberPath>() {
            _ if name == SPACING => Unit::One,
            // What a parameter measures is not known.
            Ok(path) if path.parameter().is_some() => Unit::None,
            Ok(path) if path.is_length() => Unit::Length,
            Ok(_) => Unit::One,
            Err(_) => return None,
        };
        Some(Field::Varied(name.to_owned(), unit))
    }

    /// Refuses the name of a parameter that no design of the records has, and derivatives that no record has: any word can be one,
    /// and [`parse`](Field::parse) knows no records.
    pub fn check(&self, records: &[NamedRecord]) -> Result<(), TableError> {
        if let Field::Derivative(name) = self {
            let known: Vec<String> =
                Self::derivatives_in(records).iter().map(|field| field.name().to_owned()).collect();
            let help = match known.is_empty() {
                _ if known.contains(name) => return Ok(()),
                true => "`maille characterize … --sensitivities` writes derivatives, and solves nothing that is there"
                    .into(),
                false => format!("there are {}", known.join(", ")),
            };
            return Err(TableError { problem: format!("there is no column \"{name}\""), help });
        }
        let Field::Varied(name, Unit::None) = self else { return Ok(()) };
        let designs = || records.iter().map(|named| &named.record.run.design);
        let parameters: BTreeSet<&str> = designs().flat_map(|d| d.parameters.iter().map(|p| p.name.as_str())).collect();
        if parameters.contains(name.as_str()) || designs().any(|design| design.varied.contains_key(name)) {
            return Ok(());
        }
        let known = LIMIT_COLUMNS.iter().map(|column| column.name).chain([RECORD, SPACING]).chain(parameters);
        let known: Vec<&str> = known.collect();
        let help = match nearest(name, &known) {
            Some(near) => format!("did you mean {near}?"),
            None => format!("columns are {}", known.join(", ")),
        };
        Err(TableError { problem: format!("there is no column \"{name}\""), help })
    }

    /// All columns; with `record`, the name of the record comes first. The numbers that studies have varied in `records` and the
    /// derivatives that they have come last.
    pub fn all(records: &[NamedRecord], record: bool) -> Vec<Self> {
        let first = record.then_some(Field::Record);
        let last = Self::varied_in(records).into_iter().chain(Self::derivatives_in(records));
        first.into_iter().chain(LIMIT_COLUMNS.iter().map(Field::Limit)).chain(last).collect()
    }

    /// The derivatives that some of the records have, each forward and back.
    fn derivatives_in(records: &[NamedRecord]) -> Vec<Self> {
        let mut numbers: Vec<&str> = Vec::new();
        for row in records.iter().flat_map(|named| &named.sensitivities) {
            if !numbers.contains(&row.number.as_str()) {
                numbers.push(&row.number);
            }
        }
        let both = |number: &str| SIDES.map(|side| Field::Derivative(format!("{side}{number}")));
        numbers.into_iter().flat_map(both).collect()
    }

    /// The numbers that studies have varied in some of the records.
    pub(super) fn varied_in(records: &[NamedRecord]) -> Vec<Self> {
        let names = records.iter().flat_map(|named| named.record.run.design.varied.keys());
        let names: BTreeSet<&String> = names.collect();
        names.into_iter().filter_map(|name| Self::varied(name)).collect()
    }

    /// Name in the header.
    pub fn name(&self) -> &str {
        match self {
            Field::Record => RECORD,
            Field::Limit(column) => column.name,
            Field::Varied(name, _) | Field::Derivative(name) => name,
        }
    }

    pub(super) fn unit(&self) -> Unit {
        match self {
            Field::Record | Field::Derivative(_) => Unit::None,
            Field::Limit(column) => column.unit,
            Field::Varied(_, unit) => *unit,
        }
    }

    pub(super) fn kind(&self) -> Kind {
        match self {
            Field::Record => Kind::Text,
            Field::Limit(column) => column.kind,
            Field::Varied(..) | Field::Derivative(_) => Kind::Number,
        }
    }

    pub(super) fn meaning(&self) -> &'static str {
        match self {
            Field::Record => "the record that the row comes from",
            Field::Limit(column) => column.meaning,
            Field::Varied(name, _) if name == SPACING => "factor of all distances between elements, set by a study",
            Field::Varied(_, Unit::None) => "parameter of the design",
            Field::Varied(..) => "number of the design, set by a study, before the spacing",
            Field::Derivative(name) if name.starts_with(SIDES[1]) => {
                "derivative of l1 by a number of the design, for a step back"
            }
            Field::Derivative(_) => "derivative of l1 by a number of the design, for a step forward",
        }
    }

    pub(super) fn of<'a>(&self, row: &Row<'a>) -> Entry<'a> {
        match self {
            Field::Record => Entry::Text(row.record),
            Field::Limit(column) => (column.get)(row.limit),
            Field::Varied(name, _) => {
                let parameter = || row.design.parameters.iter().find(|p| p.name == *name).map(|p| p.value);
                row.design.varied.get(name).copied().or_else(parameter).map_or(Entry::Empty, Entry::Number)
            }
            Field::Derivative(name) => {
                let of = |number: &str| row.sensitivities.iter().find(|row| row.number == number);
                let [forward, back] = SIDES.map(|side| name.strip_prefix(side).and_then(of));
                let value = forward.and_then(|row| row.derivative).or(back.and_then(|row| row.derivative_back));
                value.map_or(Entry::Empty, Entry::Number)
            }
        }
    }
}

/// A row with the name of its record and the design.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Name of the record.
    pub record: &'a str,
    /// The design of the record.
    pub design: &'a Design,
    /// The row.
    pub limit: &'a LimitRow,
    /// The derivatives of its limit.
    pub sensitivities: &'a [SensitivityRow],
}

impl NamedRecord {
    /// The rows, each with its derivatives, which stand together.
    pub(super) fn table_rows<'a>(&'a self) -> Vec<Row<'a>> {
        let key = |direction_deg: f64, l2: f64| (direction_deg.to_bits(), l2.to_bits());
        let same = |a: &SensitivityRow, b: &SensitivityRow| key(a.direction_deg, a.l2) == key(b.direction_deg, b.l2);
        let groups = self.sensitivities.chunk_by(same);
        let of: HashMap<_, _> = groups.map(|rows| (key(rows[0].direction_deg, rows[0].l2), rows)).collect();
        let row = |limit: &'a LimitRow| Row {
            record: &self.name,
            design: &self.record.run.design,
            limit,
            sensitivities: of.get(&key(limit.direction_deg, limit.l2)).copied().unwrap_or_default(),
        };
        self.record.rows.iter().map(row).collect()
    }
}
