//! Rows of a record, solved again from the inputs that the record holds.

use crate::{
    numbers::distinct,
    record::{Record, RecordError},
};
use maille::{
    error::InvalidInput,
    model::Model,
    record::LimitRow,
    survey::{Finished, MapQuestion, Method, Task, characterize},
};
use std::sync::{Mutex, atomic::AtomicBool};
use thiserror::Error;

/// Limits of the exact method that differ by no more are the same.
const SAME_L1: f64 = 1e-9;

/// A row as recorded, and as it comes out now.
#[derive(Clone, Debug)]
pub struct Replayed<'a> {
    /// The row of the record.
    pub then: &'a LimitRow,
    /// The row and the state of now.
    pub now: Finished,
    /// Limits that differ by no more are the same: 1e-9, or of the energy method, which brackets them, the width of its bracket,
    /// because processors round differently.
    pub tolerance: f64,
}

impl Replayed<'_> {
    /// Whether status and limit are those of the record.
    pub fn agrees(&self) -> bool {
        let same = match (self.then.l1, self.now.row.l1) {
            (Some(then), Some(now)) => (then - now).abs() <= self.tolerance,
            (then, now) => then == now,
        };
        same && self.then.status == self.now.row.status
    }
}

/// A record whose rows cannot be solved again.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// It does not say what was asked.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// Its design does not compile.
    #[error("the record's design cannot be used: {0}")]
    Design(InvalidInput),
}

/// Solves these rows of the record again on the current thread pool; after `cancel` those that are finished come back.
pub fn replay<'a>(
    record: &'a Record,
    rows: &[&'a LimitRow],
    cancel: &AtomicBool,
) -> Result<Vec<Replayed<'a>>, ReplayError> {
    let (design, asked) = (&record.run.design, record.run.question()?);
    let compile = |cell| Model::compile(design, cell).map_err(|problems| ReplayError::Design(problems[0].clone()));
    let cells = asked.cells.cells(&asked.method, design.elements.len());
    let models: Vec<Model> = cells.into_iter().map(compile).collect::<Result<_, _>>()?;
    let tolerance = match &asked.method {
        Method::Energy(options) => options.l1_resolution,
        Method::Exact(_) => SAME_L1,
    };
    let wanted = |task: Task| rows.iter().any(|row| (row.direction_deg, row.l2) == (task.direction_deg, task.l2));
    let found = Mutex::new(Vec::<Finished>::new());
    let solve = |directions_deg: Vec<f64>, l2: Vec<f64>| {
        let question = MapQuestion { directions_deg, l2, ..asked.clone() };
        characterize(&models, design.minor_radius, &question, &wanted, cancel, &|_, _| (), &|row| {
            found.lock().unwrap_or_else(|e| e.into_inner()).push(row);
        });
    };
    // An extreme between directions is solved alone.
    let (extremes, named): (Vec<&LimitRow>, Vec<&LimitRow>) = rows.iter().partition(|row| row.extreme.is_some());
    solve(distinct(named.iter().map(|row| row.direction_deg)).0, asked.l2.clone());
    extremes.iter().for_each(|row| solve(vec![row.direction_deg], vec![row.l2]));
    let found = found.into_inner().unwrap_or_else(|e| e.into_inner());
    let now =
        |then: &LimitRow| found.iter().find(|now| (now.row.direction_deg, now.row.l2) == (then.direction_deg, then.l2));
    Ok(rows.iter().filter_map(|then| Some(Replayed { then, now: now(then)?.clone(), tolerance })).collect())
}
