//! `l2<0,status=local|global`: which rows are meant.

use super::{Field, Row, TableError};
use crate::nearest::nearest;
use crate::record::NamedRecord;
use maille::record::{Entry, Kind, Status};
use std::cmp::Ordering;

/// One condition on the rows of a table.
#[derive(Clone, Debug)]
pub struct Condition {
    field: Field,
    sign: &'static str,
    holds: Holds,
    /// Any of these, for `=` and `!=`; one number otherwise.
    values: Vec<Value>,
}

/// What a sign says of a cell's order to a value.
type Holds = fn(Ordering) -> bool;

#[derive(Clone, Debug, PartialEq)]
enum Value {
    /// Nothing: a number that could not be computed.
    Empty,
    Number(f64),
    Text(String),
    Flag(bool),
}

/// Longer signs first: `<=` begins with `<`.
const OPERATORS: [(&str, Holds); 7] = [
    (UNEQUAL, Ordering::is_ne),
    ("<=", Ordering::is_le),
    (">=", Ordering::is_ge),
    ("==", Ordering::is_eq),
    ("=", Ordering::is_eq),
    ("<", Ordering::is_lt),
    (">", Ordering::is_gt),
];
/// Holds of what equals none of its values; the others, of what fits one of them.
const UNEQUAL: &str = "!=";
/// What an empty value is called.
const EMPTY: &str = "none";

impl Condition {
    /// Reads conditions that must all hold, separated by commas: `direction=30,l2=-0.125`. A value with a comma stands in
    /// double quotes; `none` is a value that is not there; `a|b` is either.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, TableError> {
        let mut quoted = false;
        let outside = |c: char| {
            quoted ^= c == '"';
            c == ',' && !quoted
        };
        text.split(outside).map(Self::parse).collect()
    }

    fn parse(text: &str) -> Result<Self, TableError> {
        let text = text.trim();
        let wrong = |problem: String| {
            let help = "give a column, one of = != < <= > >=, and a value, as l2<0 or status=local".into();
            TableError { problem, help }
        };
        let Some(at) = text.find(['=', '!', '<', '>']) else {
            return Err(wrong(format!("\"{text}\" is not a condition")));
        };
        let (name, rest) = text.split_at(at);
        let sign_end = rest.find(|c: char| !"=!<>~".contains(c)).unwrap_or(rest.len());
        let (sign, value) = rest.split_at(sign_end);
        let Some((sign, holds)) = OPERATORS.into_iter().find(|(known, _)| *known == sign) else {
            let error = wrong(format!("\"{sign}\" in \"{text}\" is not a comparison"));
            return Err(with_nearest(sign, &OPERATORS.map(|(known, _)| known), error));
        };
        if name.trim().is_empty() {
            return Err(wrong(format!("\"{text}\" names no column")));
        }
        let field = Field::parse(name)?;
        let either = [UNEQUAL, "==", "="].contains(&sign);
        let values = if either { value.split('|').collect() } else { vec![value] };
        let values = values.into_iter().map(|value| read(&field, value)).collect::<Result<Vec<_>, _>>()?;
        let ordered = values.iter().all(|value| matches!(value, Value::Number(_)));
        if !either && !ordered {
            let help = format!("compare {} with = or !=", field.name());
            return Err(TableError { problem: format!("\"{text}\" has no order"), help });
        }
        Ok(Self { field, sign, holds, values })
    }

    /// Refuses a column that none of the records has, as [`Field::check`] does.
    pub fn check(&self, records: &[NamedRecord]) -> Result<(), TableError> {
        self.field.check(records)
    }

    /// Whether a row meets the condition. An empty value is neither less nor more than a number, and equals none.
    pub(super) fn holds(&self, row: &Row<'_>) -> bool {
        let cell = self.field.of(row);
        match self.sign {
            UNEQUAL => self.values.iter().all(|value| value.order(cell).is_none_or(self.holds)),
            _ => self.values.iter().any(|value| value.order(cell).is_some_and(self.holds)),
        }
    }
}

impl NamedRecord {
    /// Keeps the rows that meet every condition; the states stay.
    pub fn keep(&mut self, conditions: &[Condition]) {
        let rows = self.table_rows();
        let kept: Vec<bool> = rows.iter().map(|row| conditions.iter().all(|condition| condition.holds(row))).collect();
        let mut kept = kept.into_iter();
        self.record.rows.retain(|_| kept.next().unwrap_or_default());
    }
}

impl Value {
    /// The order of a cell to this value; none where they cannot be compared.
    fn order(&self, cell: Entry<'_>) -> Option<Ordering> {
        let numbers =
            |x: f64, wanted: f64| if same(x, wanted) { Some(Ordering::Equal) } else { x.partial_cmp(&wanted) };
        match (self, cell) {
            (Value::Empty, Entry::Empty) => Some(Ordering::Equal),
            (Value::Number(wanted), Entry::Number(x)) => numbers(x, *wanted),
            (Value::Number(wanted), Entry::Count(n)) => numbers(n as f64, *wanted),
            (Value::Text(wanted), Entry::Text(text)) => Some(text.cmp(wanted)),
            (Value::Flag(wanted), Entry::Flag(flag)) => Some(flag.cmp(wanted)),
            _ => None,
        }
    }
}

/// Equal to nine digits: 0.44 finds 0.44000000000000017, and 0 what rounding left of it.
fn same(x: f64, wanted: f64) -> bool {
    (x - wanted).abs() <= 1e-9 * x.abs().max(wanted.abs()) + 1e-14
}

