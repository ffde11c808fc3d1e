//! `maille prove` and what `maille verify` says of its files.

use crate::common::{code, maille};
use serde_json::Value;
use std::{fs, process::Output};

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&output.stderr)))
}

#[test]
fn a_limit_is_proved_for_its_cell_and_verified() {
    let dir = tempfile::tempdir().unwrap();
    let output = maille(dir.path(), "prove 2 --direction 45 --starts 4 --json --quiet");
    let found = json(&output);
    assert_eq!((code(&output), &found["status"]), (0, &"proved".into()), "{found:#}");
    let (l1, most) = (found["l1_found"].as_f64().unwrap(), found["l1_at_most"].as_f64().unwrap());
    assert!((l1 - 0.117_293_59).abs() < 1e-6 && (most - l1 - 1e-3).abs() < 1e-12, "{found:#}");
    let output = maille(dir.path(), "verify maille-out/2-45deg.proof --json --quiet");
    let verified = json(&output);
    let proof = &verified["proofs"][0];
    assert_eq!(
        (code(&output), &proof["outcome"], &proof["cell"]),
        (0, &"proved".into(), &"1x1".into()),
        "{verified:#}"
    );
    assert_eq!((proof["l1_at_most"].as_f64(), proof["failed"].as_u64()), (Some(most), Some(0)));
    let words = String::from_utf8(maille(dir.path(), "verify maille-out/2-45deg.proof --quiet").stdout).unwrap();
    assert!(words.contains("proved for the cell 1x1: no state has l1 above 0.118293"), "{words}");
    // A line that was changed is found by the sum.
    let path = dir.path().join("maille-out/2-45deg.proof");
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replacen("\"l2\":0.0", "\"l2\":0.1", 1)).unwrap();
    assert_eq!(code(&maille(dir.path(), "verify maille-out/2-45deg.proof")), 4);
}

#[test]
fn what_is_not_reached_is_left_open_and_the_rest_is_proved() {
    let dir = tempfile::tempdir().unwrap();
    let output =
        maille(dir.path(), "prove 2 --direction 45 --at-most 0.1 --boxes 4000 --out some.proof --json --quiet");
    let found = json(&output);
    // The limit is 0.117294: 0.1 cannot be proved.
    assert_eq!((code(&output), &found["status"]), (5, &"open".into()), "{found:#}");
    let most = found["l1_at_most"].as_f64().unwrap();
    assert!(most > 0.117 && most < 0.15 && found["boxes_left"].as_u64().unwrap() > 0, "{found:#}");
    let output = maille(dir.path(), "verify some.proof --json --quiet");
    assert_eq!((code(&output), json(&output)["proofs"][0]["l1_at_most"].as_f64()), (0, Some(most)));
}
