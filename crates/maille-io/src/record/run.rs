//! `run.json`: the inputs of a run, and what it has done.

use super::error::RecordError;
use maille::design::Design;
use maille::record::{LimitRow, RECORD_SCHEMA};
use maille::survey::MapQuestion;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;

/// Enough to repeat a run. No time of day and no machine in it: the same run gives the same file, but for the checksum of
/// `limits.csv`, which has wall times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRecord {
    /// Version of the record's files.
    pub schema: u32,
    /// Version of the program that computed it.
    pub program_version: String,
    /// [`input_hash`] of `design` and `parameters`.
    pub input_hash: String,
    /// The design as computed.
    pub design: Design,
    /// How far smooth curves are from the arcs that stand for them, at most, in the file's unit; none without such curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_deviation: Option<f64>,
    /// Every parameter and tolerance that was used.
    pub parameters: Value,
    /// What was done.
    pub counters: Counters,
    /// SHA-256 of `limits.csv` and `states.jsonl`; after it that of the file before, so that a run killed between two files
    /// leaves a record that is known as whole. Empty in records older than it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, Vec<String>>,
}

impl RunRecord {
    /// A run with these inputs that has done nothing yet.
    pub fn new(design: &Design, parameters: &Value, program_version: &str) -> Self {
        RunRecord {
            schema: RECORD_SCHEMA,
            program_version: program_version.to_owned(),
            input_hash: input_hash(design, parameters),
            design: design.clone(),
            curve_deviation: design.curve_deviation(),
            parameters: parameters.clone(),
            counters: Counters::default(),
            files: BTreeMap::new(),
        }
    }

    /// Refuses a deviation of curves that is not the design's, but for the last digits of sines on other machines; older records have none. `file`
    /// is the name to show.
    ///
    /// # Errors
    /// Where it was edited.
    pub fn check_curve_deviation(&self, file: &str) -> Result<(), RecordError> {
        let (found, expected) = (self.curve_deviation, self.design.curve_deviation());
        let near = |found: f64| expected.is_some_and(|expected| (found - expected).abs() <= 1e-6 * expected);
        match found {
            Some(found) if !near(found) => {
                let of_design = expected.map_or("none".to_owned(), |expected| expected.to_string());
                let problem = format!("curve_deviation was edited: it is {found}, that of the design {of_design}");
                Err(RecordError::malformed(file, 1, problem))
            }
            _ => Ok(()),
        }
    }

    /// What was asked.
    ///
    /// # Errors
    /// Where `parameters` do not say it: the file was not written by this program.
    pub fn question(&self) -> Result<MapQuestion, RecordError> {
        let wrong = |problem: String| RecordError::malformed("run.json", 1, format!("parameters: {problem}"));
        let question: MapQuestion =
            serde_json::from_value(self.parameters.clone()).map_err(|e| wrong(e.to_string()))?;
        question.check().map_err(|e| wrong(e.to_string()))?;
        Ok(question)
    }
}

/// Sums over the rows of a record.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counters {
    /// Rows of each status.
    pub rows: BTreeMap<String, u64>,
    /// Quadratic programs (exact) or Newton iterations (energy) of all rows.
    pub iterations: u64,
    /// Starts (exact) or minimisations (energy) of all rows.
    pub runs: u64,
}

impl Counters {
    /// The sums over `rows`.
    pub fn of(rows: &[LimitRow]) -> Self {
        let mut out = Self::default();
        for row in rows {
            *out.rows.entry(row.status.name().to_owned()).or_default() += 1;
            out.iterations += row.iterations;
            out.runs += row.runs;
        }
        out
    }
}

/// SHA-256, in hexadecimal, of the record's schema, the design and the parameters as JSON with sorted keys.
pub fn input_hash(design: &impl Serialize, parameters: &Value) -> String {
    let mut inputs = json!({ "schema": RECORD_SCHEMA, "design": design, "parameters": parameters });
    inputs.sort_all_objects();
    sha256(inputs.to_string().as_bytes())
}

/// SHA-256 in hexadecimal.
pub(crate) fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The file's text.
pub fn write_run(run: &RunRecord) -> String {
    serde_json::to_string_pretty(run).expect("a run has no map with odd keys") + "\n"
}

/// Reads the file; `file` is the name to show in errors. Design and parameters must have their hash.
pub fn read_run(file: &str, text: &str) -> Result<RunRecord, RecordError> {
    let bad = |e: serde_json::Error| RecordError::json(file, e.line().max(1), &e);
    let value: Value = serde_json::from_str(text).map_err(bad)?;
    match value.get("schema").and_then(Value::as_u64) {
        Some(known) if known == u64::from(RECORD_SCHEMA) => {
            let run: RunRecord = serde_json::from_str(text).map_err(bad)?;
            let found = input_hash(&value["design"], &value["parameters"]);
            if found != run.input_hash {
                let problem =
                    format!("design or parameters were edited: their hash is {found}, not {}", run.input_hash);
                return Err(RecordError::malformed(file, 1, problem));
            }
            run.check_curve_deviation(file)?;
            Ok(run)
        }
        Some(other) => {
            Err(RecordError::malformed(file, 1, format!("schema {other}; this program reads schema {RECORD_SCHEMA}")))
        }
        None => Err(RecordError::malformed(file, 1, "no schema: not the run of a record")),
    }
}
