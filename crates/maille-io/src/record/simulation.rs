//! `simulation.json` and `frames.jsonl`: what a simulated sheet leaves behind.

use super::error::{RecordError, complete};
use maille::{design::Design, record::FrameRecord, simulate::End};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Names of the two files of the record.
pub const SIMULATION: [&str; 2] = ["simulation.json", "frames.jsonl"];

/// What was done to a finite sheet, and what came out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationRecord {
    /// Version of the format, 1.
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// The design, with the minor radius that was used.
    pub design: Design,
    /// Cells along a1 and a2, as `10x10`.
    pub tile: String,
    /// Edges, pulls, weight, floor and parameters, as given.
    pub setup: Value,
    /// What came out.
    pub outcome: SimulationOutcome,
}

/// What came out of a simulation. Lengths in the file's unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SimulationOutcome {
    /// How it ended.
    pub end: End,
    /// Largest share of the pull that was reached.
    pub share: f64,
    /// Smallest gap there; negative where tori overlap.
    pub smallest_gap: Option<f64>,
    /// Whether the links are those of the start.
    pub links_ok: bool,
    /// Newton iterations.
    pub iterations: usize,
    /// Random kicks.
    pub kicks: usize,
    /// Steps against a drag that ended without a balance of forces.
    #[serde(default)]
    pub unbalanced: usize,
    /// What happened, where `end` does not say it.
    pub note: Option<String>,
}

/// The record as text.
pub fn write_simulation(record: &SimulationRecord) -> String {
    serde_json::to_string_pretty(record).expect("no map with odd keys") + "\n"
}

/// Reads the record; `file` is the name to show in errors.
pub fn read_simulation(file: &str, text: &str) -> Result<SimulationRecord, RecordError> {
    complete(file, text)?;
    let record: SimulationRecord =
        serde_json::from_str(text).map_err(|e| RecordError::malformed(file, e.line(), e.to_string()))?;
    match record.schema {
        1 => Ok(record),
        n => Err(RecordError::malformed(file, 1, format!("schema {n} is not known; this program reads 1"))),
    }
}

/// The frames as text, one a line.
pub fn write_frames(frames: &[FrameRecord]) -> String {
    frames.iter().map(|f| serde_json::to_string(f).expect("no map with odd keys") + "\n").collect()
}

/// Reads frames; `file` is the name to show in errors.
pub fn read_frames(file: &str, text: &str) -> Result<Vec<FrameRecord>, RecordError> {
    complete(file, text)?;
    let read = |(i, line): (usize, &str)| {
        serde_json::from_str(line).map_err(|e| RecordError::malformed(file, i + 1, e.to_string()))
    };
    text.lines().enumerate().map(read).collect()
}
