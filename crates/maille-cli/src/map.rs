//! Maps on the command line: from a design as read to the open record, and several side by side.

use crate::{
    exit::{self, refused},
    input::Input,
    interrupt,
    output::{self, counted},
    progress::Progress,
};
use maille::{
    record::{LimitRow, Status},
    survey::{Task, Work, thread_pool},
};
use maille_io::{
    record::Record,
    run::{Map, MapError, OpenMap, run_all},
};
use miette::{Report, Result};
use std::{path::Path, sync::atomic::Ordering};

/// How a run writes and ends, and on how many threads.
#[derive(clap::Args)]
pub struct RunArgs {
    /// Replace a result of other inputs in the folder
    #[arg(long)]
    pub overwrite: bool,
    /// Exit code 0 instead of 5 if some limits are not found
    #[arg(long)]
    pub allow_incomplete: bool,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

impl RunArgs {
    /// The exit code of a run that was not interrupted.
    pub fn code(&self, incomplete: bool) -> u8 {
        if incomplete && !self.allow_incomplete { exit::INCOMPLETE } else { exit::DONE }
    }
}

/// Compiles the design and opens the record, with what an earlier run has left there.
pub fn open(map: &Map, input: &Input) -> Result<OpenMap> {
    let compile = |cell| input.compile(&input.design, cell);
    let models = map.cells(&input.design).into_iter().map(compile).collect::<Result<Vec<_>>>()?;
    map.question.suits(&models[0]).map_err(|e| refused(&e))?;
    map.out.as_ref().map_or(Ok(()), |out| output::folder(out, "a record is a folder"))?;
    Ok(map.open(&input.design, models)?)
}

/// What came of maps.
pub struct Solved {
    /// The record of each.
    pub records: Vec<Record>,
    /// What is in them.
    pub tally: Tally,
    /// Limits that were asked for.
    pub total: usize,
    /// Whether Ctrl-C stopped the run.
    pub interrupted: bool,
}

/// Finds the limits that are left in maps, each with its name, side by side. Says which are there already, and shows progress.
pub fn solve(open: Vec<(&str, OpenMap)>, out: &Path, threads: Option<u16>, quiet: bool) -> Result<Solved> {
    let (left, total) = open.iter().fold((0, 0), |(l, t), (_, map)| (l + map.left(), t + map.total()));
    let there = total - left;
    if !quiet && there > 0 {
        eprintln!("{there} of {} are in {} already", counted(total, "limit"), out.display());
    }
    let free: Vec<String> =
        open.iter().filter(|(_, map)| map.is_lateral_free()).map(|(name, _)| (*name).to_owned()).collect();
    let (cancel, pool) = (interrupt::flag(quiet)?, pool(threads)?);
    let progress = Progress::new("limits", there, total, quiet);
    let work = |name: &str, task: Task, work: Work| {
        let width = if free.iter().any(|f| f == name) { "width free".into() } else { format!("l2 = {}", task.l2) };
        let colon = if name.is_empty() { "" } else { ": " };
        let limit = format!("{name}{colon}{}°, {width}", task.direction_deg);
        match work {
            Work::Begins => progress.begins(limit),
            Work::Ends => progress.ends(&limit),
        }
    };
    let records = pool.install(|| {
        run_all(open, &cancel, &work, &|_, row| {
            if row.extreme.is_none() {
                progress.step();
            }
        })
    });
    progress.finish();
    let records = records.map_err(|error| {
        let words = error.to_string();
        match error {
            MapError::Record(error) => Report::new(error).wrap_err(words),
            MapError::Plot(error) => Report::from_err(error).wrap_err(words),
        }
    })?;
    let tally = Tally::of(records.iter().flat_map(|record| &record.rows), there);
    Ok(Solved { records, tally, total, interrupted: cancel.load(Ordering::Relaxed) })
}

/// Whether a row has no answer; a proof that there is no limit is one.
pub fn unanswered(row: &LimitRow) -> bool {
    match row.status {
        Status::Global | Status::Local | Status::ThresholdReached | Status::L2Unreachable | Status::Unbounded => false,
        Status::Uncertified
        | Status::L2NotReached
        | Status::NotConverged
        | Status::InfeasibleStart
        | Status::Interrupted => true,
    }
}

/// What a run has come to, counted in the rows of its records and not in what was asked for: a run may be stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tally {
    /// Limits that are in the records.
    pub there: usize,
    /// Those of them that this run has put there.
    pub now: usize,
    /// Those of them that have no answer.
    pub unanswered: usize,
}

impl Tally {
    /// Of the `rows` in the records, of which `before` were there already. Limits that a stop cut short are not there.
    pub fn of<'a>(rows: impl IntoIterator<Item = &'a LimitRow>, before: usize) -> Tally {
        let (mut there, mut without) = (0, 0);
        for row in rows.into_iter().filter(|row| row.status != Status::Interrupted) {
            there += 1;
            without += usize::from(unanswered(row));
        }
        Tally { there, now: there.saturating_sub(before), unanswered: without }
    }
}

/// The threads of a run: as many as asked for, or as there are cores.
pub fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool> {
    thread_pool(threads.map(usize::from)).map_err(|e| refused(&e))
}
