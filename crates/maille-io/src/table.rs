//! Tables: rows of one record or several, chosen, sorted, and written in one of four formats.
//!
//! | file | content |
//! | --- | --- |
//! | `field.rs` | columns and rows |
//! | `condition.rs` | which rows: `l2<0,status=local` |
//! | `order.rs` | in which order: `l2,-l1` |
//! | `text.rs`, `csv.rs`, `json.rs`, `parquet.rs` | the formats |
//! | `arrow_schema.rs` | units and meanings in a Parquet file |

mod arrow_schema;
mod condition;
mod csv;
mod field;
mod json;
mod order;
mod parquet;
mod text;

pub use condition::Condition;
pub use field::{Field, Row, TableError};
pub use order::SortKey;
pub use parquet::ParquetError;
pub use text::Extent;

use crate::record::NamedRecord;

/// Rows and columns of records.
#[derive(Clone, Debug)]
pub struct Table<'a> {
    records: &'a [NamedRecord],
    rows: Vec<Row<'a>>,
    fields: Vec<Field>,
    total: usize,
}

impl<'a> Table<'a> {
    /// All rows of the records, one after the other, with these columns.
    pub fn new(records: &'a [NamedRecord], fields: Vec<Field>) -> Self {
        let rows: Vec<Row<'a>> = records.iter().flat_map(NamedRecord::table_rows).collect();
        Self { records, total: rows.len(), rows, fields }
    }

    /// Keeps the rows that meet every condition.
    pub fn keep(&mut self, conditions: &[Condition]) {
        self.rows.retain(|row| conditions.iter().all(|condition| condition.holds(row)));
    }

    /// Sorts by the first key, rows that are equal in it by the second, and so on; what is empty comes last.
    pub fn sort(&mut self, keys: &[SortKey]) {
        self.rows.sort_by(|a, b| order::compare(keys, a, b));
    }

    /// Keeps the first rows.
    pub fn truncate(&mut self, rows: usize) {
        self.rows.truncate(rows);
    }

    /// The unit of a column's numbers; `mixed` where the records have lengths in different units.
    fn unit(&self, field: &Field) -> Option<&'a str> {
        let mut units = self.records.iter().map(|named| field.unit().name(named.record.run.design.unit.as_deref()));
        let first = units.next().flatten();
        if units.all(|unit| unit == first) { first } else { Some("mixed") }
    }
}
