//! `--watch`: the command again whenever a design file is saved.

use crate::{
    exit::{self, wrong},
    interrupt, remedy,
};
use maille_io::builtin;
use miette::{IntoDiagnostic, Result, WrapErr};
use notify_debouncer_mini::{new_debouncer, notify::RecursiveMode};
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::{
        atomic::Ordering,
        mpsc::{RecvTimeoutError, channel},
    },
    time::Duration,
};

/// Saves within this time are one.
const SETTLE: Duration = Duration::from_millis(200);

/// Runs `command` now and after each change of one of the files, until Ctrl-C.
///
/// Folders are watched, not files: editors save by renaming. A file that was saved unchanged starts nothing.
pub fn watch(designs: &[String], mut command: impl FnMut() -> Result<ExitCode>) -> Result<ExitCode> {
    for name in designs {
        if !Path::new(name).is_file() {
            let what = match name.as_str() {
                "-" => "standard input cannot be watched".into(),
                name if builtin(name).is_some() => format!("{name} is built in and never changes"),
                name => format!("there is no file \"{name}\" to watch"),
            };
            return Err(wrong(exit::USAGE, what, "give --watch the name of a design file"));
        }
    }
    let context = || "cannot watch the files; run the command without --watch".to_owned();
    let stop = interrupt::flag(false)?;
    let (changed, changes) = channel();
    let mut debouncer = new_debouncer(SETTLE, changed).into_diagnostic().wrap_err_with(context)?;
    for name in designs {
        let folder = Path::new(name).parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        debouncer.watcher().watch(folder, RecursiveMode::NonRecursive).into_diagnostic().wrap_err_with(context)?;
    }
    loop {
        let seen = contents(designs);
        if let Err(report) = command() {
            eprintln!("{:?}", remedy::added(report));
        }
        eprintln!("watching {}; Ctrl-C ends", designs.join(", "));
        loop {
            if stop.load(Ordering::Relaxed) {
                return Ok(ExitCode::from(exit::INTERRUPTED));
            }
            match changes.recv_timeout(SETTLE) {
                Ok(Ok(_)) if contents(designs) != seen => break,
                Ok(Ok(_)) | Err(RecvTimeoutError::Timeout) => {}
                Ok(Err(e)) => return Err(e).into_diagnostic().wrap_err_with(context),
                Err(RecvTimeoutError::Disconnected) => return Ok(ExitCode::from(exit::FAILED)),
            }
        }
    }
}

/// The files' bytes; none where one is away for a moment, as while it is saved.
fn contents(designs: &[String]) -> Vec<Option<Vec<u8>>> {
    designs.iter().map(|name| std::fs::read(PathBuf::from(name)).ok()).collect()
}
