//! What other programs read in a Parquet table: pyarrow, pandas, polars and DuckDB (`tests/foreign`).

use crate::common::{
    foreign::{checkers, python, run},
    rows,
};
use maille::record::{Column, LIMIT_COLUMNS, RECORD_SCHEMA, Status};
use maille_io::record::{read_limits, write_limits};
use maille_io::table::{Field, Table};
use serde_json::{Map, Value, json};
use std::process::Command;

/// A line of `limits.csv` as values, with the types of the columns.
fn values(line: &[String]) -> Value {
    let value = |(text, kind): (&String, &str)| match (text.as_str(), kind) {
        ("", _) => Value::Null,
        (text, "text") => text.into(),
        (text, "flag") => (text == "true").into(),
        (text, "count") => text.parse::<u64>().unwrap().into(),
        (text, _) => text.parse::<f64>().unwrap().into(),
    };
    let cells = line.iter().zip(LIMIT_COLUMNS.map(|c| c.kind.name()));
    Value::Object(LIMIT_COLUMNS.iter().map(|c| c.name.to_owned()).zip(cells.map(value)).collect::<Map<_, _>>())
}

#[test]
fn other_programs_read_rows_types_and_units() {
    let mut limits = rows::turn(-0.25, |d| (d != 45.0).then_some(0.1 + 0.2 + 0.001 * d));
    limits[0].design = "1.10, \"Kette\" µ".into();
    limits[0].minor_radius = None;
    limits[1].status = Status::Local;
    limits[1].bound_kind = Some("chain".into());
    limits[1].bound_gap = Some(5e-324);
    limits[1].zero_modes = Some(7);
    limits[2].links_ok = Some(false);
    limits[2].l1_uncertified = Some(f64::MAX);
    limits[3].iterations = 1 << 62;
    let mut design = rows::design();
    design.unit = Some("mm".into());
    let records = [rows::record("out/ä 1", design, limits)];

    // What is expected comes from `limits.csv` by way of another reader.
    let text = write_limits(&records[0].record.rows).unwrap();
    assert_eq!(read_limits("", &text).unwrap(), records[0].record.rows);
    let lines = csv::Reader::from_reader(text.as_bytes()).into_records();
    let lines = lines.map(|line| line.unwrap().iter().map(str::to_owned).collect::<Vec<_>>());
    let run_record = &records[0].record.run;
    let column = |c: &Column| json!({ "name": c.name, "type": c.kind.name(), "unit": c.unit.name(Some("mm")), "meaning": c.meaning });
    let expected = json!({
        "schema": RECORD_SCHEMA,
        "columns": LIMIT_COLUMNS.iter().map(column).collect::<Vec<_>>(),
        "rows": lines.map(|line| values(&line)).collect::<Vec<_>>(),
        "records": [{
            "record": "out/ä 1",
            "schema": RECORD_SCHEMA,
            "program_version": run_record.program_version,
            "input_hash": run_record.input_hash,
            "design": run_record.design,
            "parameters": run_record.parameters,
        }],
    });

    let folder = tempfile::tempdir().unwrap();
    let file = std::fs::File::create(folder.path().join("table.parquet")).unwrap();
    Table::new(&records, Field::all(&records, false)).parquet(file).unwrap();
    std::fs::write(folder.path().join("expected.json"), expected.to_string()).unwrap();
    run(Command::new(python()).arg(checkers().join("check_table.py")).arg(folder.path()));
}