fn read(field: &Field, text: &str) -> Result<Value, TableError> {
    let text = text.trim();
    let bare = text.strip_prefix('"').and_then(|t| t.strip_suffix('"'));
    if bare.is_none() && text.contains('"') {
        let help = "close them, and give what has a comma in quotes: cell=\"1,0;-1,2\"".into();
        return Err(TableError { problem: format!("{text} has a quotation mark that is not closed"), help });
    }
    if text == EMPTY {
        return Ok(Value::Empty);
    }
    let text = bare.unwrap_or(text);
    let wrong = |expected: &str| {
        let help = format!("{} is {expected}, or none where it is empty", field.name());
        TableError { problem: format!("\"{text}\" is not a value of {}", field.name()), help }
    };
    let word = |known: &[&str]| match known.contains(&text) {
        true => Ok(Value::Text(text.to_owned())),
        false => Err(with_nearest(text, known, wrong(&format!("one of {}", known.join(", "))))),
    };
    match (field.kind(), field.name()) {
        (Kind::Number | Kind::Count, _) => match text.parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(Value::Number(x)),
            _ => Err(wrong("a number")),
        },
        (Kind::Flag, _) => text.parse().map(Value::Flag).map_err(|_| wrong("true or false")),
        (Kind::Text, "status") => word(&Status::ALL.map(Status::name)),
        (Kind::Text, "method") => word(&["exact", "energy"]),
        (Kind::Text, "bound_kind") => word(&["chain", "link"]),
        (Kind::Text, _) => Ok(Value::Text(text.to_owned())),
    }
}

/// The error with the known word that is nearest to one that is not.
fn with_nearest(word: &str, known: &[&str], mut error: TableError) -> TableError {
    if let Some(near) = nearest(word, known) {
        error.help = format!("did you mean {near}? {}", error.help);
    }
    error
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille::record::LimitRow;

    fn holds(text: &str, limit: &LimitRow) -> bool {
        let conditions = Condition::parse_list(text).unwrap_or_else(|e| panic!("{text}: {e}"));
        let design = crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap();
        conditions
            .iter()
            .all(|condition| condition.holds(&Row { record: "a/b", design: &design, limit, sensitivities: &[] }))
    }

    #[test]
    fn conditions_choose_rows() {
        let row = LimitRow {
            design: "1.10".into(),
            direction_deg: 30.0,
            l2: -0.125,
            method: "exact".into(),
            cell: "1,0;-1,2".into(),
            status: Status::Local,
            l1: Some(0.44000000000000017),
            bound_gap: Some(1e-16),
            iterations: 7,
            links_ok: Some(true),
            ..LimitRow::default()
        };
        for text in [
            "direction=30,l2=-0.125",
            "direction_deg == 30 , status = local",
            "status=global|local",
            "status!=global|uncertified",
            "l1=0.44",
            "l1<=0.44,l1>=0.44",
            "l1>0.43,l1<0.45",
            "bound_gap=0,bound_gap<1e-12",
            "cell=\"1,0;-1,2\",l2<0",
            "design=1.10",
            "iterations>6,iterations=7",
            "links_ok=true",
            "minor_radius=none,r=none,l1!=none",
            "record=a/b",
        ] {
            assert!(holds(text, &row), "{text}");
        }
        for text in [
            "direction=31",
            "l1<0.44",
            "l1>0.44",
            "l1!=0.44",
            "design=1.1",
            "minor_radius<1",
            "minor_radius>=0",
            "l1=none",
            "links_ok=false",
            "bound_gap>1e-13",
            "l2<0,status=global",
        ] {
            assert!(!holds(text, &row), "{text}");
        }
    }

    #[test]
    fn what_is_no_condition_is_named_with_the_nearest_word() {
        let message = |text: &str| Condition::parse_list(text).unwrap_err().to_string();
        assert_eq!(message("lamda.1>0"), "there is no column \"lamda.1\"; did you mean lambda1?");
        let unknown = Condition::parse_list("lamda1>0").unwrap()[0].check(&[]).unwrap_err().to_string();
        assert_eq!(unknown, "there is no column \"lamda1\"; did you mean lambda1?");
        assert_eq!(
            message("status=globl"),
            "\"globl\" is not a value of status; did you mean global? status is one of global, local, threshold-reached, \
             uncertified, l2-unreachable, l2-not-reached, unbounded, not-converged, infeasible-start, interrupted, or none \
             where it is empty"
        );
        assert_eq!(message("l2=abc"), "\"abc\" is not a value of l2; l2 is a number, or none where it is empty");
        let shape = "give a column, one of = != < <= > >=, and a value, as l2<0 or status=local";
        assert_eq!(message("l2"), format!("\"l2\" is not a condition; {shape}"));
        assert_eq!(message("l2=>0"), format!("\"=>\" in \"l2=>0\" is not a comparison; did you mean >=? {shape}"));
        assert_eq!(message("=3"), format!("\"=3\" names no column; {shape}"));
        assert_eq!(message("l2=0,"), format!("\"\" is not a condition; {shape}"));
        assert_eq!(message("status<local"), "\"status<local\" has no order; compare status with = or !=");
        assert_eq!(message("l1>none"), "\"l1>none\" has no order; compare l1 with = or !=");
        assert!(message("cell=\"1,0").contains("not closed"));
        assert!(message("l2=").starts_with("\"\" is not a value of l2"));
    }
}
