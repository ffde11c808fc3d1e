//! Journals: files that only grow, a JSON object with its own checksum in each line, in one write each.
//!
//! A line is the object with one more field at its end, `"sum"`: the first 16 digits of the SHA-256 of the object without it. A
//! kill cuts the last line off, which is then left out. Any other line without the right sum was edited or damaged: an error, not
//! a gap.
//!
//! The first line of a journal of a run says of which run its items are: see [`JournalHead`].

use super::{
    error::RecordError,
    run::{input_hash, sha256},
};
use crate::files;
use maille::design::Design;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::Value;
use std::{
    fs,
    io::{self, ErrorKind, Write},
    path::{Path, PathBuf},
};

const SUM: &str = ",\"sum\":\"";
const DIGITS: usize = 16;

/// The line of `item`, which is written as a JSON object of one field or more.
pub(crate) fn line(item: &impl Serialize) -> String {
    summed(&serde_json::to_string(item).expect("no map with odd keys")).expect("an object")
}

/// The line of a JSON object, if it ends as one.
pub(crate) fn summed(object: &str) -> Option<String> {
    let open = object.strip_suffix('}')?;
    Some(format!("{open}{SUM}{}\"}}\n", &sha256(object.as_bytes())[..DIGITS]))
}

/// The object of a line, if it is the one that was written.
fn object(line: &str) -> Option<String> {
    let (open, sum) = line.rsplit_once(SUM)?;
    let object = format!("{open}}}");
    (sha256(object.as_bytes())[..DIGITS] == *sum.strip_suffix("\"}")?).then_some(object)
}

/// The items of a journal, but for a last line that was cut off; none where there is no file.
pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>, RecordError> {
    match fs::read(path) {
        Ok(bytes) => parse(&path.display().to_string(), &bytes),
        Err(e) if e.kind() == ErrorKind::NotFound => Ok(Vec::new()),
        Err(e) => Err(RecordError::io("read", path)(e)),
    }
}

/// The same of the file's bytes; `file` is the name to show in errors.
pub(crate) fn parse<T: DeserializeOwned>(file: &str, bytes: &[u8]) -> Result<Vec<T>, RecordError> {
    // A line may be cut within a letter.
    let text = String::from_utf8_lossy(bytes);
    let whole = text.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n'));
    let read = |(number, line): (usize, &str)| {
        let malformed = |problem: String| RecordError::malformed(file, number + 1, problem);
        let object = object(line).ok_or_else(|| malformed("the checksum of this line does not fit".into()))?;
        serde_json::from_str(&object).map_err(|e| malformed(e.to_string()))
    };
    whole.enumerate().map(read).collect()
}

/// First line of the journal of a run: what its items are of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JournalHead {
    /// Version of the program.
    pub program_version: String,
    /// Hash of the design and of what decides what an item is.
    pub input_hash: String,
    /// Name of the design.
    pub design: String,
}

impl JournalHead {
    /// Keys by which a journal is known.
    pub(crate) const KEYS: [&str; 2] = ["program_version", "input_hash"];

    pub(crate) fn new(design: &Design, parameters: &Value) -> Self {
        JournalHead {
            program_version: env!("CARGO_PKG_VERSION").into(),
            input_hash: input_hash(design, parameters),
            design: design.name.clone(),
        }
    }

    fn difference(&self, other: &JournalHead) -> String {
        match self.program_version == other.program_version {
            true => format!("its inputs have the hash {:.12}…", self.input_hash),
            false => format!("it was computed by version {}, not {}", self.program_version, other.program_version),
        }
    }
}

/// The first line and the items of a journal's bytes. Of another run than `wanted` the first line alone is read: its items may have
/// other keys. `file` is the name to show in errors.
pub(crate) fn parse_run<T: DeserializeOwned>(
    file: &str,
    bytes: &[u8],
    wanted: Option<&JournalHead>,
) -> Result<(JournalHead, Vec<T>), RecordError> {
    let malformed = |line: usize, e: serde_json::Error| RecordError::malformed(file, line, e.to_string());
    let mut lines = parse::<Value>(file, bytes)?.into_iter();
    let none = "the first line is missing: nothing says of which run the others are";
    let first = lines.next().ok_or_else(|| RecordError::malformed(file, 1, none))?;
    let head: JournalHead = serde_json::from_value(first).map_err(|e| malformed(1, e))?;
    if wanted.is_some_and(|wanted| *wanted != head) {
        return Ok((head, Vec::new()));
    }
    let item = |(k, line): (usize, Value)| serde_json::from_value(line).map_err(|e| malformed(k + 2, e));
    let items = lines.enumerate().map(item).collect::<Result<_, _>>()?;
    Ok((head, items))
}

