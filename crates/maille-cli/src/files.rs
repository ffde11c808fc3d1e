//! Writing files so that each is whole at every moment.

use miette::{IntoDiagnostic, Result, WrapErr};
use std::{
    fs,
    io::{ErrorKind, Write},
    path::Path,
};

/// Writes under a temporary name in the same folder and renames; makes the folder if there is none.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    let context = || format!("cannot write {}", path.display());
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder).into_diagnostic().wrap_err_with(|| format!("cannot create {}", folder.display()))?;
    let mut builder = tempfile::Builder::new();
    builder.prefix(".maille-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // the umask applies, as to any new file
    let mut file = builder.tempfile_in(folder).into_diagnostic().wrap_err_with(context)?;
    file.write_all(bytes).into_diagnostic().wrap_err_with(context)?;
    file.persist(path).into_diagnostic().wrap_err_with(context)?;
    Ok(())
}

/// Writes to standard output; a reader that has seen enough, as `head`, is no error.
pub fn print(bytes: &[u8]) -> Result<()> {
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(e).into_diagnostic().wrap_err("cannot write to standard output")
        }
        _ => Ok(()),
    }
}
