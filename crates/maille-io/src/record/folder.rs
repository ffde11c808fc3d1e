//! The folder of a record, consistent at every moment.
//!
//! A file is written under a temporary name in the same folder and then renamed, so each file is whole at all times. Between
//! files, the order keeps this invariant: **`run.json` names the inputs of every row in `limits.csv`, and a row counts as
//! finished only if `states.jsonl` holds its state.**
//!
//! - A new record: `run.json` first, so that the folder is known as ours before anything else is in it.
//! - A replaced record: `limits.csv` is removed first, then states, derivatives and plots, then `run.json` is replaced. Until that
//!   last step the folder is the old record with fewer rows, never a mixture.
//! - More rows: `run.json` with the new counters and with two checksums for each file, the new one and that of the file which is
//!   there; then `states.jsonl`, then `limits.csv`; then `run.json` with the new checksums alone. A kill in between leaves files
//!   of which each has one of its two, states without rows, which are ignored, and counters that are ahead until the next write.
//! - Each limit as it is found: a line at the end of `limits.journal`, in one write, until all files are written again. A kill
//!   loses the limits in work and no other; a line that is cut off is not read.
//!
//! One run at a time has a folder ([`FolderLock`]). Readers may come at any time.

use super::error::RecordError;
use super::journal::{self, Journal};
use super::limits::{read_limits, write_limits};
use super::lock::{FolderLock, Mark, RUN_MARK, names, some_names};
use super::run::{Counters, RunRecord, read_run, sha256, write_run};
use super::sensitivities::{SensitivityRow, read_sensitivities, write_sensitivities};
use super::states::{read_states, write_states};
use crate::files;
use maille::design::Design;
use maille::record::{LimitRow, StateRecord, Status};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const RUN: &str = "run.json";
const LIMITS: &str = "limits.csv";
const STATES: &str = "states.jsonl";
const SVG: &str = "polar.svg";
const PNG: &str = "polar.png";
const SENSITIVITIES: &str = "sensitivities.csv";
const JOURNAL: &str = "limits.journal";
/// Where `run.json` was damaged the states still show whose the folder is.
const MARKS: [Mark; 2] = [RUN_MARK, Mark::File(STATES, &["direction_deg", "status", "poses"])];

/// A design's name as a file or folder: path separators and other odd characters become underscores.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || ".-_ ".contains(c) { c } else { '_' }).collect()
}

/// Checksums of the files that there may be, by their names.
type Sums = BTreeMap<String, Vec<String>>;

/// What a record's folder holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Inputs and counters.
    pub run: RunRecord,
    /// The rows of `limits.csv`.
    pub rows: Vec<LimitRow>,
    /// The lines of `states.jsonl`.
    pub states: Vec<StateRecord>,
}

impl Record {
    /// Reads a folder. A record that has no table or no states yet has no rows or states.
    pub fn read(folder: &Path) -> Result<Self, RecordError> {
        read_whole(folder, |run| {
            let rows = read_checked(folder, LIMITS, &run, read_limits)?.unwrap_or_default();
            let states = read_checked(folder, STATES, &run, read_states)?.unwrap_or_default();
            Ok(Self { run, rows, states })
        })
    }

    /// The derivatives of a folder's limits, where it has some.
    pub fn read_sensitivities(folder: &Path) -> Result<Option<Vec<SensitivityRow>>, RecordError> {
        read_whole(folder, |run| read_checked(folder, SENSITIVITIES, &run, read_sensitivities))
    }

    /// The rows that need no computing again, each with its state: those with a state and not `interrupted`.
    pub fn finished(self) -> (Vec<LimitRow>, Vec<StateRecord>) {
        let key = |direction: f64, l2: f64, status: Status| (direction.to_bits(), l2.to_bits(), status.name());
        let states = self.states.into_iter();
        let mut states: BTreeMap<_, _> = states.map(|s| (key(s.direction_deg, s.l2, s.status), s)).collect();
        let rows = self.rows.into_iter().filter(|row| row.status != Status::Interrupted);
        rows.filter_map(|row| states.remove(&key(row.direction_deg, row.l2, row.status)).map(|state| (row, state)))
            .unzip()
    }
}

/// A record with the name to show for it where there are several.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedRecord {
    /// The name, as `maille-out/1.1`.
    pub name: String,
    /// The record.
    pub record: Record,
    /// The derivatives of its limits, where it has some.
    pub sensitivities: Vec<SensitivityRow>,
}

/// A folder that a run writes its record to.
#[derive(Debug)]
pub struct RecordFolder {
    path: PathBuf,
    /// Inputs and counters, with the checksums of the files that are there.
    run: RunRecord,
    /// The journal, once something is in it.
    journal: Option<Journal>,
    /// No other run writes here meanwhile.
    _lock: FolderLock,
}

