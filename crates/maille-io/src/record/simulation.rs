//! `simulation.json`, `frames.jsonl` and `forces.csv`: what a simulated sheet leaves behind.
//!
//! Their folder is never a mixture: `simulation.json` is removed first and written last, and has the checksums of all three.
//!
//! While a run is not done its steps are in `steps.jsonl`, and the same run goes on from them.

use super::{
    error::{RecordError, complete},
    forces::{ForceTable, read_forces, write_forces},
    journal::{Journal, JournalHead, line},
    lock::{FolderLock, Mark},
    plan::SheetPlan,
    run::sha256,
};
use crate::{files, tile::Tile};
use maille::{
    design::Design,
    model::Model,
    record::FrameRecord,
    relaxation::simulate::{End, Simulation, Step},
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{
    fs,
    io::ErrorKind,
    path::{Path, PathBuf},
};

/// Names of the files of the record; the last one only where the frames are states at rest.
pub const SIMULATION: [&str; 3] = ["simulation.json", "frames.jsonl", "forces.csv"];
/// Name of the file with the steps of a run that is not done.
const STEPS: &str = "steps.jsonl";
/// A run that is killed leaves steps alone, or while it writes frames.
const MARKS: [Mark; 3] = [
    Mark::File(STEPS, &JournalHead::KEYS),
    Mark::File(SIMULATION[0], &["schema", "version", "outcome"]),
    Mark::File(SIMULATION[1], &["share", "energy", "poses"]),
];

/// What was done to a finite sheet, and what came out.
///
/// A key that it has not is refused: a checksum with a wrong name would be none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SimulationRecord {
    /// Version of the format, 1.
    pub schema: u32,
    /// Version of the program.
    pub version: String,
    /// The design, with the minor radius that was used.
    pub design: Design,
    /// Cells along a1 and a2, as `10x10`.
    pub tile: String,
    /// What was done to it.
    pub setup: SheetPlan,
    /// What came out.
    pub outcome: SimulationOutcome,
    /// SHA-256, in hexadecimal, of `forces.csv`, where there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub forces_sha256: Option<String>,
    /// SHA-256, in hexadecimal, of this document without this field, on one line, with `frames.jsonl` behind it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sha256: Option<String>,
}

impl SimulationRecord {
    /// What came of a plan for `tile` of `design`, compiled as `model`.
    pub fn new(design: &Design, tile: Tile, plan: SheetPlan, model: &Model, end: &Simulation) -> Self {
        SimulationRecord {
            schema: 1,
            version: env!("CARGO_PKG_VERSION").into(),
            design: design.clone(),
            tile: tile.to_string(),
            setup: plan,
            outcome: SimulationOutcome {
                end: end.end,
                share: end.share,
                smallest_gap: end.smallest_gap.map(|gap| gap * model.unit),
                links_ok: end.links_ok,
                iterations: end.iterations,
                kicks: end.kicks,
                unbalanced: end.unbalanced,
                note: end.note.clone(),
            },
            forces_sha256: None,
            sha256: None,
        }
    }

    /// With the checksums of its table, and of itself and its frames.
    pub fn sealed(mut self, frames: &[FrameRecord], forces: Option<&ForceTable>) -> Self {
        self.forces_sha256 = forces.map(|table| sha256(write_forces(table).as_bytes()));
        self.with_checksum(&write_frames(frames))
    }

    fn with_checksum(mut self, frames: &str) -> Self {
        self.sha256 = None;
        let text = serde_json::to_string(&self).expect("no map with odd keys") + "\n" + frames;
        self.sha256 = Some(sha256(text.as_bytes()));
        self
    }
}

/// A simulation as its folder holds it.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationFiles {
    /// `simulation.json`.
    pub record: SimulationRecord,
    /// `frames.jsonl`.
    pub frames: Vec<FrameRecord>,
    /// `forces.csv`; none where the frames are not at rest, or are of an earlier version.
    pub forces: Option<ForceTable>,
}

/// The folder that a simulation is written to; no other run writes there meanwhile.
#[derive(Debug)]
pub struct SimulationFolder {
    path: PathBuf,
    _lock: FolderLock,
}

