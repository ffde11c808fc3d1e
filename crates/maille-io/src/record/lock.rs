//! One run at a time in a folder.

use super::error::RecordError;
use crate::files;
use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io::ErrorKind,
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
    /// written in it; [`RecordError::InUse`] if another run has it.
    pub fn take(folder: &Path) -> Result<Self, RecordError> {
        fs::create_dir_all(folder).map_err(RecordError::io("create", folder))?;
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
