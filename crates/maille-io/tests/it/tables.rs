//! Tables: text, CSV and JSON, and the page that describes the columns.

use crate::common::rows::{design, record, row};
use maille::record::{Column, LIMIT_COLUMNS, RECORD_SCHEMA, Status};
use maille_io::NumberPath;
use maille_io::record::{
    BEND_COLUMN, FORCE_COLUMNS, NamedRecord, PLACE_COLUMNS, SENSITIVITY_COLUMNS, read_limits, write_limits,
};
use maille_io::table::{Condition, Extent, Field, SortKey, Table};
use serde_json::Value;

fn two() -> [NamedRecord; 2] {
    let mut first =
        vec![row(0.0, -0.125, Some(0.44000000000000017)), row(15.0, -0.125, None), row(30.0, 0.0, Some(0.5))];
    first[0].min_gap = Some(-1e-17);
    first[2].min_gap = Some(-0.00021);
    first[0].iterations = 1234;
    first[2].status = Status::Local;
    first[2].cell = "1,0;-1,2".into();
    let mut mm = design();
    mm.unit = Some("mm".into());
    [record("out/a", design(), first), record("out/b", mm, vec![row(0.0, 0.25, Some(-0.05))])]
}

fn table(records: &[NamedRecord], columns: &str) -> String {
    Table::new(records, Field::parse_list(columns).unwrap()).text(Extent::default())
}

#[test]
fn text_is_aligned_rounded_and_counted() {
    let records = two();
    assert_eq!(
        table(&records[..1], "design,direction,l2,l1,min_gap,iterations,status"),
        "\
design  direction_deg      l2    l1   min_gap  iterations  status
                [deg]                [length]
1.1                 0  -0.125  0.44  -1.0e-17        1234  threshold-reached
1.1                15  -0.125     -         -           0  l2-not-reached
1.1                30   0.000  0.50   -2.1e-4           0  local
3 rows
"
    );
    let mut chosen = Table::new(&records, Field::first_look(&records));
    chosen.keep(&Condition::parse_list("l1!=none").unwrap());
    chosen.sort(&SortKey::parse_list("-l1").unwrap());
    assert_eq!(
        chosen.text(Extent { width: Some(60), rows: Some(2) }),
        "\
record  design  minor_radius  method  direction_deg      l2
                     [mixed]                  [deg]
out/a   1.1              0.1  energy             30   0.000
out/a   1.1              0.1  energy              0  -0.125
first 2 of 3 chosen rows, of 4
columns that do not fit: l1, status, bound_l1, grows_with_cell, image_of_deg, iterations, wall_s
"
    );
    assert_eq!(table(&[], "l2"), "l2\n\n0 rows\n");
    let narrow = Table::new(&records, Field::all(&records, false)).text(Extent { width: Some(1), rows: Some(0) });
    assert!(narrow.starts_with("design\n\nfirst 0 of 4 rows\ncolumns that do not fit: minor_radius, "), "{narrow}");
}

#[test]
fn a_table_of_everything_is_the_records_own() {
    let records = two();
    let own = write_limits(&records[0].record.rows).unwrap();
    assert_eq!(Table::new(&records[..1], Field::all(&records[..1], false)).csv(), own);
    let both = Table::new(&records, Field::all(&records, true)).csv();
    assert!(both.starts_with("record,design,minor_radius,") && both.contains("\nout/b,\"1.1\",0.1,"));
    let without: String = both.lines().map(|line| format!("{}\n", line.split_once(',').unwrap().1)).collect();
    assert_eq!(read_limits("", &without).unwrap().len(), 4);
}

#[test]
fn json_has_columns_with_units_inputs_and_rows() {
    let records = two();
    let json: Value = serde_json::from_str(&Table::new(&records, Field::all(&records, true)).json()).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    assert_eq!(rows[0]["l1"], 0.44000000000000017);
    assert_eq!((&rows[1]["l1"], &rows[0]["iterations"]), (&Value::Null, &1234.into()));
    assert_eq!(rows[3]["record"], "out/b");
    let column = |name: &str| json["columns"].as_array().unwrap().iter().find(|c| c["name"] == name).unwrap();
    assert_eq!(column("wall_s")["unit"], "s");
    assert_eq!(column("min_gap")["unit"], "mixed");
    assert_eq!(column("design")["unit"], Value::Null);
    assert_eq!(json["records"][1]["design"]["unit"], "mm");
    let none: Value = serde_json::from_str(&Table::new(&[], Field::all(&[], false)).json()).unwrap();
    assert_eq!(none["rows"], Value::Array(Vec::new()));
}

