//! What can be wrong with a record.

use miette::Diagnostic;
use std::{fmt, path::PathBuf};
use thiserror::Error;

/// A record that cannot be read, written or continued.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The file system refused.
    #[error("cannot {action} {}", path.display())]
    Io {
        /// What was tried: `read`, `write`, `create`, `remove`, `lock`.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// Why not.
        source: std::io::Error,
    },
    /// A file of the record does not hold what it should.
    #[error("{file}:{line}: {problem}")]
    Malformed {
        /// Path or name of the file.
        file: String,
        /// Line, from 1.
        line: u64,
        /// Column and value, and what was expected.
        problem: String,
    },
    /// A file of the record is not the one that was written.
    #[error("{file} was edited or cut off: its SHA-256 is {found}, {by} has {expected}")]
    Edited {
        /// Path of the file.
        file: String,
        /// What it is.
        found: String,
        /// What was written.
        expected: String,
        /// Name of the file that says so.
        by: &'static str,
    },
    /// The folder holds the record of another computation.
    #[error("{} holds a record of other inputs: {difference}", folder.display())]
    OtherInputs {
        /// The folder.
        folder: PathBuf,
        /// The first fields that differ, with both values.
        difference: String,
    },
    /// The folder holds files, but no record.
    #[error("{} is not empty and holds no record that this command continues (found {found})", folder.display())]
    NotARecord {
        /// The folder.
        folder: PathBuf,
        /// Some names in it.
        found: String,
    },
    /// Another run writes to the folder.
    #[error("another run is writing to {}", folder.display())]
    InUse {
        /// The folder.
        folder: PathBuf,
    },
    /// A number that JSON and the table's readers cannot hold.
    #[error("direction {direction_deg}°, l2 {l2}: {field} is {value}")]
    NotFinite {
        /// Direction of the row.
        direction_deg: f64,
        /// l2 of the row.
        l2: f64,
        /// Field of the row or the state.
        field: &'static str,
        /// The number.
        value: f64,
    },
}

impl Diagnostic for RecordError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        let help =
            "a record holds finite numbers only, and nothing where a number could not be computed; please report this";
        matches!(self, Self::NotFinite { .. }).then(|| Box::new(help) as _)
    }
}

impl RecordError {
    pub(crate) fn io(action: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::Io { action, path, source }
    }

    pub(crate) fn malformed(file: &str, line: usize, problem: impl Into<String>) -> Self {
        Self::Malformed { file: file.to_owned(), line: line as u64, problem: problem.into() }
    }

    /// What is wrong with JSON that ends in this line of the file.
    pub(crate) fn json(file: &str, line: usize, error: &serde_json::Error) -> Self {
        let reason = error.to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        Self::malformed(file, line, format!("{reason} (character {})", error.column()))
    }
}

/// A text file of the record ends with a newline; otherwise its last line may have lost its end.
pub(super) fn complete(file: &str, text: &str) -> Result<(), RecordError> {
    if text.is_empty() || text.ends_with('\n') {
        return Ok(());
    }
    Err(RecordError::malformed(file, text.matches('\n').count() + 1, "the file ends within this line"))
}
