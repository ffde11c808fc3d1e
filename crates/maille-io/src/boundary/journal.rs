//! The journal of a surface: what it is of, then every ray whose end is known.

use crate::{
    files,
    record::{
        FolderLock, RecordError, input_hash,
        journal::{Journal, line, read},
    },
};
use maille::{
    design::Design,
    lattice::Cell,
    limit::boundary::{BoundaryOptions, BoundaryVertex},
};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::{io::Write, path::Path};

/// Name of the file.
pub const JOURNAL: &str = "boundary.jsonl";

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
    pub fn new(design: &Design, cell: Cell, options: &BoundaryOptions) -> Self {
        let parameters = json!({ "starts": options.starts, "seed": options.seed, "cell": cell.to_string() });
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
        let lock = FolderLock::take(folder)?;
        files::remove_leftovers(folder).map_err(|(path, e)| RecordError::io("remove", path)(e))?;
        let path = folder.join(JOURNAL);
        let malformed = |line, problem: &str| RecordError::malformed(&path.display().to_string(), line, problem);
        let mut lines = if overwrite { Vec::new() } else { read::<Line>(&path)? }.into_iter();
        match lines.next() {
            None if overwrite || !path.exists() => {}
            Some(Line::Head(old)) if old == *head => {}
            Some(Line::Head(old)) => {
                let difference = match old.program_version == head.program_version {
                    true => format!("its inputs have the hash {:.12}…", old.input_hash),
                    false => {
                        format!("it was computed by version {}, not {}", old.program_version, head.program_version)
                    }
                };
                return Err(RecordError::OtherInputs { folder: folder.into(), difference });
            }
            None | Some(Line::Vertex(_)) => return Err(malformed(1, "no head of a surface")),
        }
        let mut known = Vec::new();
        for (number, line) in lines.enumerate() {
            match line {
                Line::Vertex(vertex) => known.push(*vertex),
                Line::Head(_) => return Err(malformed(number + 2, "a second head")),
            }
        }
        // Written anew, so that a line that was cut off does not stay.
        let text: String = known.iter().map(line).collect();
        files::replace(&path, |out| write!(out, "{}{text}", line(head))).map_err(RecordError::io("write", &path))?;
        Ok((SurfaceFolder { journal: Journal::open(&path)?, _lock: lock }, known))
    }

    /// Keeps the ends of rays.
    pub fn keep(&mut self, vertices: &[BoundaryVertex]) -> Result<(), RecordError> {
        self.journal.write(&vertices.iter().map(line).collect::<String>())
    }
}
