//! Rolls as a folder: `rolls.csv` is the table, `rolls.jsonl` has a line with the state and the contacts for each of its rows, `rolls.json`
//! says what they are of, and `rolls-found.jsonl` is the journal from which an interrupted run goes on: there limits stand as they were found, and
//! a later line of the same question takes the place of an earlier one.

use crate::{
    files,
    record::{
        FolderLock, RecordError, csv_number, csv_text, input_hash,
        journal::{Journal, line, parse},
        sha256,
    },
};
use maille::{
    design::Design,
    lattice::Across,
    survey::roll::{RollLimit, RollQuestion},
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{collections::BTreeMap, fmt::Write, fs, path::Path};

/// Name of the file that says what the rolls are of.
pub const ROLLS: &str = "rolls.json";
/// Name of the table.
pub const ROLL_TABLE: &str = "rolls.csv";
/// Name of the file of states.
pub const ROLL_STATES: &str = "rolls.jsonl";
const JOURNAL: &str = "rolls-found.jsonl";
const SCHEMA: u32 = 1;

/// First line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    program_version: String,
    input_hash: String,
    design: String,
}

impl Head {
    /// Directions and widths say which limits there are, not where one is.
    fn new(design: &Design, question: &RollQuestion) -> Self {
        let parameters = json!({
            "effort": question.effort, "starts": question.starts, "seed": question.seed, "cells": question.cells,
        });
        Head {
            program_version: env!("CARGO_PKG_VERSION").into(),
            input_hash: input_hash(design, &parameters),
            design: design.name.clone(),
        }
    }
}

/// A line of the journal.
#[derive(Deserialize)]
#[serde(untagged)]
enum Line {
    Head(Head),
    Limit(Box<RollLimit>),
}

/// What rolls are of.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct RollsRecord {
    /// Version of this file.
    pub schema: u32,
    /// Version of the program.
    pub program_version: String,
    /// Hash of the design and of the parameters that decide where a limit is.
    pub input_hash: String,
    /// The design as computed.
    pub design: Design,
    /// What was asked.
    pub parameters: RollQuestion,
    /// Whether all of it was answered.
    pub complete: bool,
    /// SHA-256 of the states and of the table.
    pub files: BTreeMap<String, String>,
}

/// The folder of rolls, to which a run adds limits; no other run writes there meanwhile.
#[derive(Debug)]
pub struct RollFolder {
    journal: Journal,
    head: Head,
    _lock: FolderLock,
}

impl RollFolder {
    /// Opens or creates the folder for a run with these inputs; gives the limits of an earlier run. One of other inputs is an error,
    /// or replaced with `overwrite`.
    ///
    /// # Errors
    /// Where the folder cannot be read or written, is in use, or has rolls of other inputs.
    pub fn open(
        folder: &Path,
        design: &Design,
        question: &RollQuestion,
        overwrite: bool,
    ) -> Result<(Self, Vec<RollLimit>), RecordError> {
        let lock = FolderLock::take(folder)?;
        let (path, head) = (folder.join(JOURNAL), Head::new(design, question));
        let mut known = Vec::new();
        if !overwrite && path.exists() {
            let file = path.display().to_string();
            let bytes = fs::read(&path).map_err(RecordError::io("read", &path))?;
            let mut lines = parse::<Line>(&file, &bytes)?.into_iter();
            let Some(Line::Head(old)) = lines.next() else {
                return Err(RecordError::malformed(&file, 1, "no head of rolls"));
            };
            if old != head {
                let difference = match old.program_version == head.program_version {
                    true => format!("its inputs have the hash {:.12}…", old.input_hash),
                    false => {
                        format!("it was computed by version {}, not {}", old.program_version, head.program_version)
                    }
                };
                return Err(RecordError::OtherInputs { folder: folder.into(), difference });
            }
            let limit = |(number, line)| match line {
                Line::Limit(limit) => Ok(*limit),
                Line::Head(_) => Err(RecordError::malformed(&file, number + 2, "a second head")),
            };
            known = lines.enumerate().map(limit).collect::<Result<_, _>>()?;
        }
        // Written anew, so that a line that was cut off does not stay.
        let text = line(&head) + &known.iter().map(line).collect::<String>();
        files::write(&path, text.as_bytes()).map_err(RecordError::io("write", &path))?;
        Ok((RollFolder { journal: Journal::open(&path)?, head, _lock: lock }, known))
    }

