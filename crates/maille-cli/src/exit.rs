//! Exit codes by cause, for scripts.

use maille::{error::InvalidInput, record::Status};
use miette::{Diagnostic, Report};
use std::{fmt, process::ExitCode};

/// All done.
pub const DONE: u8 = 0;
/// A file cannot be read or written, or maille itself is at fault.
pub const FAILED: u8 = 1;
/// The arguments are wrong.
pub const USAGE: u8 = 2;
/// A design file is wrong, or there is none of that name.
pub const DESIGN: u8 = 3;
/// A record is missing, damaged, another one, or another run is writing to it.
pub const RECORD: u8 = 4;
/// The record is written, but some limits were not found; in `replay`: some rows came out otherwise.
pub const INCOMPLETE: u8 = 5;
/// The records of a study are written, but some of its designs could not be used.
pub const LEFT_OUT: u8 = 6;
/// Stopped by Ctrl-C or SIGTERM.
pub const INTERRUPTED: u8 = 130;

/// Something wrong that is no error of a library, with what to do next.
#[derive(Debug)]
pub struct Wrong {
    /// The exit code.
    pub code: u8,
    problem: String,
    help: String,
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.problem)
    }
}

impl std::error::Error for Wrong {}

impl Diagnostic for Wrong {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(&self.help))
    }
}

/// A report that ends the program with `code`.
pub fn wrong(code: u8, problem: impl Into<String>, help: impl Into<String>) -> Report {
    Report::new(Wrong { code, problem: problem.into(), help: help.into() })
}

/// A question that was refused. Options that it names in backticks are those of the command line.
pub fn refused(problem: &InvalidInput) -> Report {
    let flags = |text: &str| {
        let part = |(k, part): (usize, &str)| if k % 2 == 1 { format!("--{part}") } else { part.to_owned() };
        text.split('`').enumerate().map(part).collect::<String>()
    };
    wrong(USAGE, flags(&problem.problem), flags(&problem.help))
}

/// How a run ends that the same command continues; `code` is that of a run that was not interrupted.
pub fn ended(interrupted: bool, code: u8, quiet: bool) -> ExitCode {
    if interrupted && !quiet {
        eprintln!("interrupted; the same command continues from here");
    }
    ExitCode::from(if interrupted { INTERRUPTED } else { code })
}

/// How a single question ends.
pub fn of_answer(status: Status) -> ExitCode {
    ExitCode::from(match status {
        Status::Global | Status::Local | Status::L2Unreachable => DONE,
        Status::Interrupted => INTERRUPTED,
        _ => INCOMPLETE,
    })
}
