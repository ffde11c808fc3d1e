//! Maps, from a design to its record: `characterize` makes one, `reproduce` and `sweep` many.

use crate::{
    exit::{self, wrong},
    input::Input,
    progress::Progress,
};
use maille::{
    characterize::{Finished, Method, Task, characterize, tasks},
    lattice::Cell,
    model::Model,
    record::{LimitRow, StateRecord, Status},
};
use maille_io::{
    plot::{Layout, PolarPlot, Quantity, parameter_words, polar_svg, svg_to_png},
    record::RecordFolder,
};
use miette::{IntoDiagnostic, Result, WrapErr};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::{
    path::{Path, PathBuf},
    sync::{
        Mutex,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

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

/// `auto`, or one cell.
#[derive(Clone, Copy)]
pub enum CellChoice {
    Auto,
    One(Cell),
}

/// Cells that `auto` may go on to, in this order.
const LARGER: [&str; 4] = ["2x1", "1x2", "2x2", "3x3"];
/// Elements in a cell that `auto` goes on to, at most.
const MOST_ELEMENTS: usize = 40;

impl CellChoice {
    /// The cells to compile: for the energy method `auto` is the design's own.
    pub fn cells(self, method: &Method, elements: usize) -> Vec<Cell> {
        match (self, method) {
            (CellChoice::One(cell), _) => vec![cell],
            (CellChoice::Auto, Method::Energy(_)) => vec![Cell::PRIMITIVE],
            (CellChoice::Auto, Method::Exact(_)) => {
                let larger = LARGER.iter().filter_map(|text| text.parse::<Cell>().ok());
                let larger = larger.filter(|cell| cell.copies() * elements <= MOST_ELEMENTS);
                std::iter::once(Cell::PRIMITIVE).chain(larger).collect()
            }
        }
    }
}

/// A map of one design, and the folder of its record.
pub struct Map {
    /// How limits are found.
    pub method: Method,
    /// Cells that are solved.
    pub cell: CellChoice,
    /// Directions of the pull.
    pub directions_deg: Vec<f64>,
    /// Stretch − 1 held across it.
    pub l2: Vec<f64>,
    /// What the record's plot shows.
    pub quantity: Quantity,
    /// Folder of the record.
    pub out: PathBuf,
    /// Replace a record of other inputs.
    pub overwrite: bool,
}

impl Map {
    /// Compiles the design and opens the record, with what an earlier run has left there.
    pub fn open<'a>(&'a self, input: &'a Input) -> Result<OpenMap<'a>> {
        let cells = self.cell.cells(&self.method, input.design.elements.len());
        let models: Vec<Model> = cells.iter().map(|cell| input.compile(&input.design, *cell)).collect::<Result<_>>()?;
        let parameters = json!({
            "method": self.method.name(),
            "cells": cells.iter().map(Cell::to_string).collect::<Vec<_>>(),
            "directions_deg": self.directions_deg,
            "l2": self.l2,
            "options": match &self.method {
                Method::Exact(options) => json!(options.parameters()),
                Method::Energy(options) => json!(options.parameters(&models[0])),
            },
        });
        if self.out.is_file() {
            let help = "name another folder with --out";
            return Err(wrong(exit::USAGE, format!("{} is a file; a record is a folder", self.out.display()), help));
        }
        let version = env!("CARGO_PKG_VERSION");
        let (folder, old_rows, old_states) =
            RecordFolder::open(&self.out, &input.design, &parameters, version, self.overwrite)?;
        let all = tasks(&self.directions_deg, &self.l2);
        let mut rows: Vec<Option<(LimitRow, StateRecord)>> = vec![None; all.len()];
        for (row, state) in old_rows.into_iter().zip(old_states) {
            if let Some(k) = place(&all, &row) {
                rows[k] = Some((row, state));
            }
        }
        let open = all.iter().zip(&rows).filter(|(_, row)| row.is_none()).map(|(task, _)| *task).collect();
        Ok(OpenMap { map: self, input, models, parameters, folder, all, rows, open })
    }
}

/// A map whose record is open.
pub struct OpenMap<'a> {
    map: &'a Map,
    input: &'a Input,
    models: Vec<Model>,
    parameters: Value,
    folder: RecordFolder,
    all: Vec<Task>,
    rows: Vec<Option<(LimitRow, StateRecord)>>,
    open: Vec<Task>,
}

impl OpenMap<'_> {
    /// Limits of the map.
    pub fn total(&self) -> usize {
        self.all.len()
    }

    /// Limits that are not in the record yet.
    pub fn left(&self) -> usize {
        self.open.len()
    }

    /// Whether no chain of links joins the cells of the design.
    pub fn is_unbounded(&self) -> bool {
        maille::topology::binding_vectors(&self.models[0]).is_empty()
    }

    /// The folder of the record.
    pub fn folder(&self) -> &Path {
        &self.map.out
    }

    /// Finds the limits that are left on the current thread pool, writes the record, and gives all its rows. `found`
    /// hears of each limit; after `cancel` what is finished is written.
    pub fn run(self, cancel: &AtomicBool, found: &(dyn Fn(&LimitRow) + Sync)) -> Result<Vec<LimitRow>> {
        let OpenMap { map, input, models, parameters, folder, all, rows, open } = self;
        let collected = Mutex::new(Collected { folder, rows, written: Instant::now(), failure: None });
        let receive = |finished: Finished| {
            found(&finished.row);
            let mut collected = collected.lock().unwrap_or_else(|e| e.into_inner());
            let Some(k) = place(&all, &finished.row) else { return };
            if let Err(report) = collected.keep(k, finished) {
                collected.failure = Some(report);
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let wanted = |task: Task| open.contains(&task);
        let (directions, l2) = (&map.directions_deg, &map.l2);
        let minor_radius = input.design.minor_radius;
        characterize(&models, minor_radius, &map.method, directions, l2, &wanted, cancel, &receive);
        let mut collected = collected.into_inner().unwrap_or_else(|e| e.into_inner());
        if let Some(report) = collected.failure {
            return Err(report.wrap_err("the record could not be written; the run has stopped"));
        }
        collected.write()?;
        let (rows, _) = collected.finished();
        let words = parameter_words(&parameters);
        let svg = polar_svg(&PolarPlot::from_rows(&input.design, &rows, map.quantity, &words), Layout::Beside);
        let png = svg_to_png(&svg, 2.0).into_diagnostic().wrap_err("cannot draw the plot")?;
        collected.folder.write_polar(&svg, &png)?;
        Ok(rows)
    }
}

/// Runs maps side by side, so that no thread waits for the last limit of a map, and gives the rows of each.
pub fn run_all(
    open: Vec<(&str, OpenMap<'_>)>,
    pool: &rayon::ThreadPool,
    cancel: &AtomicBool,
    progress: &Progress,
) -> Result<Vec<Vec<LimitRow>>> {
    let run = |(name, open): (&str, OpenMap<'_>)| {
        let found = |row: &LimitRow| progress.step(format!("{name}: {}°, l2 = {}", row.direction_deg, row.l2));
        open.run(cancel, &found)
    };
    pool.install(|| open.into_par_iter().with_max_len(1).map(run).collect())
}

/// Where a row belongs among the tasks.
fn place(all: &[Task], row: &LimitRow) -> Option<usize> {
    all.iter().position(|t| (t.direction_deg, t.l2) == (row.direction_deg, row.l2))
}

/// The rows found so far, in the order of the tasks, and when they were last written.
struct Collected {
    folder: RecordFolder,
    rows: Vec<Option<(LimitRow, StateRecord)>>,
    written: Instant,
    failure: Option<miette::Report>,
}

/// A record's files are written at most this often while limits come in; between, limits go to its journal.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

impl Collected {
    fn finished(&self) -> (Vec<LimitRow>, Vec<StateRecord>) {
        self.rows.iter().flatten().cloned().unzip()
    }

    /// Takes a limit: it is on the disk when this returns.
    fn keep(&mut self, place: usize, Finished { row, state }: Finished) -> Result<()> {
        let due = self.written.elapsed() >= WRITE_INTERVAL;
        if !due {
            self.folder.append(&row, &state)?;
        }
        self.rows[place] = Some((row, state));
        if due { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<()> {
        let (rows, states) = self.finished();
        self.folder.write(&rows, &states)?;
        self.written = Instant::now();
        Ok(())
    }
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

/// The threads of a run: as many as asked for, or as there are cores.
pub fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .build()
        .into_diagnostic()
        .wrap_err("cannot start the threads")
}
