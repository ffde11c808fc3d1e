//! `l2,-l1`: the order of the rows.

use super::{Field, Row, TableError};
use crate::record::NamedRecord;
use maille::record::Entry;
use std::cmp::Ordering;

/// A column to sort by.
#[derive(Clone, Debug)]
pub struct SortKey {
    field: Field,
    /// Largest first.
    down: bool,
}

impl SortKey {
    /// Reads `l2,-l1`; the minus sign puts the largest first.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, TableError> {
        let key = |name: &str| {
            let name = name.trim();
            let down = name.starts_with('-');
            Ok(Self { field: Field::parse(name.strip_prefix('-').unwrap_or(name))?, down })
        };
        text.split(',').map(key).collect()
    }

    /// Refuses a column that none of the records has, as [`Field::check`] does.
    pub fn check(&self, records: &[NamedRecord]) -> Result<(), TableError> {
        self.field.check(records)
    }
}

/// The order of two rows.
pub(super) fn compare(keys: &[SortKey], a: &Row<'_>, b: &Row<'_>) -> Ordering {
    let of_key = |key: &SortKey| {
        let (a, b) = (key.field.of(a), key.field.of(b));
        match (a == Entry::Empty, b == Entry::Empty) {
            (false, false) if key.down => of_cells(b, a),
            (false, false) => of_cells(a, b),
            (a_empty, b_empty) => a_empty.cmp(&b_empty),
        }
    };
    keys.iter().map(of_key).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// The order of two values of one column.
fn of_cells(a: Entry<'_>, b: Entry<'_>) -> Ordering {
    match (a, b) {
        (Entry::Number(a), Entry::Number(b)) => (a + 0.0).total_cmp(&(b + 0.0)), // −0 is 0
        (Entry::Count(a), Entry::Count(b)) => a.cmp(&b),
        (Entry::Text(a), Entry::Text(b)) => a.cmp(b),
        (Entry::Flag(a), Entry::Flag(b)) => a.cmp(&b),
        _ => Ordering::Equal,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use maille::record::LimitRow;

    #[test]
    fn rows_are_sorted_and_empty_ones_come_last() {
        let limit = |l2: f64, l1: Option<f64>| LimitRow { l2, l1, ..LimitRow::default() };
        let rows = [limit(0.0, None), limit(-0.0, Some(0.2)), limit(-1.0, Some(0.3)), limit(0.0, Some(0.5))];
        let sorted = |text: &str| {
            let keys = SortKey::parse_list(text).unwrap();
            let mut order = [0, 1, 2, 3];
            let design = crate::read_design("1.1", crate::builtin("1.1").unwrap()).unwrap();
            order.sort_by(|&a, &b| {
                let row = |i: usize| Row { record: "", design: &design, limit: &rows[i], sensitivities: &[] };
                compare(&keys, &row(a), &row(b))
            });
            order
        };
        assert_eq!(sorted("l1"), [1, 2, 3, 0]);
        assert_eq!(sorted("-l1"), [3, 2, 1, 0]);
        assert_eq!(sorted("l2,-l1"), [2, 3, 1, 0]);
        assert_eq!(sorted("design"), [0, 1, 2, 3]);
        let error = SortKey::parse_list("-l3").unwrap()[0].check(&[]).unwrap_err().to_string();
        assert!(error.starts_with("there is no column \"l3\"; did you mean l"), "{error}");
    }
}
