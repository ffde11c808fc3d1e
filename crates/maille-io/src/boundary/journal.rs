//! The journal of a surface: what it is of, then every ray whose end is known.

use crate::record::{
    FolderLock, JournalHead, Mark, RecordError,
    journal::{Journal, line, parse_run, summed, write_run},
};
use maille::{
    design::Design,
    survey::surface::{BoundaryOptions, BoundaryVertex},
};
use serde_json::json;
use std::path::Path;

/// Name of the file.
const JOURNAL: &str = "boundary.jsonl";
/// Name of the file that says what a surface is of.
pub const SURFACE: &str = "surface.json";

/// First line of the journal of a surface of `design`. Tolerance and number of vertices say which rays there are, not where one ends.
pub fn surface_head(design: &Design, options: &BoundaryOptions) -> JournalHead {
    let BoundaryOptions { effort, starts, seed, cells, .. } = options;
    JournalHead::new(design, &json!({ "effort": effort, "starts": starts, "seed": seed, "cells": cells }))
}

/// Reads a journal's bytes; `file` is the name to show in errors. A last line that was cut off is left out.
pub fn read_surface(file: &str, bytes: &[u8]) -> Result<(JournalHead, Vec<BoundaryVertex>), RecordError> {
    parse_run(file, bytes, None)
}

/// A journal as text.
pub fn write_surface(head: &JournalHead, vertices: &[BoundaryVertex]) -> String {
    write_run(head, vertices)
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
        head: &JournalHead,
        overwrite: bool,
    ) -> Result<(Self, Vec<BoundaryVertex>), RecordError> {
        let lock = FolderLock::take(
            folder,
            &[Mark::File(JOURNAL, &JournalHead::KEYS), Mark::File(SURFACE, &JournalHead::KEYS)],
        )?;
        let (journal, known) = Journal::of_run(folder, JOURNAL, head, overwrite)?;
        Ok((SurfaceFolder { journal, _lock: lock }, known))
    }

    /// Keeps the ends of rays.
    pub fn keep(&mut self, vertices: &[BoundaryVertex]) -> Result<(), RecordError> {
        self.journal.write(&vertices.iter().map(line).collect::<String>())
    }
}
