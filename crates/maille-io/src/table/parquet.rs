//! A table as Apache Parquet, with units beside the columns and the records' inputs in the file.

use super::arrow_schema::{ArrowField, KEY, arrow_schema};
use super::{Field, Table, json};
use maille::record::{Entry, Kind, RECORD_SCHEMA, StateRecord};
use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};
use std::io::Write;
use std::sync::Arc;
use thiserror::Error;

/// A table that cannot be written as Parquet.
#[derive(Debug, Error)]
pub enum ParquetError {
    /// A count that the column's type does not hold.
    #[error("{column} is {value}, too large for a signed number of 64 bits")]
    Count {
        /// The column.
        column: String,
        /// Its value.
        value: u64,
    },
    /// A state is not a line of JSON.
    #[error("a state has no form in JSON")]
    Json(#[from] serde_json::Error),
    /// The bytes could not be written.
    #[error("the table cannot be written as Parquet")]
    Parquet(#[from] parquet::errors::ParquetError),
}

/// The values of a column; none where a row has none.
enum Values {
    Text(Vec<Option<ByteArray>>),
    Number(Vec<Option<f64>>),
    Flag(Vec<Option<bool>>),
    /// Signed, so that the difference of two counts is right in every reader.
    Count(Vec<Option<i64>>),
}

struct Column<'a> {
    field: ArrowField<'a>,
    values: Values,
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
        let line = |state| Ok(Some(serde_json::to_string(state)?.into_bytes().into()));
        let lines = states.iter().map(line).collect::<Result<_, ParquetError>>()?;
        let metadata = vec![("meaning", "the line of states.jsonl".to_owned())];
        let field = ArrowField { name: "state", kind: Kind::Text, metadata };
        self.write_parquet(out, vec![Column { field, values: Values::Text(lines) }])
    }

    fn write_parquet(&self, out: impl Write + Send, more: Vec<Column<'_>>) -> Result<(), ParquetError> {
        let columns = self.fields.iter().map(|field| self.column(field)).collect::<Result<Vec<_>, _>>()?;
        let (fields, values): (Vec<_>, Vec<_>) = columns.into_iter().chain(more).map(|c| (c.field, c.values)).unzip();
        let records: serde_json::Value = self.records.iter().map(json::inputs).collect();
        let metadata = [("maille.schema", RECORD_SCHEMA.to_string()), ("maille.records", records.to_string())];
        // Twice: pyarrow shows those of the Arrow schema, DuckDB those of the file.
        let schema = (KEY, arrow_schema(&fields, &metadata));
        let of_file = metadata.into_iter().chain([schema]).map(|(key, value)| KeyValue::new(key.to_owned(), value));
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_created_by(concat!("maille ", env!("CARGO_PKG_VERSION")).to_owned())
            .set_key_value_metadata(Some(of_file.collect()))
            .build();
        let mut writer = SerializedFileWriter::new(out, parquet_schema(&fields)?, Arc::new(properties))?;
        if !self.rows.is_empty() {
            let mut group = writer.next_row_group()?;
            for values in &values {
                let mut column = group.next_column()?.expect("as many columns as fields of the schema");
                values.write(&mut column)?;
                column.close()?;
            }
            group.close()?;
        }
        writer.close()?;
        Ok(())
    }

    fn column<'a>(&self, field: &'a Field) -> Result<Column<'a>, ParquetError> {
        let unit = self.unit(field).map(|unit| ("unit", unit.to_owned()));
        let metadata = [("meaning", field.meaning().to_owned())].into_iter().chain(unit).collect();
        let cells = self.rows.iter().map(|row| field.of(row));
        let values = match field.kind() {
            Kind::Text => Values::Text(cells.map(|cell| cell.text().map(ByteArray::from)).collect()),
            Kind::Number => Values::Number(cells.map(Entry::number).collect()),
            Kind::Flag => Values::Flag(cells.map(Entry::flag).collect()),
            Kind::Count => {
                let column = || field.name().to_owned();
                let signed = |value| i64::try_from(value).map_err(|_| ParquetError::Count { column: column(), value });
                Values::Count(cells.map(|cell| cell.count().map(signed).transpose()).collect::<Result<_, _>>()?)
            }
        };
        Ok(Column { field: ArrowField { name: field.name(), kind: field.kind(), metadata }, values })
    }
}

impl Values {
    fn write(&self, column: &mut SerializedColumnWriter<'_>) -> Result<(), parquet::errors::ParquetError> {
        match self {
            Self::Text(values) => write::<ByteArrayType>(column, values),
            Self::Number(values) => write::<DoubleType>(column, values),
            Self::Flag(values) => write::<BoolType>(column, values),
            Self::Count(values) => write::<Int64Type>(column, values),
        }
    }
}

/// Writes the values that are there, and for each row whether there is one: Parquet's definition level.
fn write<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: &[Option<T::T>],
) -> Result<(), parquet::errors::ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| value.is_some().into()).collect();
    let values: Vec<T::T> = values.iter().flatten().cloned().collect();
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    Ok(())
}

fn parquet_schema(fields: &[ArrowField<'_>]) -> Result<TypePtr, parquet::errors::ParquetError> {
    let column = |field: &ArrowField<'_>| {
        let (physical, logical) = match field.kind {
            Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
            Kind::Number => (Physical::DOUBLE, None),
            Kind::Flag => (Physical::BOOLEAN, None),
            Kind::Count => (Physical::INT64, None),
        };
        let column = Type::primitive_type_builder(field.name, physical).with_repetition(Repetition::OPTIONAL);
        Ok(Arc::new(column.with_logical_type(logical).build()?))
    };
    let columns = fields.iter().map(column).collect::<Result<_, parquet::errors::ParquetError>>()?;
    Ok(Arc::new(Type::group_type_builder("limits").with_fields(columns).build()?))
}
