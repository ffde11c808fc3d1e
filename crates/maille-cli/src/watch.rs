//! `--watch`: the command again whenever a design file is saved.

use crate::{
    exit::{self, wrong},
    interrupt, remedy,
};
use maille_io::builtin;
use miette::Result;
use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::atomic::Ordering,
    thread::sleep,
    time::Duration,
};

/// Time between two looks at the files. Saves within this time are one.
const SETTLE: Duration = Duration::from_millis(200);

/// Runs `command` now and after each change of one of the files, until Ctrl-C.
///
/// The files are read again and again: that sees every way of saving, on every file system. A file that was saved unchanged
/// starts nothing, and one that still changes is waited for.
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
    let stop = interrupt::flag(false)?;
    loop {
        let seen = contents(designs);
        if let Err(report) = command() {
            eprintln!("{:?}", remedy::added(report));
        }
        eprintln!("watching {}; Ctrl-C ends", designs.join(", "));
        let mut last = seen.clone();
        loop {
            if stop.load(Ordering::Relaxed) {
                return Ok(ExitCode::from(exit::INTERRUPTED));
            }
            sleep(SETTLE);
            let now = contents(designs);
            if now == last && now != seen {
                break;
            }
            last = now;
        }
    }
}

/// The files' bytes; none where one is away for a moment, as while it is saved.
fn contents(designs: &[String]) -> Vec<Option<Vec<u8>>> {
    designs.iter().map(|name| std::fs::read(PathBuf::from(name)).ok()).collect()
}
