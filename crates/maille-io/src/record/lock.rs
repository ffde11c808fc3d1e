//! One run at a time in a folder, and only in folders of its kind.

use super::error::RecordError;
use crate::files::{self, is_temporary};
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::{ErrorKind, Read},
    path::Path,
};

/// The file that is locked; it stays, empty, and means nothing by itself.
pub(super) const LOCK: &str = ".maille.lock";

/// The right to write to a folder, as long as it lives.
///
/// The operating system keeps it and takes it back when the process ends, however it ends: no lock is left behind by a kill.
/// Readers need none. A file system without locks gives the right to everyone.
#[derive(Debug)]
pub struct FolderLock {
    _file: File,
}

impl FolderLock {
    /// Takes the right to write to a folder, which is created if it is not there, and removes what a killed run left half
    /// written in it. `marks`: an earlier run of this kind has left one of them.
    ///
    /// # Errors
    /// [`RecordError::NotARecord`] where files are there and none of the marks: nothing is written there, and nothing of
    /// others is ever replaced. [`RecordError::InUse`] if another run has the folder.
    pub fn take(folder: &Path, marks: &[Mark]) -> Result<Self, RecordError> {
        fs::create_dir_all(folder).map_err(RecordError::io("create", folder))?;
        let found = names(folder)?;
        if !found.is_empty() && !marks.iter().any(|mark| mark.is_in(folder)) {
            return Err(RecordError::NotARecord { folder: folder.into(), found: some_names(&found) });
        }
        let path = folder.join(LOCK);
        let open = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = open.map_err(RecordError::io("write", &path))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Err(RecordError::InUse { folder: folder.into() }),
            Err(TryLockError::Error(e)) if e.kind() != ErrorKind::Unsupported => {
                return Err(RecordError::io("lock", path)(e));
            }
            _ => {}
        }
        files::remove_leftovers(folder).map_err(|(path, e)| RecordError::io("remove", path)(e))?;
        Ok(Self { _file: file })
    }

    /// Gives the right back, and removes the folder if nothing was written to it.
    pub fn give_up(self, folder: &Path) {
        let only_lock = |entries: fs::ReadDir| entries.flatten().all(|entry| entry.file_name() == LOCK);
        if fs::read_dir(folder).is_ok_and(only_lock) {
            // While the right is held: who has opened the file meanwhile is told that it is in use.
            let _ = fs::remove_file(folder.join(LOCK));
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Name of the folder of the records of a study.
pub const RECORDS: &str = "records";

/// What shows that a folder is that of an earlier run, so that its files may be replaced.
#[derive(Clone, Copy, Debug)]
pub enum Mark {
    /// A file of this name with all these keys of JSON.
    File(&'static str, &'static [&'static str]),
    /// The folder [`RECORDS`] with the record of a map in it.
    Records,
}

/// The file of a map's record.
pub(super) const RUN_MARK: Mark = Mark::File("run.json", &["schema", "program_version"]);
/// Keys are sought in so many bytes.
const HEAD: u64 = 1 << 20;

impl Mark {
    fn is_in(self, folder: &Path) -> bool {
        match self {
            Mark::File(name, keys) => has_keys(&folder.join(name), keys).unwrap_or(false),
            Mark::Records => fs::read_dir(folder.join(RECORDS))
                .is_ok_and(|entries| entries.flatten().any(|entry| RUN_MARK.is_in(&entry.path()))),
        }
    }
}

fn has_keys(file: &Path, keys: &[&str]) -> std::io::Result<bool> {
    let mut head = Vec::new();
    File::open(file)?.take(HEAD).read_to_end(&mut head)?;
    let text = String::from_utf8_lossy(&head);
    Ok(keys.iter().all(|key| text.contains(&format!("\"{key}\""))))
}

/// The names in a folder, without the lock, what a killed run left half written, and folders with nothing else in them.
pub(super) fn names(folder: &Path) -> Result<Vec<String>, RecordError> {
    let read = || -> std::io::Result<Vec<String>> {
        let names = fs::read_dir(folder)?.map(|e| Ok(e?.file_name().to_string_lossy().into_owned()));
        let mut names = names.collect::<std::io::Result<Vec<_>>>()?;
        names.retain(|name| name != LOCK && !is_temporary(name) && !holds_nothing(&folder.join(name)));
        names.sort();
        Ok(names)
    };
    read().map_err(RecordError::io("read", folder))
}

/// Whether this is a folder without a file, as a run leaves it that was killed in its first moment.
fn holds_nothing(folder: &Path) -> bool {
    folder.is_dir() && names(folder).is_ok_and(|names| names.is_empty())
}

/// The first of some names.
pub(super) fn some_names(names: &[String]) -> String {
    match names {
        [] => "nothing".to_owned(),
        few if few.len() <= 3 => few.join(", "),
        many => format!("{}, … {} files", many[..3].join(", "), many.len()),
    }
}