/// A journal of a run as text.
pub(crate) fn write_run<T: Serialize>(head: &JournalHead, items: &[T]) -> String {
    line(head) + &items.iter().map(line).collect::<String>()
}

/// A journal to add to.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: fs::File,
    /// Why a write failed. The file may end within a line then: what came behind it could not be read.
    broken: Option<(ErrorKind, String)>,
}

impl Journal {
    /// Opens the file, which is created if it is not there. It must end with a whole line.
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let file =
            fs::OpenOptions::new().create(true).append(true).open(path).map_err(RecordError::io("write", path))?;
        Ok(Journal { path: path.to_owned(), file, broken: None })
    }

    /// Opens the journal of a run in its folder, with the items of an earlier run of this head; with `overwrite` without. It is
    /// written anew, so that a line that was cut off does not stay.
    ///
    /// # Errors
    /// [`RecordError::OtherInputs`] for one of another run; where it cannot be read or written.
    pub fn of_run<T: Serialize + DeserializeOwned>(
        folder: &Path,
        name: &str,
        head: &JournalHead,
        overwrite: bool,
    ) -> Result<(Self, Vec<T>), RecordError> {
        let path = folder.join(name);
        let mut known = Vec::new();
        if !overwrite && path.exists() {
            let bytes = fs::read(&path).map_err(RecordError::io("read", &path))?;
            let (old, items) = parse_run(&path.display().to_string(), &bytes, Some(head))?;
            if old != *head {
                return Err(RecordError::OtherInputs { folder: folder.into(), difference: old.difference(head) });
            }
            known = items;
        }
        files::write(&path, write_run(head, &known).as_bytes()).map_err(RecordError::io("write", &path))?;
        Ok((Self::open(&path)?, known))
    }

    /// Adds lines in one write; nothing after one that failed.
    pub fn write(&mut self, lines: &str) -> Result<(), RecordError> {
        let done = match &self.broken {
            Some((kind, why)) => Err(io::Error::new(*kind, why.clone())),
            None => self.file.write_all(lines.as_bytes()),
        };
        done.map_err(|error| {
            self.broken = Some((error.kind(), error.to_string()));
            RecordError::io("write", &self.path)(error)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    struct Item {
        name: String,
        x: f64,
    }

    #[test]
    fn a_journal_is_read_up_to_a_line_that_was_cut_and_no_edit_passes() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("j");
        assert_eq!(read::<Item>(&path).unwrap(), []);
        // A name that holds what looks like the end of a line, and letters of several bytes.
        let names = ["a", "\",\"sum\":\"0123\"}", "Kettenglied é"];
        let items: Vec<Item> =
            names.iter().zip(1..).map(|(n, k)| Item { name: n.to_string(), x: 0.1 * f64::from(k) }).collect();
        let mut journal = Journal::open(&path).unwrap();
        items.iter().for_each(|item| journal.write(&line(item)).unwrap());
        assert_eq!(read::<Item>(&path).unwrap(), items);
        let whole = fs::read(&path).unwrap();
        let last = whole[..whole.len() - 1].iter().rposition(|b| *b == b'\n').unwrap() + 1;
        for end in last..whole.len() {
            fs::write(&path, &whole[..end]).unwrap();
            assert_eq!(read::<Item>(&path).unwrap(), items[..2]);
        }
        for at in 0..whole.len() - 1 {
            let mut bytes = whole.clone();
            bytes[at] = if bytes[at] == b'7' { b'8' } else { b'7' };
            fs::write(&path, &bytes).unwrap();
            let error = read::<Item>(&path).unwrap_err();
            assert!(matches!(error, RecordError::Malformed { .. }), "{at}: {error}");
        }
    }
}
