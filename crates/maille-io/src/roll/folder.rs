//! The folder of a design's rolls.

use super::{Kind, Roll, RollKey, RollQuestion, rolls_csv};
use crate::{
    files,
    record::{
        FolderLock, JournalHead, Mark, RecordError,
        journal::{Journal, line, parse_run, write_run},
        sha256,
    },
};
use maille::design::Design;
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{collections::BTreeMap, fs, path::Path};

/// Name of the file that says what the rolls are of.
pub const ROLL: &str = "roll.json";
/// Name of the file with all rolls and their states.
pub const ROLLS: &str = "rolls.jsonl";
/// Name of the table.
pub const ROLLS_TABLE: &str = "rolls.csv";
const SCHEMA: u32 = 1;

/// `roll.json`: what the rolls of a folder are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RollRecordFile {
    /// Version of this file.
    pub schema: u32,
    /// Version of the program.
    pub program_version: String,
    /// Hash of the design and of what decides where a roll ends.
    pub input_hash: String,
    /// The design as computed.
    pub design: Design,
    /// What was asked.
    pub question: RollQuestion,
    /// Whether all rolls were searched.
    pub complete: bool,
    /// SHA-256 of the table and of the states.
    pub files: BTreeMap<String, String>,
}

/// First line of `rolls.jsonl`. Which directions, sides, cells and curvatures are asked does not decide where a roll ends.
fn head(design: &Design, question: &RollQuestion) -> JournalHead {
    let RollQuestion { cells, effort, seed, .. } = question;
    let (strains, kind) = (question.strains(), question.kind());
    let tubes = kind == Kind::Tubes;
    let mut parameters =
        json!({ "tubes": tubes, "free": strains.free, "cells": cells, "effort": effort, "seed": seed });
    if kind == Kind::AtCurvature {
        parameters["at_curvature"] = true.into();
    }
    if (strains.l2, strains.shear) != (0.0, 0.0) {
        (parameters["l2"], parameters["gamma"]) = (strains.l2.into(), strains.shear.into());
    }
    JournalHead::new(design, &parameters)
}

/// The folder that a run writes to; no other run does meanwhile.
#[derive(Debug)]
pub struct RollFolder<'a> {
    folder: &'a Path,
    journal: Journal,
    _lock: FolderLock,
}

impl<'a> RollFolder<'a> {
    /// Opens or creates the folder; gives the rolls of an earlier run with these inputs.
    ///
    /// # Errors
    /// Where it holds rolls of other inputs and is not to be overwritten, or cannot be read or written.
    pub fn open(
        folder: &'a Path,
        design: &Design,
        question: &RollQuestion,
        overwrite: bool,
    ) -> Result<(Self, Vec<Roll>), RecordError> {
        let lock =
            FolderLock::take(folder, &[Mark::File(ROLL, &JournalHead::KEYS), Mark::File(ROLLS, &JournalHead::KEYS)])?;
        let (journal, mut known) = Journal::of_run::<Roll>(folder, ROLLS, &head(design, question), overwrite)?;
        // Of two lines of a roll the later one went further.
        known.reverse();
        in_order(&mut known);
        known.dedup_by_key(|roll| roll.key());
        Ok((RollFolder { folder, journal, _lock: lock }, known))
    }

    /// Keeps a roll.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep(&mut self, roll: &Roll) -> Result<(), RecordError> {
        self.journal.write(&line(roll))
    }

    /// Writes the table of the folder's rolls and what they are of.
    ///
    /// # Errors
    /// Where one cannot be written.
    pub fn finish(&self, design: &Design, question: &RollQuestion, rolls: &[Roll]) -> Result<(), RecordError> {
        let table = rolls_csv(rolls);
        let write = |name: &str, bytes: &[u8]| {
            let path = self.folder.join(name);
            files::write(&path, bytes).map_err(RecordError::io("write", &path))
        };
        write(ROLLS_TABLE, table.as_bytes())?;
        let head = head(design, question);
        // Without the lines of rolls that went further.
        let states = write_run(&head, rolls);
        write(ROLLS, states.as_bytes())?;
        let JournalHead { program_version, input_hash, .. } = head;
        let known = |asked: &RollKey| rolls.iter().any(|roll| roll.key() == *asked);
        let record = RollRecordFile {
            schema: SCHEMA,
            program_version,
            input_hash,
            design: design.clone(),
            question: question.clone(),
            complete: question.rolls().iter().all(known),
            files: [(ROLLS_TABLE.to_owned(), sha256(table.as_bytes())), (ROLLS.to_owned(), sha256(states.as_bytes()))]
                .into(),
        };
        let text = serde_json::to_string_pretty(&record).expect("no map with odd keys") + "\n";
        write(ROLL, text.as_bytes())
    }
}

/// Reads a folder of rolls, and checks that its files are those that were written.
///
/// # Errors
/// Where a file is missing, malformed or edited.
pub fn open_rolls(folder: &Path) -> Result<(RollRecordFile, Vec<Roll>), RecordError> {
    let path = folder.join(ROLL);
    let text = fs::read_to_string(&path).map_err(RecordError::io("read", &path))?;
    let file = path.display().to_string();
    let record: RollRecordFile =
        serde_json::from_str(&text).map_err(|e| RecordError::json(&file, e.line().max(1), &e))?;
    if record.schema != SCHEMA {
        let problem = format!("schema {}; this program reads schema {SCHEMA}", record.schema);
        return Err(RecordError::malformed(&file, 1, problem));
    }
    for name in [ROLLS_TABLE, ROLLS] {
        let path = folder.join(name);
        let bytes = fs::read(&path).map_err(RecordError::io("read", &path))?;
        let (found, expected) = (sha256(&bytes), record.files.get(name).cloned().unwrap_or_default());
        if found != expected {
            let file = path.display().to_string();
            return Err(RecordError::Edited { file, found, expected, by: ROLL });
        }
    }
    let path = folder.join(ROLLS);
    let bytes = fs::read(&path).map_err(RecordError::io("read", &path))?;
    let (_, mut rolls) = parse_run(&path.display().to_string(), &bytes, None)?;
    in_order(&mut rolls);
    Ok((record, rolls))
}

/// By direction, the axis below first; then by cells or given curvature, and by what is sought: the order of the table.
pub fn in_order(rolls: &mut [Roll]) {
    let given = |roll: &Roll| roll.at_curvature.unwrap_or(0.0);
    rolls.sort_by(|a, b| {
        let turn = || (a.axis, a.wrap).cmp(&(b.axis, b.wrap)).then(given(a).total_cmp(&given(b)));
        a.direction_deg.total_cmp(&b.direction_deg).then_with(turn).then(a.sought.cmp(&b.sought))
    });
}
