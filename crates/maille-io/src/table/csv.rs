//! A table as text with commas, its cells as in `limits.csv`.

use super::{Field, Table};
use crate::record::csv_cell;

impl Table<'_> {
    /// The table as CSV: all digits, no units.
    pub fn csv(&self) -> String {
        let line = |cells: Vec<String>| cells.join(",") + "\n";
        let header = line(self.fields.iter().map(|field| field.name().to_owned()).collect());
        let cells = |row| self.fields.iter().map(|field: &Field| csv_cell(field.name(), field.of(row))).collect();
        self.rows.iter().fold(header, |out, row| out + &line(cells(row)))
    }
}