/// One change of the folder that happens wholly or not at all.
#[derive(Debug)]
enum Step {
    Remove(&'static str),
    Write(&'static str, Vec<u8>),
}

impl RecordFolder {
    /// Opens or creates the folder for a run with these inputs; gives the finished rows of an earlier run and their states.
    ///
    /// A missing or empty folder becomes a new record. A record of the same inputs and program version is continued; any
    /// other is an error, or replaced with `overwrite`. A folder with other files and no record is always an error, and so
    /// is one that another run has open.
    pub fn open(
        path: &Path,
        design: &Design,
        parameters: &Value,
        program_version: &str,
        overwrite: bool,
    ) -> Result<(Self, Vec<LimitRow>, Vec<StateRecord>), RecordError> {
        let run = RunRecord::new(design, parameters, program_version);
        let lock = FolderLock::take(path, &MARKS)?;
        let found = names(path)?;
        let mut folder = Self { path: path.to_owned(), run, journal: None, _lock: lock };
        if !found.is_empty() && !overwrite {
            let record = Record::read(path)?;
            folder.same_inputs(&record.run)?;
            for name in [LIMITS, STATES, SENSITIVITIES] {
                if let Some(text) = read_if_there(&path.join(name))? {
                    folder.run.files.insert(name.to_owned(), vec![sha256(text.as_bytes())]);
                }
            }
            let (mut rows, mut states) = record.finished();
            let journal = path.join(JOURNAL);
            if journal.exists() {
                for Limit { row, state } in journal::read::<Limit<LimitRow, StateRecord>>(&journal)? {
                    let known = |r: &LimitRow| (r.direction_deg, r.l2) == (row.direction_deg, row.l2);
                    if row.status != Status::Interrupted && !rows.iter().any(known) {
                        rows.push(row);
                        states.push(state);
                    }
                }
                folder.write(&rows, &states)?;
            }
            folder.run.counters = Counters::of(&rows);
            return Ok((folder, rows, states));
        }
        for step in folder.steps_to_replace() {
            folder.apply(step)?;
        }
        Ok((folder, Vec::new(), Vec::new()))
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Inputs and counters, as last written.
    pub fn run(&self) -> &RunRecord {
        &self.run
    }

    /// Keeps one limit until the next [`Self::write`].
    pub fn append(&mut self, row: &LimitRow, state: &StateRecord) -> Result<(), RecordError> {
        let journal = match &mut self.journal {
            Some(journal) => journal,
            none => none.insert(Journal::open(&self.path.join(JOURNAL))?),
        };
        journal.write(&journal::line(&Limit { row, state }))
    }

    /// Replaces rows and states by all those of the run so far.
    pub fn write(&mut self, rows: &[LimitRow], states: &[StateRecord]) -> Result<(), RecordError> {
        self.run.counters = Counters::of(rows);
        let (steps, files) = self.steps_to_write(rows, states)?;
        for step in steps {
            self.apply(step)?;
        }
        self.run.files = files;
        self.journal = None;
        self.apply(Step::Remove(JOURNAL))
    }

    /// Writes the plot.
    pub fn write_polar(&self, svg: &str, png: &[u8]) -> Result<(), RecordError> {
        self.apply(Step::Write(SVG, svg.into()))?;
        self.apply(Step::Write(PNG, png.into()))
    }

    /// Whether the folder has derivatives of its limits.
    pub fn has_sensitivities(&self) -> bool {
        self.path.join(SENSITIVITIES).is_file()
    }

    /// Writes the derivatives of the limits.
    pub fn write_sensitivities(&mut self, rows: &[SensitivityRow]) -> Result<(), RecordError> {
        let (steps, files) = self.steps_to_change(vec![(SENSITIVITIES, write_sensitivities(rows))]);
        for step in steps {
            self.apply(step)?;
        }
        self.run.files = files;
        Ok(())
    }

    fn steps_to_replace(&self) -> Vec<Step> {
        let mut steps: Vec<_> = [LIMITS, JOURNAL, STATES, SENSITIVITIES, SVG, PNG].map(Step::Remove).into();
        steps.push(Step::Write(RUN, write_run(&self.run).into()));
        steps
    }

    /// The steps, and the checksums of the files after them.
    fn steps_to_write(&self, rows: &[LimitRow], states: &[StateRecord]) -> Result<(Vec<Step>, Sums), RecordError> {
        Ok(self.steps_to_change(vec![(STATES, write_states(states)?), (LIMITS, write_limits(rows)?)]))
    }

    /// The same for these files alone: meanwhile `run.json` has the checksums from before, too.
    fn steps_to_change(&self, texts: Vec<(&'static str, String)>) -> (Vec<Step>, Sums) {
        let (mut both, mut files) = (self.run.files.clone(), self.run.files.clone());
        for (name, text) in &texts {
            let now = sha256(text.as_bytes());
            let sums = both.entry((*name).to_owned()).or_default();
            sums.retain(|before| *before != now);
            sums.insert(0, now.clone());
            files.insert((*name).to_owned(), vec![now]);
        }
        let run =
            |files: &Sums| Step::Write(RUN, write_run(&RunRecord { files: files.clone(), ..self.run.clone() }).into());
        let after = run(&files);
        let writes = texts.into_iter().map(|(name, text)| Step::Write(name, text.into()));
        let steps = std::iter::once(run(&both)).chain(writes).chain([after]).collect();
        (steps, files)
    }

    fn apply(&self, step: Step) -> Result<(), RecordError> {
        match step {
            Step::Remove(name) => {
                let path = self.path.join(name);
                match fs::remove_file(&path) {
                    Err(e) if e.kind() != ErrorKind::NotFound => Err(RecordError::io("remove", path)(e)),
                    _ => Ok(()),
                }
            }
            Step::Write(name, bytes) => {
                let path = self.path.join(name);
                files::write(&path, &bytes).map_err(RecordError::io("write", &path))
            }
        }
    }

    fn same_inputs(&self, old: &RunRecord) -> Result<(), RecordError> {
        let (a, b) = (&old.program_version, &self.run.program_version);
        let difference = if a != b {
            format!("computed by version {a}, this is {b}")
        } else if old.input_hash != self.run.input_hash {
            difference(old, &self.run)
        } else {
            return Ok(());
        };
        Err(RecordError::OtherInputs { folder: self.path.clone(), difference })
    }
}

/// The first fields in which the inputs of two runs differ.
fn difference(old: &RunRecord, new: &RunRecord) -> String {
    let json = |run: &RunRecord| serde_json::json!({ "design": run.design, "parameters": run.parameters });
    let mut out = Vec::new();
    differences(&json(old), &json(new), String::new(), &mut out);
    let more = out.len().saturating_sub(3);
    out.truncate(3);
    match (out.is_empty(), more) {
        (true, _) => "its input hash differs".to_owned(),
        (false, 0) => out.join("; "),
        (false, more) => format!("{}; {more} more", out.join("; ")),
    }
}

fn differences(old: &Value, new: &Value, path: String, out: &mut Vec<String>) {
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            let mut keys: Vec<_> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            for key in keys {
                let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                differences(a.get(key).unwrap_or(&Value::Null), b.get(key).unwrap_or(&Value::Null), path, out);
            }
        }
        (a, b) if a == b => {}
        (a, b) => out.push(format!("{path} is {} there, {} here", short(a), short(b))),
    }
}

fn short(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(40) {
        Some((cut, _)) => format!("{}…", &text[..cut]),
        None => text,
    }
}

/// What `read` gives with `run.json`, with which the files that it reads fit together.
fn read_whole<T>(folder: &Path, read: impl Fn(RunRecord) -> Result<T, RecordError>) -> Result<T, RecordError> {
    let path = folder.join(RUN);
    let Some(mut text) = read_if_there(&path)? else {
        return Err(RecordError::NotARecord { folder: folder.into(), found: some_names(&names(folder)?) });
    };
    loop {
        let found = read_run(&path.display().to_string(), &text).and_then(&read);
        if !matches!(found, Err(RecordError::Edited { .. })) {
            return found;
        }
        // A run may have written between the files: then run.json is another one now.
        match read_if_there(&path)? {
            Some(now) if now != text => text = now,
            _ => return found,
        }
    }
}

/// The content of a file of the record, if there is one and it is the one that was written. What cannot be read at all is told with its line.
fn read_checked<T>(
    folder: &Path,
    name: &'static str,
    run: &RunRecord,
    read: impl Fn(&str, &str) -> Result<Vec<T>, RecordError>,
) -> Result<Option<Vec<T>>, RecordError> {
    let path = folder.join(name);
    let file = path.display().to_string();
    let Some(text) = read_if_there(&path)? else { return Ok(None) };
    let content = read(&file, &text)?;
    let found = sha256(text.as_bytes());
    match run.files.get(name).map(Vec::as_slice) {
        Some(sums @ [expected, ..]) if !sums.contains(&found) => {
            Err(RecordError::Edited { file, found, expected: expected.clone(), by: RUN })
        }
        _ => Ok(Some(content)),
    }
}

fn read_if_there(path: &Path) -> Result<Option<String>, RecordError> {
    match fs::read_to_string(path) {
        Ok(text) => Ok(Some(text)),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(None),
        Err(e) => Err(RecordError::io("read", path)(e)),
    }
}

/// A line of the journal.
#[derive(Serialize, Deserialize)]
struct Limit<R, S> {
    row: R,
    state: S,
}

#[cfg(test)]
mod tests;