    /// Keeps a limit.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep(&mut self, limit: &RollLimit) -> Result<(), RecordError> {
        self.journal.write(&line(limit))
    }

    /// What the rolls are of; `table` and `states` are the files as written.
    pub fn record(
        &self,
        design: &Design,
        question: &RollQuestion,
        complete: bool,
        [table, states]: [&str; 2],
    ) -> RollsRecord {
        let Head { program_version, input_hash, .. } = self.head.clone();
        let hash = |text: &str| sha256(text.as_bytes());
        RollsRecord {
            schema: SCHEMA,
            program_version,
            input_hash,
            design: design.clone(),
            parameters: question.clone(),
            complete,
            files: [(ROLL_TABLE.to_owned(), hash(table)), (ROLL_STATES.to_owned(), hash(states))].into(),
        }
    }
}

/// The states of rolls, a line each.
pub fn roll_states(limits: &[RollLimit]) -> String {
    let line = |limit: &RollLimit| serde_json::to_string(limit).expect("a limit is an object") + "\n";
    limits.iter().map(line).collect()
}

/// `held`, `free`, or what of it is.
pub fn width_word(free: Across) -> &'static str {
    match (free.lateral_free, free.shear_free) {
        (false, false) => "held",
        (true, true) => "free",
        (true, false) => "width-free",
        (false, true) => "shear-free",
    }
}

const COLUMNS: &str = "direction_deg,end,width,status,curvature,curvature_uncertified,bend_radius,neutral_radius,neutral_stretch,\
l2,shear,cell,min_gap,dual_residual,complementarity,min_multiplier,min_curvature,zero_modes,links_ok,n_starts,n_distinct,\
continued,iterations,wall_s";

/// The table: a line a limit. Curvatures are in 1/unit, `bend_radius` and `neutral_radius` in reference radii.
pub fn rolls_csv(limits: &[RollLimit]) -> String {
    let mut out = format!("{COLUMNS}\n");
    for limit in limits {
        let whole = |x: Option<u64>| x.map_or(String::new(), |x| x.to_string());
        let links = limit.links_ok.map_or(String::new(), |ok| ok.to_string());
        let numbers = [
            limit.curvature,
            limit.curvature_uncertified,
            limit.bend_radius,
            limit.neutral_radius,
            limit.neutral_stretch,
            limit.l2,
            limit.shear,
        ]
        .map(csv_number)
        .join(",");
        let certificate =
            [limit.min_gap, limit.dual_residual, limit.complementarity, limit.min_multiplier, limit.min_curvature]
                .map(csv_number)
                .join(",");
        let _ = writeln!(
            out,
            "{:?},{},{},{},{numbers},{},{certificate},{},{links},{},{},{},{},{:?}",
            limit.direction_deg,
            limit.sense.name(),
            width_word(limit.free),
            limit.status.name(),
            csv_text(&limit.cell.to_string()),
            whole(limit.zero_modes),
            limit.n_starts,
            limit.n_distinct,
            limit.continued,
            limit.iterations,
            limit.wall_s,
        );
    }
    out
}

/// Reads a folder of `maille roll`, and checks that its files are those that were written.
///
/// # Errors
/// Where a file is missing, damaged, or was edited.
pub fn open_rolls(folder: &Path) -> Result<(RollsRecord, Vec<RollLimit>), RecordError> {
    let read = |name: &str| {
        let path = folder.join(name);
        fs::read(&path).map(|bytes| (path.display().to_string(), bytes)).map_err(RecordError::io("read", &path))
    };
    let (file, bytes) = read(ROLLS)?;
    let record: RollsRecord =
        serde_json::from_slice(&bytes).map_err(|e| RecordError::json(&file, e.line().max(1), &e))?;
    if record.schema != SCHEMA {
        let problem = format!("schema {}; this program reads schema {SCHEMA}", record.schema);
        return Err(RecordError::malformed(&file, 1, problem));
    }
    let whole = |name: &str| {
        let (file, bytes) = read(name)?;
        let (found, expected) = (sha256(&bytes), record.files.get(name).cloned().unwrap_or_default());
        match found == expected {
            true => Ok((file, bytes)),
            false => Err(RecordError::Edited { file, found, expected, by: ROLLS }),
        }
    };
    whole(ROLL_TABLE)?;
    let (file, states) = whole(ROLL_STATES)?;
    let text = String::from_utf8_lossy(&states);
    let limit = |(k, line): (usize, &str)| serde_json::from_str(line).map_err(|e| RecordError::json(&file, k + 1, &e));
    let limits = text.lines().enumerate().map(limit).collect::<Result<_, _>>()?;
    Ok((record, limits))
}
