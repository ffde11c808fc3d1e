//! Files that are whole or not there: written under a temporary name in the same folder, then renamed.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

const TEMPORARY: (&str, &str) = (".maille-", ".tmp");

/// Whether a file of this name is what a killed run left half written.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1)
}

/// Removes what a killed run left half written in a folder, if there is one; the path that could not be removed.
pub fn remove_leftovers(folder: &Path) -> Result<(), (PathBuf, io::Error)> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries.flatten().filter(|entry| is_temporary(&entry.file_name().to_string_lossy())) {
        fs::remove_file(entry.path()).map_err(|e| (entry.path(), e))?;
    }
    Ok(())
}

/// Writes a file: whatever happens, one of this name is whole. Its folder must be there.
pub fn replace(path: &Path, write: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>) -> io::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    #[cfg(unix)]
    let mode = std::os::unix::fs::PermissionsExt::from_mode(0o666); // the umask applies, as to any new file
    #[cfg(unix)]
    builder.permissions(mode);
    let mut file = builder.tempfile_in(folder)?;
    let mut out = BufWriter::with_capacity(1 << 18, file.as_file_mut());
    write(&mut out)?;
    out.flush()?;
    drop(out);
    file.persist(path)?;
    Ok(())
}

/// Writes these bytes in the same way, onto the disk.
pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    replace(path, |out| {
        out.write_all(bytes)?;
        out.flush()?;
        out.get_ref().sync_all()
    })
}
