//! Maps on the command line: from a design as read to the open record, and several side by side.

use crate::{
    exit::{self, wrong},
    input::Input,
    progress::Progress,
};
use maille::record::{LimitRow, Status};
use maille_io::run::{Map, MapError, OpenMap};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use rayon::prelude::*;
use std::{path::PathBuf, sync::atomic::AtomicBool};

/// Where a run writes, and on how many threads.
#[derive(clap::Args)]
pub struct RunArgs {
    /// Folder that is written [default: maille-out/NAME, with -boundary or -compression for those]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Replace what that folder holds of other inputs
    #[arg(long)]
    pub overwrite: bool,
    /// Threads [default: all cores]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Compiles the design and opens the record, with what an earlier run has left there.
pub fn open(map: &Map, input: &Input) -> Result<OpenMap> {
    let compile = |cell| input.compile(&input.design, cell);
    let models = map.cells(&input.design).into_iter().map(compile).collect::<Result<_>>()?;
    if let Some(out) = map.out.as_ref().filter(|out| out.is_file()) {
        let help = "name another folder with --out";
        return Err(wrong(exit::USAGE, format!("{} is a file; a record is a folder", out.display()), help));
    }
    Ok(map.open(&input.design, models)?)
}

/// Finds the limits that are left on the current thread pool, and gives all rows of the record.
pub fn run(open: OpenMap, cancel: &AtomicBool, found: &(dyn Fn(&LimitRow) + Sync)) -> Result<Vec<LimitRow>> {
    let failed = |error: MapError| {
        let words = error.to_string();
        match error {
            MapError::Record(error) => Report::new(error).wrap_err(words),
            MapError::Plot(error) => Err::<(), _>(error).into_diagnostic().unwrap_err().wrap_err(words),
        }
    };
    open.run(cancel, &|row, _| found(row)).map(|record| record.rows).map_err(failed)
}

/// Runs maps side by side, so that no thread waits for the last limit of a map, and gives the rows of each.
pub fn run_all(
    open: Vec<(&str, OpenMap)>,
    pool: &rayon::ThreadPool,
    cancel: &AtomicBool,
    progress: &Progress,
) -> Result<Vec<Vec<LimitRow>>> {
    let each = |(name, open): (&str, OpenMap)| {
        let found = |row: &LimitRow| progress.step(format!("{name}: {}°, l2 = {}", row.direction_deg, row.l2));
        run(open, cancel, &found)
    };
    pool.install(|| open.into_par_iter().with_max_len(1).map(each).collect())
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
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .build()
        .into_diagnostic()
        .wrap_err("cannot start the threads")
}
