//! Records that an older program wrote (`tests/records`) are read by this one, and their rows come out the same.

use crate::common::done;
use std::{fs, path::Path};

const FILES: [&str; 3] = ["run.json", "limits.csv", "states.jsonl"];

/// Reads the record `name`; `caption` stands in its plot, and the limit at `at` is solved again.
fn read_by_every_command(name: &str, caption: &str, at: &str) {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/records").join(name);
    let temporary = tempfile::tempdir().unwrap();
    let folder = temporary.path();
    fs::create_dir(folder.join("old")).unwrap();
    for file in FILES {
        fs::copy(from.join(file), folder.join("old").join(file)).unwrap();
    }
    let (table, old) = (done(folder, "table ./old --format csv"), fs::read_to_string(from.join("limits.csv")).unwrap());
    assert_eq!(table.lines().count(), old.lines().count());
    for (line, old) in table.lines().zip(old.lines()) {
        let later = line.strip_prefix(old).unwrap_or_else(|| panic!("{line} does not begin with {old}"));
        assert!(later == ",better_chance,wave_curvature,wave_q1,wave_q2,extreme" || later == ",,,,,", "{line}");
    }
    done(folder, "plot ./old -o old.svg");
    let svg = fs::read_to_string(folder.join("old.svg")).unwrap();
    assert!(svg.contains(caption), "{svg}");
    let found: serde_json::Value = serde_json::from_str(&done(folder, "verify ./old --json --quiet")).unwrap();
    assert_eq!(found["records"][0]["outcome"], "proved", "{found:#}");
    let replayed = done(folder, &format!("replay ./old --at {at}"));
    assert!(replayed.contains("recorded") && !replayed.contains("DIFFERS"), "{replayed}");
    for file in FILES {
        assert_eq!(fs::read(folder.join("old").join(file)).unwrap(), fs::read(from.join(file)).unwrap(), "{file}");
    }
}

#[test]
fn an_old_record_of_the_exact_method_is_read() {
    read_by_every_command("exact", "exact method", "direction=30,l2=-0.25");
}

#[test]
fn an_old_record_of_the_energy_method_is_read() {
    read_by_every_command("energy", "τ = 0.0001", "direction=0,l2=-0.25");
}
