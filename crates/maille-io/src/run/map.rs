//! Maps, from a design to its record: what is there is read, what is left is asked for, each limit is kept as it comes.

use super::sensitivities::sensitivities;
use crate::quantity::Quantity;
use crate::record::{Counters, Record, RecordError, RecordFolder, RunRecord, input_hash};
use maille::design::Design;
use maille::lattice::Cell;
use maille::model::Model;
use maille::record::{LimitRow, StateRecord};
use maille::survey::{CellChoice, Finished, MapQuestion, Method, Task, Work, chains, characterize, extremes};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A map that could not be kept.
#[derive(Debug, Error)]
pub enum MapError {
    /// Its record, after which a run stops.
    #[error("the record could not be written")]
    Record(#[from] RecordError),
    /// Its plot could not be drawn.
    #[cfg(feature = "plot")]
    #[error("cannot draw the plot")]
    Plot(#[from] maille_svg::PlotError),
}

/// A map of one design, and where its record is.
#[derive(Clone, Debug)]
pub struct Map {
    /// What is asked.
    pub question: MapQuestion,
    /// What the record's plot shows.
    pub quantity: Quantity,
    /// Folder of the record; without one it stays in memory.
    pub out: Option<PathBuf>,
    /// Replace a record of other inputs.
    pub overwrite: bool,
    /// Write the derivatives of the limits beside them; where the folder has them, they are always kept up to date.
    pub sensitivities: bool,
}

impl Map {
    /// The cells to compile a design for, in the order of the models of [`Self::open`].
    pub fn cells(&self, design: &Design) -> Vec<Cell> {
        self.question.cells.cells(&self.question.method, design.elements.len())
    }

    /// Opens the record, with what an earlier run has left there. `models` are the design compiled for
    /// [`Self::cells`].
    pub fn open(&self, design: &Design, models: Vec<Model>) -> Result<OpenMap, RecordError> {
        let cells = CellChoice::These(models.iter().map(|model| model.cell).collect());
        let mut parameters = json!(MapQuestion { cells, ..self.question.clone() });
        // With all that is fixed, so that the record says how it was found.
        parameters["options"] = match &self.question.method {
            Method::Exact(options) => json!(options.parameters()),
            Method::Energy(options) => json!(options.parameters(&models[0])),
        };
        let all = self.question.tasks();
        let mut rows: Vec<Option<(LimitRow, StateRecord)>> = vec![None; all.len()];
        let mut folder = None;
        let mut extremes = Vec::new();
        if let Some(path) = &self.out {
            let (opened, old_rows, old_states) =
                RecordFolder::open(path, design, &parameters, VERSION, self.overwrite)?;
            folder = Some(opened);
            for (row, state) in old_rows.into_iter().zip(old_states) {
                match place(&all, &row) {
                    Some(k) => rows[k] = Some((row, state)),
                    None if row.extreme.is_some() => extremes.push((row, state)),
                    None => {}
                }
            }
        }
        let collected = Collected { folder, rows, extremes, written: Instant::now(), failure: None };
        Ok(OpenMap { map: self.clone(), design: design.clone(), models, parameters, all, collected })
    }
}

/// A map whose record is open.
pub struct OpenMap {
    map: Map,
    design: Design,
    models: Vec<Model>,
    parameters: Value,
    all: Vec<Task>,
    collected: Collected,
}

impl OpenMap {
    /// Limits of the map.
    pub fn total(&self) -> usize {
        self.all.len()
    }

    /// Limits that are not in the record yet.
    pub fn left(&self) -> usize {
        self.open().count()
    }

    fn open(&self) -> impl Iterator<Item = Task> {
        self.all.iter().zip(&self.collected.rows).filter(|(_, row)| row.is_none()).map(|(task, _)| *task)
    }

    /// Whether the width across the pull is left to the sheet.
    pub fn is_lateral_free(&self) -> bool {
        matches!(&self.map.question.method, Method::Exact(options) if options.across.lateral_free)
    }

    /// The folder of the record.
    pub fn folder(&self) -> Option<&Path> {
        self.map.out.as_deref()
    }

    /// The chains of the map, the least that can be asked for alone: the limits along one direction, in the order in
    /// which they go on from each other, with those of its images. The record of a map of these directions alone has
    /// the same rows, bit for bit.
    pub fn chains(&self) -> impl Iterator<Item = Chain> {
        let chain = |directions_deg: Vec<f64>| {
            let inputs = json!({ "program_version": VERSION, "parameters": self.parameters_of(&directions_deg) });
            let left = self.open().filter(|task| directions_deg.contains(&task.direction_deg)).count();
            Chain { directions_deg, left, hash: input_hash(&self.design, &inputs) }
        };
        chains(&self.models[0], &self.map.question).into_iter().map(move |orbit| chain(orbit.directions_deg))
    }

    /// The parameters of a map of these directions.
    fn parameters_of(&self, directions_deg: &[f64]) -> Value {
        let mut parameters = self.parameters.clone();
        parameters["directions_deg"] = json!(directions_deg);
        parameters
    }

    /// The limits of a chain that are in the record, as a record.
    pub fn chain(&self, directions_deg: &[f64]) -> Record {
        let parameters = self.parameters_of(directions_deg);
        let found = self.collected.rows.iter().flatten().filter(|(row, _)| directions_deg.contains(&row.direction_deg));
        let (rows, states): (Vec<_>, Vec<_>) = found.cloned().unzip();
        let counters = Counters::of(&rows);
        Record { run: RunRecord { counters, ..RunRecord::new(&self.design, &parameters, VERSION) }, rows, states }
    }

    /// Takes a limit that was found elsewhere; says whether it was one of the map that was left. With a folder, it is
    /// on the disk when this returns.
    pub fn keep(&mut self, row: LimitRow, state: StateRecord) -> Result<bool, RecordError> {
        match place(&self.all, &row).filter(|k| self.collected.rows[*k].is_none()) {
            Some(k) => self.collected.keep(Some(k), Finished { row, state }).map(|()| true),
            None => Ok(false),
        }
    }

    /// Asks for the limits that are left, on the current thread pool, then for the extremes between them where the question does, writes
    /// the record, and gives it. `found` is shown
    /// each limit with its state, `work` hears when one is begun and ended; after `cancel` what is finished is written.
    pub fn run(
        mut self,
        cancel: &AtomicBool,
        work: &(dyn Fn(Task, Work) + Sync),
        found: &(dyn Fn(&LimitRow, &StateRecord) + Sync),
    ) -> Result<Record, MapError> {
        let open: Vec<Task> = self.open().collect();
        let there = self.total() - open.len();
        let collected = Mutex::new(&mut self.collected);
        let receive = |finished: Finished| {
            found(&finished.row, &finished.state);
            let mut collected = collected.lock().unwrap_or_else(|e| e.into_inner());
            let place = place(&self.all, &finished.row);
            if place.is_none() && finished.row.extreme.is_none() {
                return;
            }
            if let Err(error) = collected.keep(place, finished) {
                collected.failure = Some(error);
                cancel.store(true, Ordering::Relaxed);
            }
        };
        let wanted = |task: Task| open.contains(&task);
        let radius = self.design.minor_radius;
        characterize(&self.models, radius, &self.map.question, &wanted, cancel, work, &receive);
        if self.map.question.extremes {
            let (rows, states) = collected.lock().unwrap_or_else(|e| e.into_inner()).finished();
            let known: Vec<_> = rows.into_iter().zip(states).collect();
            extremes(&self.models, radius, &self.map.question, &known, cancel, work, &receive);
        }
        // Stopped before it has found anything: what lies beside the record is up to date, and many such maps end soon.
        let nothing_new = cancel.load(Ordering::Relaxed) && self.total() - self.left() == there;
        self.finished(!nothing_new)
    }

    /// Writes the record with what was found, and its plot, and gives it.
    pub fn finish(self) -> Result<Record, MapError> {
        self.finished(true)
    }

    fn finished(self, beside: bool) -> Result<Record, MapError> {
        let OpenMap { map, design, parameters, mut collected, .. } = self;
        if let Some(error) = collected.failure {
            return Err(error.into());
        }
        collected.write()?;
        let (rows, states) = collected.finished();
        let run = RunRecord { counters: Counters::of(&rows), ..RunRecord::new(&design, &parameters, VERSION) };
        let mut record = Record { run, rows, states };
        if let Some(folder) = &mut collected.folder {
            if beside {
                write_beside(&record, folder, map.quantity, map.sensitivities)?;
            }
            record.run = folder.run().clone();
        }
        Ok(record)
    }
}

/// The limits along one direction, and along those that are its images under the symmetries of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Directions of the pull, in the order of the map.
    pub directions_deg: Vec<f64>,
    /// Its limits that are not in the record yet.
    pub left: usize,
    /// SHA-256 of all that it depends on: design, parameters, these directions, version of the program.
    pub hash: String,
}

/// Writes a record to a folder of its own, with its plot and, where they are asked for, the derivatives of its limits: as a run that
/// had found it there.
pub fn save_record(
    record: &Record,
    folder: &Path,
    quantity: Quantity,
    overwrite: bool,
    sensitivities: bool,
) -> Result<(), MapError> {
    let RunRecord { design, parameters, program_version, .. } = &record.run;
    let (mut folder, ..) = RecordFolder::open(folder, design, parameters, program_version, overwrite)?;
    folder.write(&record.rows, &record.states)?;
    write_beside(record, &mut folder, quantity, sensitivities)
}

/// The plot of a record; its derivatives, where they are asked for or there already.
fn write_beside(
    record: &Record,
    folder: &mut RecordFolder,
    quantity: Quantity,
    derivatives: bool,
) -> Result<(), MapError> {
    write_polar(record, folder, quantity)?;
    if derivatives || folder.has_sensitivities() {
        folder.write_sensitivities(&sensitivities(record)?)?;
    }
    Ok(())
}

/// The plot of a record, where plots are built in.
#[cfg(not(feature = "plot"))]
fn write_polar(_: &Record, _: &RecordFolder, _: Quantity) -> Result<(), MapError> {
    Ok(())
}

/// The plot of a record, where plots are built in.
#[cfg(feature = "plot")]
fn write_polar(record: &Record, folder: &RecordFolder, quantity: Quantity) -> Result<(), MapError> {
    use crate::plot::{Layout, PolarPlot, parameter_words, polar_svg};
    use maille_svg::svg_to_png;
    let words = parameter_words(&record.run);
    let svg = polar_svg(&PolarPlot::from_rows(&record.run.design, &record.rows, quantity, &words), Layout::Beside);
    let png = svg_to_png(&svg, 2.0)?;
    Ok(folder.write_polar(&svg, &png)?)
}

/// Where a row belongs among the tasks.
fn place(all: &[Task], row: &LimitRow) -> Option<usize> {
    all.iter().position(|t| (t.direction_deg, t.l2) == (row.direction_deg, row.l2))
}

/// The rows found so far, in the order of the tasks, extremes between their directions, and when they were last written.
struct Collected {
    folder: Option<RecordFolder>,
    rows: Vec<Option<(LimitRow, StateRecord)>>,
    extremes: Vec<(LimitRow, StateRecord)>,
    written: Instant,
    failure: Option<RecordError>,
}

/// A record's files are written at most this often while limits come in; between, limits go to its journal.
const WRITE_INTERVAL: Duration = Duration::from_secs(1);

impl Collected {
    fn finished(&self) -> (Vec<LimitRow>, Vec<StateRecord>) {
        let mut all: Vec<&(LimitRow, StateRecord)> = self.rows.iter().flatten().collect();
        let mut extremes: Vec<_> = self.extremes.iter().collect();
        extremes.sort_by(|(a, _), (b, _)| a.direction_deg.total_cmp(&b.direction_deg));
        for extreme in extremes {
            // After the last direction before it.
            let before = |(row, _): &&(LimitRow, StateRecord)| {
                row.l2 == extreme.0.l2 && row.direction_deg <= extreme.0.direction_deg
            };
            let at = all.iter().rposition(before).map_or(all.len(), |at| at + 1);
            all.insert(at, extreme);
        }
        all.into_iter().cloned().unzip()
    }

    /// Takes a limit, without a place among the tasks an extreme: with a folder, it is on the disk when this returns.
    fn keep(&mut self, place: Option<usize>, Finished { row, state }: Finished) -> Result<(), RecordError> {
        let due = self.written.elapsed() >= WRITE_INTERVAL;
        if let Some(folder) = self.folder.as_mut().filter(|_| !due) {
            folder.append(&row, &state)?;
        }
        match place {
            Some(place) => self.rows[place] = Some((row, state)),
            None => self.extremes.push((row, state)),
        }
        if due { self.write() } else { Ok(()) }
    }

    fn write(&mut self) -> Result<(), RecordError> {
        let (rows, states) = self.finished();
        if let Some(folder) = &mut self.folder {
            folder.write(&rows, &states)?;
        }
        self.written = Instant::now();
        Ok(())
    }
}
