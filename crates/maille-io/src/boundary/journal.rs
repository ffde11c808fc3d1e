//! The journal of a surface: what it is of, then every ray whose end is known.

use crate::{
    files,
    record::{
        FolderLock, Mark, RecordError, input_hash,
        journal::{Journal, line, parse, summed},
    },
};
use maille::{
    design::Design,
    survey::surface::{BoundaryOptions, BoundaryVertex},
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{fs, path::Path};

/// Name of the file.
const JOURNAL: &str = "boundary.jsonl";
/// Name of the file that says what a surface is of.
pub const SURFACE: &str = "surface.json";
/// Of both files.
const KEYS: [&str; 2] = ["program_version", "input_hash"];

/// First line of a journal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundaryHead {
    /// Version of the program.
    pub program_version: String,
    /// Hash of design and parameters.
    pub input_hash: String,
    /// Name of the design.
    pub design: String,
}

impl BoundaryHead {
    /// That of a surface of `design`. Tolerance and number of vertices say which rays there are, not where one ends.
    pub fn new(design: &Design, options: &BoundaryOptions) -> Self {
        let parameters = json!({
            "effort": options.effort, "starts": options.starts, "seed": options.seed, "cells": options.cells,
        });
        BoundaryHead {
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
    Head(BoundaryHead),
    Vertex(Box<BoundaryVertex>),
}

/// Reads a journal's bytes; `file` is the name to show in errors. A last line that was cut off is left out.
pub fn read_surface(file: &str, bytes: &[u8]) -> Result<(BoundaryHead, Vec<BoundaryVertex>), RecordError> {
    let malformed = |line, problem: &str| RecordError::malformed(file, line, problem);
    let mut lines = parse::<Line>(file, bytes)?.into_iter();
    let Some(Line::Head(head)) = lines.next() else { return Err(malformed(1, "no head of a surface")) };
    let vertex = |(number, line)| match line {
        Line::Vertex(vertex) => Ok(*vertex),
        Line::Head(_) => Err(malformed(number + 2, "a second head")),
    };
    Ok((head, lines.enumerate().map(vertex).collect::<Result<_, _>>()?))
}

/// A journal as text.
pub fn write_surface(head: &BoundaryHead, vertices: &[BoundaryVertex]) -> String {
    line(head) + &vertices.iter().map(line).collect::<String>()
}

/// The line of a journal for a JSON object: the object with its checksum. None where it does not end as an object.
pub fn surface_line(object: &str) -> Option<String> {
    summed(object)
}

/// The folder of a surface, to which a run adds rays; no other run writes there meanwhile.
#[derive(Debug)]
pub struct SurfaceFolder {
    journal: Journal,
    _lock: FolderLock,
}

impl SurfaceFolder {
    /// Opens or creates the folder for a run with these inputs; gives the rays of an earlier run. One of other inputs is an
    /// error, or replaced with `overwrite`.
    pub fn open(
        folder: &Path,
        head: &BoundaryHead,
        overwrite: bool,
    ) -> Result<(Self, Vec<BoundaryVertex>), RecordError> {
        let lock = FolderLock::take(folder, &[Mark::File(JOURNAL, &KEYS), Mark::File(SURFACE, &KEYS)])?;
        let path = folder.join(JOURNAL);
        let mut known = Vec::new();
        if !overwrite && path.exists() {
            let bytes = fs::read(&path).map_err(RecordError::io("read", &path))?;
            let (old, vertices) = read_surface(&path.display().to_string(), &bytes)?;
            if old != *head {
                let difference = match old.program_version == head.program_version {
                    true => format!("its inputs have the hash {:.12}…", old.input_hash),
                    false => {
                        format!("it was computed by version {}, not {}", old.program_version, head.program_version)
                    }
                };
                return Err(RecordError::OtherInputs { folder: folder.into(), difference });
            }
            known = vertices;
        }
        // Written anew, so that a line that was cut off does not stay.
        let text = write_surface(head, &known);
        files::write(&path, text.as_bytes()).map_err(RecordError::io("write", &path))?;
        Ok((SurfaceFolder { journal: Journal::open(&path)?, _lock: lock }, known))
    }

    /// Keeps the ends of rays.
    pub fn keep(&mut self, vertices: &[BoundaryVertex]) -> Result<(), RecordError> {
        self.journal.write(&vertices.iter().map(line).collect::<String>())
    }
}
