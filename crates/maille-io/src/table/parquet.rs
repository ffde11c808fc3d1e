//! A table as Apache Parquet, with units beside the columns and the records' inputs in the file.

use super::{Field, Table, json};
use arrow_array::{ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{ArrowError, DataType, Schema};
use maille::record::{Entry, Kind, RECORD_SCHEMA, StateRecord};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use std::collections::HashMap;
use std::io::Write;
use std::sync::Arc;
use thiserror::Error;

/// A table that cannot be written as Parquet.
#[derive(Debug, Error)]
pub enum ParquetError {
    /// The columns do not make a table.
    #[error("the table has no form in Arrow")]
    Arrow(#[from] ArrowError),
    /// The bytes could not be written.
    #[error("the table cannot be written as Parquet")]
    Parquet(#[from] parquet::errors::ParquetError),
}

impl Table<'_> {
    /// Writes the table as Parquet. `unit` and `meaning` stand with each column, the inputs of each record as JSON under
    /// the file's key `maille.records`, the version of the columns under `maille.schema`.
    pub fn parquet(&self, out: impl Write + Send) -> Result<(), ParquetError> {
        self.write_parquet(out, Vec::new())
    }

    /// The same with a last column `state`, the line of `states.jsonl` of each row: all that a record has of them. `states` go
    /// with the rows of this table.
    pub fn parquet_with_states(&self, states: &[StateRecord], out: impl Write + Send) -> Result<(), ParquetError> {
        let lines =
            states.iter().map(|state| serde_json::to_string(state).map_err(|e| ArrowError::JsonError(e.to_string())));
        let lines: ArrayRef = Arc::new(StringArray::from(lines.collect::<Result<Vec<_>, _>>()?));
        let meaning = HashMap::from([("meaning".to_owned(), "the line of states.jsonl".to_owned())]);
        self.write_parquet(
            out,
            vec![(arrow_schema::Field::new("state", DataType::Utf8, true).with_metadata(meaning), lines)],
        )
    }

    fn write_parquet(
        &self,
        out: impl Write + Send,
        more: Vec<(arrow_schema::Field, ArrayRef)>,
    ) -> Result<(), ParquetError> {
        let column = |field: &Field| {
            let array = self.array(field)?;
            Ok((self.arrow_field(field, array.data_type().clone()), array))
        };
        let mut columns: Vec<_> = self.fields.iter().map(column).collect::<Result<_, ArrowError>>()?;
        columns.extend(more);
        let schema = columns.iter().map(|(field, _)| field.clone());
        let records: serde_json::Value = self.records.iter().map(json::inputs).collect();
        let metadata = [("maille.schema", RECORD_SCHEMA.to_string()), ("maille.records", records.to_string())];
        // Twice: pyarrow shows those of the Arrow schema, DuckDB those of the file.
        let of_file = metadata.clone().map(|(key, value)| KeyValue::new(key.to_owned(), value));
        let of_schema = HashMap::from(metadata.map(|(key, value)| (key.to_owned(), value)));
        let schema = Arc::new(Schema::new_with_metadata(schema.collect::<Vec<_>>(), of_schema));
        let batch = RecordBatch::try_new(schema.clone(), columns.into_iter().map(|(_, array)| array).collect())?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("maille ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(of_file.into()))
            .build();
        let mut writer = ArrowWriter::try_new(out, schema, Some(properties))?;
        writer.write(&batch)?;
        writer.close()?;
        Ok(())
    }

    fn arrow_field(&self, field: &Field, kind: DataType) -> arrow_schema::Field {
        let mut metadata = HashMap::from([("meaning".to_owned(), field.meaning().to_owned())]);
        metadata.extend(self.unit(field).map(|unit| ("unit".to_owned(), unit.to_owned())));
        arrow_schema::Field::new(field.name(), kind, true).with_metadata(metadata)
    }

    /// The values of a column. A count is a signed integer, so that the difference of two is right in every reader.
    fn array(&self, field: &Field) -> Result<ArrayRef, ArrowError> {
        let cells = self.rows.iter().map(|row| field.of(row));
        Ok(match field.kind() {
            Kind::Text => Arc::new(cells.map(Entry::text).collect::<StringArray>()),
            Kind::Number => Arc::new(cells.map(Entry::number).collect::<Float64Array>()),
            Kind::Flag => Arc::new(cells.map(Entry::flag).collect::<BooleanArray>()),
            Kind::Count => {
                let signed = |n: u64| {
                    let wide = |_| ArrowError::CastError(format!("{} is {n}, too large for Int64", field.name()));
                    i64::try_from(n).map_err(wide)
                };
                let counts = cells.map(|cell| cell.count().map(signed).transpose());
                Arc::new(counts.collect::<Result<Int64Array, _>>()?)
            }
        })
    }
}