impl SimulationFolder {
    /// Opens the folder, which is created if it is not there.
    ///
    /// # Errors
    /// Where it holds other files and no simulation, or another run has it.
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        Ok(SimulationFolder { path: path.to_owned(), _lock: FolderLock::take(path, &MARKS)? })
    }

    /// Opens the steps of a run of this design and plan, with those of an earlier one that was not done; with `overwrite` it
    /// begins anew. `all_frames`: every accepted state is kept as well.
    ///
    /// # Errors
    /// Where there are steps of another run, or files cannot be read or written.
    pub fn steps(
        &self,
        design: &Design,
        tile: Tile,
        plan: &SheetPlan,
        all_frames: bool,
        overwrite: bool,
    ) -> Result<(StepJournal, Vec<KeptStep>), RecordError> {
        let parameters = json!({ "tile": tile.to_string(), "setup": plan, "all_frames": all_frames });
        let head = JournalHead::new(design, &parameters);
        let (journal, known) = Journal::of_run(&self.path, STEPS, &head, overwrite)?;
        Ok((StepJournal(journal), known))
    }

    /// Whether there are steps of a run that was not done.
    pub fn has_steps(&self) -> bool {
        self.path.join(STEPS).exists()
    }

    /// Removes the steps of a run, if there are any: it is done, or another takes its place. Their journal must be closed.
    ///
    /// # Errors
    /// Where they cannot be removed.
    pub fn forget_steps(&self) -> Result<(), RecordError> {
        let path = self.path.join(STEPS);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != ErrorKind::NotFound => Err(RecordError::io("remove", &path)(e)),
            _ => Ok(()),
        }
    }

    /// Writes a simulation in place of one that is there.
    ///
    /// # Errors
    /// Where a file cannot be written.
    pub fn save(
        &self,
        record: SimulationRecord,
        frames: &[FrameRecord],
        forces: Option<&ForceTable>,
    ) -> Result<(), RecordError> {
        let [first, second, third] = SIMULATION.map(|name| self.path.join(name));
        // A table of an earlier simulation is none of this one.
        for path in [&first, &third].into_iter().filter(|path| path.exists()) {
            fs::remove_file(path).map_err(RecordError::io("remove", path))?;
        }
        let texts = [
            Some((second, write_frames(frames))),
            forces.map(|table| (third, write_forces(table))),
            Some((first, write_simulation(&record.sealed(frames, forces)))),
        ];
        for (path, text) in texts.into_iter().flatten() {
            files::write(&path, text.as_bytes()).map_err(RecordError::io("write", &path))?;
        }
        Ok(())
    }
}

/// A step of a run that is not done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeptStep {
    /// The step.
    pub step: Step,
    /// Where they are asked for: the states that its minimisations accepted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<FrameRecord>,
}

/// The steps of a run, as they are found.
#[derive(Debug)]
pub struct StepJournal(Journal);

impl StepJournal {
    /// Keeps a step.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep(&mut self, step: &KeptStep) -> Result<(), RecordError> {
        self.0.write(&line(step))
    }
}

/// Reads a simulation from its folder.
pub fn open_simulation(folder: &Path) -> Result<SimulationFiles, RecordError> {
    let [first, second, third] = SIMULATION.map(|name| folder.join(name));
    let read = |path: &Path| {
        let text = fs::read_to_string(path).map_err(RecordError::io("read", path))?;
        Ok::<_, RecordError>((path.display().to_string(), text))
    };
    let ((file, text), (frames_file, lines)) = (read(&first)?, read(&second)?);
    let record = read_simulation(&file, &text)?;
    let frames = read_frames(&frames_file, &lines)?;
    let by = SIMULATION[0];
    if let Some(expected) = record.sha256.clone() {
        let found = record.clone().with_checksum(&lines).sha256.unwrap_or_default();
        if found != expected {
            return Err(RecordError::Edited { file: format!("{file} or {frames_file}"), found, expected, by });
        }
        // A last digit may change and its number not.
        let (found, expected) = (sha256(text.as_bytes()), sha256(write_simulation(&record).as_bytes()));
        if found != expected {
            return Err(RecordError::Edited { file, found, expected, by });
        }
    }
    let mut forces = None;
    if let Some(expected) = record.forces_sha256.clone() {
        let (file, table) = read(&third)?;
        let found = sha256(table.as_bytes());
        if found != expected {
            return Err(RecordError::Edited { file, found, expected, by });
        }
        forces = Some(read_forces(&file, &table)?);
    }
    Ok(SimulationFiles { record, frames, forces })
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
