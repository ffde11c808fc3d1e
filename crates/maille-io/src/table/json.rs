//! A table as JSON: columns with units, the records' inputs, and the rows.

use super::{Row, Table};
use crate::record::NamedRecord;
use serde_json::{Map, Value, json};

impl Table<'_> {
    /// The table as JSON, one row a line.
    pub fn json(&self) -> String {
        let column = |field: &super::Field| {
            json!({
                "name": field.name(),
                "type": field.kind().name(),
                "unit": self.unit(field),
                "meaning": field.meaning(),
            })
        };
        let lines = |values: Vec<Value>| {
            let lines: Vec<String> = values.iter().map(|value| format!("    {value}")).collect();
            if lines.is_empty() { "[]".to_owned() } else { format!("[\n{}\n  ]", lines.join(",\n")) }
        };
        let row = |row: &Row<'_>| {
            let cells = self.fields.iter().map(|field| (field.name().to_owned(), json!(field.of(row))));
            Value::Object(cells.collect::<Map<_, _>>())
        };
        format!(
            "{{\n  \"columns\": {},\n  \"records\": {},\n  \"rows\": {}\n}}\n",
            lines(self.fields.iter().map(column).collect()),
            lines(self.records.iter().map(inputs).collect()),
            lines(self.rows.iter().map(row).collect()),
        )
    }
}

/// What a record was computed from.
pub(super) fn inputs(named: &NamedRecord) -> Value {
    let run = &named.record.run;
    json!({
        "record": named.name,
        "schema": run.schema,
        "program_version": run.program_version,
        "input_hash": run.input_hash,
        "design": run.design,
        "parameters": run.parameters,
    })
}
