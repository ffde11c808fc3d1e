//! Records that can be tampered with, and what `verify` says of them.

use crate::common::{code, maille};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// What `verify` finds in a record, with its exit code.
pub fn verified(folder: &Path, record: &str) -> (i32, Value) {
    let output = maille(folder, &format!("verify {record} --json --quiet"));
    let found: Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|e| panic!("{record}: {e}: {}", String::from_utf8_lossy(&output.stderr)));
    (code(&output), found["records"][0].clone())
}

/// The words of the checks of `name` that came to `verdict`.
pub fn said(found: &Value, name: &str, verdict: &str) -> Vec<String> {
    let rows = found["rows"].as_array().unwrap().iter().flat_map(|row| row["findings"].as_array().unwrap());
    let all = rows.chain(found["files"].as_array().unwrap());
    let of = all.filter(|f| f["check"] == name && f["verdict"] == verdict);
    of.map(|f| f["words"].as_str().unwrap().to_owned()).collect()
}

/// All certified rows of a record are proved, of which there is at least one.
pub fn all_proved(folder: &Path, record: &str) {
    let (code, found) = verified(folder, record);
    assert_eq!((code, &found["outcome"]), (0, &json!("proved")), "{record}: {found:#}");
    assert_eq!(found["certified"], found["proved"], "{record}");
    assert!(found["certified"].as_u64().unwrap() > 0, "{record}: {found:#}");
}

/// A record that can be tampered with.
pub struct Specimen {
    pub dir: tempfile::TempDir,
}

impl Specimen {
    /// Of 1.1.
    pub fn new() -> Self {
        Specimen::of("1.1 --directions 0,25 --l2=-0.125,0 --cell 1x1")
    }

    pub fn of(rest: &str) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let line = format!("characterize {rest} --out record --quiet");
        assert!([0, 5].contains(&code(&maille(dir.path(), &line))), "{line}");
        all_proved(dir.path(), "record");
        Specimen { dir }
    }

    /// Changes cells of the first row, and what the state and the counters say of its status.
    pub fn forge_row(&self, cells: &[(&str, &str)]) {
        let mut lines: Vec<Vec<String>> =
            self.text("limits.csv").lines().map(|line| line.split(',').map(str::to_owned).collect()).collect();
        for (column, value) in cells {
            let at = lines[0].iter().position(|name| name == column).unwrap_or_else(|| panic!("{column}"));
            lines[1][at] = (*value).to_owned();
        }
        let text: Vec<String> = lines.iter().map(|cells| cells.join(",")).collect();
        self.forge("limits.csv", &(text.join("\n") + "\n"));
        let Some((_, status)) = cells.iter().find(|(column, _)| *column == "status") else { return };
        self.forge_state(|state| state["status"] = json!(status));
        let at = lines[0].iter().position(|name| name == "status").unwrap();
        let mut counts = serde_json::Map::new();
        for line in &lines[1..] {
            let count = counts.get(&line[at]).and_then(Value::as_u64).unwrap_or(0);
            counts.insert(line[at].clone(), json!(count + 1));
        }
        self.forge_run(|run| run["counters"]["rows"] = Value::Object(counts.clone()));
    }

    /// A cell of the first row.
    pub fn cell(&self, column: &str) -> String {
        let text = self.text("limits.csv");
        let mut lines = text.lines();
        let at = lines.next().unwrap().split(',').position(|name| name == column).unwrap();
        lines.next().unwrap().split(',').nth(at).unwrap().to_owned()
    }

    /// Changes `run.json`, with its input hash.
    pub fn forge_run(&self, change: impl Fn(&mut Value)) {
        let mut run: Value = serde_json::from_str(&self.text("run.json")).unwrap();
        change(&mut run);
        let inputs = [("design", &run["design"]), ("parameters", &run["parameters"]), ("schema", &run["schema"])];
        let inputs: Vec<String> = inputs.iter().map(|(name, value)| format!("\"{name}\":{}", sorted(value))).collect();
        let sum = Sha256::digest(format!("{{{}}}", inputs.join(",")));
        run["input_hash"] = json!(sum.iter().map(|byte| format!("{byte:02x}")).collect::<String>());
        fs::write(self.path("run.json"), serde_json::to_string_pretty(&run).unwrap() + "\n").unwrap();
    }

    /// The first row is false or open, as `code` says, by this check; the files fit together.
    pub fn found_by(&self, code: i32, check: &str, words: &str) {
        let (found_code, found) = self.verified();
        assert_eq!(found_code, code, "{found:#}");
        assert_eq!(said(&found, "files", "false"), [""; 0]);
        let is_certified = found["rows"][0]["certified"] == true;
        assert!(!is_certified || found["proved"].as_u64() < found["certified"].as_u64());
        let said = said(&found, check, if code == 4 { "false" } else { "open" });
        assert!(said.iter().any(|w| w.contains(words)), "{check} {words}: {found:#}");
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.dir.path().join("record").join(name)
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Writes a file and its checksum.
    pub fn forge(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
        let mut run: Value = serde_json::from_str(&self.text("run.json")).unwrap();
        let sum: String = Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect();
        run["files"][name] = json!([sum]);
        fs::write(self.path("run.json"), serde_json::to_string_pretty(&run).unwrap() + "\n").unwrap();
    }

    /// Changes the first state, with its checksum.
    pub fn forge_state(&self, change: impl Fn(&mut Value)) {
        let text = self.text("states.jsonl");
        let (first, rest) = text.split_once('\n').unwrap();
        let mut state: Value = serde_json::from_str(first).unwrap();
        change(&mut state);
        self.forge("states.jsonl", &format!("{state}\n{rest}"));
    }

    pub fn verified(&self) -> (i32, Value) {
        verified(self.dir.path(), "record")
    }

    /// Exactly the first row is refuted, by this check.
    pub fn refuted_by(&self, check: &str, words: &str) {
        let (code, found) = self.verified();
        assert_eq!((code, &found["outcome"]), (4, &json!("false")), "{found:#}");
        assert_eq!(found["proved"], 3);
        assert_eq!(said(&found, "files", "false"), [""; 0]);
        let said = said(&found, check, "false");
        assert!(said.iter().any(|w| w.contains(words)), "{check} {words}: {found:#}");
    }
}

/// JSON with sorted keys and no spaces.
fn sorted(value: &Value) -> String {
    match value {
        Value::Object(map) => {
            let mut keys: Vec<&String> = map.keys().collect();
            keys.sort();
            let entries: Vec<String> =
                keys.iter().map(|key| format!("{}:{}", json!(key), sorted(&map[*key]))).collect();
            format!("{{{}}}", entries.join(","))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(sorted).collect::<Vec<_>>().join(",")),
        leaf => leaf.to_string(),
    }
}
