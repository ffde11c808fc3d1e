//! Folders that the page may open: records of limits, simulations and rolls, alone or in the folder of a sweep.

use crate::api::Listed;
use maille_io::{
    record::{RECORDS, Record, RecordError, SIMULATION, SimulationFiles, open_simulation},
    roll::{ROLL, Roll, RollRecordFile, open_rolls},
    write_design,
};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Where records are written unless a folder is named.
pub const USUAL: &str = "maille-out";
/// File that a record of limits has.
const RUN: &str = "run.json";

/// A design to open.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The name that errors show: a built-in name or a path.
    pub name: String,
    /// The design file, if it is one that may be written again.
    pub file: Option<PathBuf>,
    /// Its text.
    pub text: String,
    /// Values that its parameters begin with, in place of the file's.
    pub parameters: BTreeMap<String, f64>,
    /// A record of it, with its name.
    pub record: Option<(String, Recorded)>,
}

/// What a record holds.
#[derive(Clone, Debug)]
pub enum Recorded {
    /// Limits with their states.
    Limits(Box<Record>),
    /// States of a finite sheet.
    Simulation(Box<SimulationFiles>),
    /// Rolls.
    Rolls(Box<(RollRecordFile, Vec<Roll>)>),
}

impl Opened {
    /// Opens a record, a simulation, rolls, or the first record of a sweep; `name` is what the page shows. None where the folder
    /// holds none of them.
    pub fn folder(name: &str, path: &Path) -> Result<Option<Self>, RecordError> {
        let Some((name, path)) = within(name.to_owned(), path.to_owned()).into_iter().next() else { return Ok(None) };
        let recorded = match holds(&path) {
            Some("limits") => Recorded::Limits(Box::new(Record::read(&path)?)),
            Some("rolls") => Recorded::Rolls(Box::new(open_rolls(&path)?)),
            _ => Recorded::Simulation(Box::new(open_simulation(&path)?)),
        };
        let text = match &recorded {
            Recorded::Limits(record) => write_design(&record.run.design),
            Recorded::Simulation(files) => write_design(&files.record.design),
            Recorded::Rolls(rolls) => write_design(&rolls.0.design),
        };
        Ok(Some(Opened {
            name: name.clone(),
            file: None,
            text,
            parameters: BTreeMap::new(),
            record: Some((name, recorded)),
        }))
    }
}

/// The records in `roots`, each root once, and in the folders within it.
pub fn list(base: &Path, roots: &[String]) -> Vec<Listed> {
    let mut out: Vec<Listed> = Vec::new();
    for root in roots {
        let path = base.join(root);
        let mut found = within(root.clone(), path.clone());
        if found.is_empty() {
            found = folders(root, &path).into_iter().flat_map(|(name, path)| within(name, path)).collect();
        }
        for (name, path) in found {
            let title = holds(&path).unwrap_or_default().to_owned();
            let listed = Listed { name, title };
            if !out.contains(&listed) {
                out.push(listed);
            }
        }
    }
    out
}

/// The record that the folder is, or those of a sweep.
fn within(name: String, path: PathBuf) -> Vec<(String, PathBuf)> {
    if holds(&path).is_some() {
        return vec![(name, path)];
    }
    let records = folders(&slashed(&name, RECORDS), &path.join(RECORDS));
    records.into_iter().filter(|(_, path)| holds(path).is_some()).collect()
}

/// What kind of record the folder is.
fn holds(path: &Path) -> Option<&'static str> {
    let has = |file: &str| path.join(file).is_file();
    match () {
        () if has(RUN) => Some("limits"),
        () if has(ROLL) => Some("rolls"),
        () => has(SIMULATION[0]).then_some("simulation"),
    }
}

/// Folders of a folder, by name.
fn folders(name: &str, path: &Path) -> Vec<(String, PathBuf)> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut out: Vec<_> = entries
        .filter(|path| path.is_dir())
        .filter_map(|path| Some((slashed(name, path.file_name()?.to_str()?), path)))
        .collect();
    out.sort();
    out
}

fn slashed(folder: &str, name: &str) -> String {
    format!("{}/{name}", folder.trim_end_matches('/'))
}
