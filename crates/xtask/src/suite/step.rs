//! A step: a command with a log of its own, and how it ended.

use super::{
    counts::{Counts, Runner},
    found::Lack,
};
use std::{path::PathBuf, process::Command};

/// What is run.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Everything that must hold before a change lands.
    Ci,
    /// Every test.
    Test,
    /// Those that take minutes by nature as well.
    All,
}

/// Something that a run does, as a process of its own.
pub struct Step {
    pub name: &'static str,
    pub command: Command,
    /// Steps that must be ok before it starts; one that is not in the run is.
    pub needs: Vec<&'static str>,
    /// Steps that must have ended before it starts, however they did.
    pub after: Vec<&'static str>,
    /// How many cores it uses; 0 for one that waits, for the network or for others.
    pub cores: usize,
    /// Who runs tests in it.
    pub runner: Option<Runner>,
    /// Why it cannot run here.
    pub skip: Option<String>,
}

impl Step {
    /// A step that uses one core and needs nothing.
    pub fn new(name: &'static str, command: Command) -> Step {
        Step { name, command, needs: Vec::new(), after: Vec::new(), cores: 1, runner: None, skip: None }
    }

    pub fn cores(self, cores: usize) -> Step {
        Step { cores, ..self }
    }

    pub fn needs(self, names: &[&'static str]) -> Step {
        Step { needs: names.to_vec(), ..self }
    }

    pub fn after(self, names: &[&'static str]) -> Step {
        Step { after: names.to_vec(), ..self }
    }

    pub fn tests(self, runner: Runner) -> Step {
        Step { runner: Some(runner), ..self }
    }

    /// Skipped where what it needs of the machine is not there.
    pub fn lacking(self, found: &Result<bool, Lack>) -> Step {
        Step { skip: found.as_ref().err().map(|lack| lack.what.clone()), ..self }
    }

    /// The name of its log.
    pub fn log(&self) -> String {
        format!("{}.log", self.name.replace(' ', "-"))
    }

    /// The command as one types it.
    pub fn line(&self) -> String {
        let words = std::iter::once(self.command.get_program()).chain(self.command.get_args());
        words.map(|word| word.to_string_lossy()).collect::<Vec<_>>().join(" ")
    }
}

/// How a step ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    Ok,
    /// And why.
    Failed(String),
    /// It cannot run here, and why.
    Skipped(String),
    /// It was not started, as a step that it needs has failed.
    Blocked(&'static str),
}

/// A step that has ended.
#[derive(Clone, Debug)]
pub struct Ended {
    pub name: &'static str,
    pub outcome: Outcome,
    pub wall_s: f64,
    pub counts: Counts,
    pub log: PathBuf,
}