/// What a study has set is known of each record, stands in columns after the others, and can be asked for.
#[test]
fn what_a_study_varies_is_a_column() {
    let mut records = two();
    let place: NumberPath = "elements.standing-*.rings.major_radius".parse().unwrap();
    let varied = place.set(&records[1].record.run.design, 0.75).unwrap().spaced(0.5).spaced(1.5);
    records[1].record.run.design = varied;
    let csv = Table::new(&records, Field::all(&records, true)).csv();
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().ends_with(",wave_q2,extreme,elements.standing-*.rings.major_radius,spacing"));
    let ends: Vec<bool> = lines.map(|line| line.ends_with(",0.75,0.75")).collect();
    assert_eq!(ends, [false, false, false, true]);
    assert!(csv.lines().nth(1).unwrap().ends_with(",,"));
    let mut chosen = Table::new(&records, Field::parse_list("record,spacing,l2").unwrap());
    chosen.keep(&Condition::parse_list("spacing=0.75").unwrap());
    assert_eq!(chosen.csv(), "record,spacing,l2\nout/b,0.75,0.25\n");
    let json: Value =
        serde_json::from_str(&Table::new(&records[1..], Field::all(&records[1..], false)).json()).unwrap();
    let units: Vec<&Value> = json["columns"].as_array().unwrap().iter().rev().take(2).map(|c| &c["unit"]).collect();
    assert_eq!(units, ["1", "mm"]);
    let shown = Table::new(&records, Field::first_look(&records)).text(Extent::default());
    assert!(shown.contains("spacing  direction_deg"), "{shown}");
}

#[test]
fn columns_are_named_once_and_known() {
    let checked = |text: &str| Field::parse_list(text)?.iter().try_for_each(|field| field.check(&two()));
    let message = |text: &str| checked(text).unwrap_err().to_string();
    assert_eq!(message("l1,lambda3"), "there is no column \"lambda3\"; did you mean lambda1?");
    assert_eq!(message("direction,l1,direction_deg"), "column direction_deg is named twice; name each column once");
    assert!(message("xyz").ends_with("wave_q2, extreme, record, spacing"));
}

fn document(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name);
    std::fs::read_to_string(path).unwrap()
}

/// What stands in the first cells of the tables of a page.
fn names(page: &str) -> Vec<&str> {
    page.lines().filter_map(|line| line.strip_prefix("| `")?.split('`').next()).collect()
}

#[test]
fn the_page_of_columns_says_what_the_program_says() {
    let page = document("docs/record.md");
    let (page, forces) = page.split_once("\n## The forces of a simulated sheet\n").unwrap();
    let (page, statuses) = page.split_once("\n## Statuses\n").unwrap();
    let (statuses, rest) = statuses.split_once("\n## Derivatives\n").unwrap();
    let derivatives = rest.split("\n## ").next().unwrap();
    let lines: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    let line = |c: &Column| {
        let unit = c.unit.name(None).map(|unit| format!(" {unit}")).unwrap_or_default();
        format!("| `{}` |{unit} | {} | {} | {} |", c.name, c.kind.name(), c.since, c.meaning)
    };
    assert_eq!(lines, LIMIT_COLUMNS.iter().map(line).collect::<Vec<_>>());
    assert_eq!(names(forces), FORCE_COLUMNS.into_iter().chain([BEND_COLUMN]).chain(PLACE_COLUMNS).collect::<Vec<_>>());
    assert!(LIMIT_COLUMNS.iter().all(|c| (1..=RECORD_SCHEMA).contains(&c.since)));
    assert_eq!(names(statuses), Status::ALL.map(Status::name));
    assert_eq!(names(derivatives), SENSITIVITY_COLUMNS);
}
