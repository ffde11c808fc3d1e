//! Directions that a design's symmetries make images of each other: rows that agree, are proved by `verify`, and are told.

use crate::common::maille;
use serde_json::Value;
use std::path::Path;

/// The rows of a record, as `table` writes them.
fn rows(folder: &Path, record: &str) -> Vec<Value> {
    let table = maille(folder, &format!("table {record} --format json"));
    let table: Value = serde_json::from_slice(&table.stdout).unwrap();
    table["rows"].as_array().unwrap().clone()
}

fn at(rows: &[Value], direction_deg: f64, l2: f64) -> &Value {
    rows.iter().find(|row| row["direction_deg"] == direction_deg && row["l2"] == l2).unwrap()
}

fn proved(folder: &Path, record: &str) {
    let output = maille(folder, &format!("verify {record} --json --quiet"));
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    let found = &found["records"][0];
    assert_eq!((output.status.code(), found["outcome"].as_str()), (Some(0), Some("proved")), "{record}: {found:#}");
    assert!(found["certified"].as_u64().unwrap() > 0, "{record}: {found:#}");
}

/// A shirt of European 4-in-1 has mirrors; its limits are `local`, and the search is not symmetric.
#[test]
fn mirror_images_of_a_shirt_agree() {
    let dir = tempfile::tempdir().unwrap();
    let line = "new shirt --weave european-4-in-1 --wire 16swg --id 5/16in";
    assert!(maille(dir.path(), line).status.success());
    let line =
        "characterize shirt.toml --directions 75,105,80,100 --l2=-0.25,0 --cell 1x1 --starts 1 --out shirt --quiet";
    maille(dir.path(), line);
    let rows = rows(dir.path(), "shirt");
    for (solved, image) in [(75.0, 105.0), (80.0, 100.0)] {
        for l2 in [-0.25, 0.0] {
            let (a, b) = (at(&rows, solved, l2), at(&rows, image, l2));
            assert_eq!(
                (&a["status"], &b["image_of_deg"], &a["image_of_deg"]),
                (&b["status"], &solved.into(), &Value::Null)
            );
            if let (Some(x), Some(y)) = (a["l1"].as_f64(), b["l1"].as_f64()) {
                assert!((x - y).abs() < 1e-9, "{image}°, l2 = {l2}: {x} {y}");
            }
        }
    }
    assert!(rows.iter().any(|row| row["status"] == "local" && !row["image_of_deg"].is_null()), "{rows:#?}");
    proved(dir.path(), "shirt");
}

/// Images in cells that no run asked for, of free widths and shears, and of compressions are proved as other rows are.
#[test]
fn images_are_verified() {
    let dir = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("larger", "3.1 --directions 90,150,30 --l2=-0.25,0"),
        ("free", "1.1 --directions 20,160,70 --lateral free --shear free --cell 1x1 --starts 1"),
        ("least", "1.1 --directions 0,90 --l2 0 --compression --cell 2x2 --starts 1"),
        ("doubled", "5.1 --directions 20,160,110 --l2=-0.125,0 --cell 1x1"),
        ("bodies", "4.3 --directions 20,160,70,100 --l2 0 --cell 1x1"),
    ] {
        let line = format!("characterize {arguments} --out {name} --quiet");
        assert!(maille(dir.path(), &line).status.success(), "{line}");
        let rows = rows(dir.path(), name);
        assert!(rows.iter().any(|row| !row["image_of_deg"].is_null() && !row["l1"].is_null()), "{name}: {rows:#?}");
        proved(dir.path(), name);
    }
    // The note of old is a column, seen in the summary, the table and the figure.
    let larger = rows(dir.path(), "larger");
    let row = at(&larger, 30.0, -0.25);
    assert!(row["by_cell"].as_str().is_some_and(|cells| cells.starts_with("1x1 ")), "{row:#}");
    assert!(row["grows_with_cell"].is_boolean(), "{row:#}");
}
