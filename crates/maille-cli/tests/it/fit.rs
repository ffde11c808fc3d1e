//! `maille fit` as a user meets it: its folder, the same command again, several designs, and what cannot begin.

use crate::common::{done_with, maille_with};
use std::{fs, path::Path};

const RINGS: &str = "elements.standing-*.rings.major_radius=25%";

#[test]
fn a_fit_is_a_folder_that_other_commands_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("wanted.csv"), "direction_deg,l1\n0,0.40\n90,0.48\n").unwrap();
    let command = ["fit", "1.1", "--target", "wanted.csv", "--free-each", RINGS];
    let said = done_with(folder, &command);
    assert!(said.starts_with("1.1: every target is reached; 1 start"), "{said}");
    let fit = folder.join("maille-out/1.1-fit");
    let design = fs::read_to_string(fit.join("fitted.toml")).unwrap();
    // Along each chain l1 = 0.8 (1 + R - 2 r) - 1.
    assert!(design.contains("major_radius = 0.95,") && design.contains("major_radius = 1.05,"), "{design}");
    assert!(design.contains("source = \"own\""));
    let proved = done_with(folder, &["verify", "maille-out/1.1-fit/fitted"]);
    assert!(proved.contains("13 of 13 certified ones proved"), "{proved}");
    done_with(folder, &["plot", "1.1-fit", "-o", "again.svg"]);
    assert_eq!(fs::read(folder.join("again.svg")).unwrap(), fs::read(fit.join("fit.svg")).unwrap());
    // The same command finds all of it there, and makes what was lost.
    fs::remove_dir_all(fit.join("fitted")).unwrap();
    let json: serde_json::Value =
        serde_json::from_str(&done_with(folder, &[&command[..], &["--json"]].concat())).unwrap();
    assert_eq!((json["ended"].as_str(), json["designs"].as_u64()), (Some("reached"), Some(3)));
    assert!(done_with(folder, &["verify", "maille-out/1.1-fit/fitted"]).contains("13 of 13"));
    let other = maille_with(folder, &[&command[..], &["--norm", "minimax"]].concat());
    assert_eq!(other.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&other.stderr).contains("a fit of other inputs"));
    // A record is a target: the built-in design is fitted to the limits that were found.
    let limits = "maille-out/1.1-fit/fitted/limits.csv";
    let back = done_with(folder, &["fit", "1.1", "--target", limits, "--free-each", RINGS, "--out", "back"]);
    assert!(back.contains("every target is reached"), "{back}");
}

#[test]
fn designs_are_ranked() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("wanted.csv"), "direction_deg,at_least\n0,0.42\n60,0.42\n").unwrap();
    fs::create_dir(folder.join("mine")).unwrap();
    let design = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../designs/1.2.toml")).unwrap();
    fs::write(folder.join("mine/a.toml"), design).unwrap();
    fs::write(folder.join("mine/broken.toml"), "name = 3\n").unwrap();
    let arguments = ["fit", "--target", "wanted.csv", "--restarts", "1", "--over", "1.1", "mine"];
    let ran = maille_with(folder, &arguments);
    assert_eq!(ran.status.code(), Some(6));
    assert!(String::from_utf8_lossy(&ran.stderr).contains("broken.toml could not be used"));
    let table = fs::read_to_string(folder.join("maille-out/fits/ranking.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 2, "{table}");
    let costs: Vec<f64> = rows.iter().map(|row| row[3].parse().unwrap()).collect();
    assert!(costs[0] <= costs[1] && rows[0][1] == "\"1.1\"" && rows[0][2] == "reached", "{table}");
}

#[test]
fn what_cannot_begin_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("wide.csv"), "direction_deg,l2,l1\n0,5,0.4\n").unwrap();
    let ran =
        maille_with(folder, &["fit", "1.1", "--target", "wide.csv", "--free", "minor_radius=20%", "--out", "gone"]);
    assert_eq!(ran.status.code(), Some(5));
    assert!(String::from_utf8_lossy(&ran.stderr).contains("at l2 5 of the given design is l2-unreachable"));
    assert!(!folder.join("gone").exists());
}
