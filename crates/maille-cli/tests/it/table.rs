//! `maille table` on records that the program has made.

use crate::common::{done_with, maille_with};
use std::path::Path;

/// Standard error of a command that must fail with this code.
fn fails(folder: &Path, arguments: &[&str], code: i32) -> String {
    let output = maille_with(folder, arguments);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stderr).unwrap()
}

/// A folder with records of 1.1 and 1.2: three directions, l2 = −0.25 and 0.
fn records() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for design in ["1.1", "1.2"] {
        let map = ["characterize", design, "--directions", "0,45,90", "--l2=-0.25,0", "--quiet"];
        done_with(folder.path(), &map);
    }
    folder
}

#[test]
fn rows_are_chosen_sorted_and_written() {
    let folder = records();
    let folder = folder.path();
    let text = done_with(
        folder,
        &["table", "1.1", "--where", "direction<=45,l2=0", "--sort=-l1", "--columns", "direction,l1"],
    );
    assert_eq!(
        text,
        "direction_deg        l1\n        [deg]\n           45  0.774035\n            0  0.440000\n2 of 6 rows\n"
    );
    let csv = done_with(folder, &["table", "maille-out/1.1/", "--format", "csv"]);
    assert_eq!(csv, std::fs::read_to_string(folder.join("maille-out/1.1/limits.csv")).unwrap());
    let both = done_with(folder, &["table", "1.1", "1.2", "--where", "status!=global|local", "--format", "csv"]);
    assert!(both.starts_with("record,design,"));

    done_with(folder, &["table", "1.1", "1.2", "-o", "new/limits.parquet"]);
    let bytes = std::fs::read(folder.join("new/limits.parquet")).unwrap();
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
    done_with(folder, &["table", "1.1", "--rows", "2", "-o", "new/limits.json"]);
    let json: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.join("new/limits.json")).unwrap()).unwrap();
    assert_eq!(json["rows"].as_array().unwrap().len(), 2);

    let wrong = fails(folder, &["table", "1.1", "--where", "lamda1>0"], 2);
    assert!(wrong.contains("did you mean lambda1?"), "{wrong}");
    let wrong = fails(folder, &["table", "1.1", "-o", "limits.xls"], 2);
    assert!(wrong.contains(".parquet"), "{wrong}");
    let wrong = fails(folder, &["table", "nowhere"], 4);
    assert!(wrong.contains("there is no folder nowhere"), "{wrong}");
    assert!(fails(folder, &["table", "1.1", "maille-out/1.1"], 2).contains("given twice"));
}
