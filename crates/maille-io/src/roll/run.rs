//! The run that finds the rolls of a question.

use super::{Axis, Roll, RollKey, RollQuestion, Sought, in_order};
use crate::record::RecordError;
use maille::{
    Sheet,
    answer::Answer,
    design::Design,
    error::InvalidInput,
    lattice::Cell,
    question::Sense,
    survey::{KnownRoll, RollTask},
};
use std::{
    mem,
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

impl Roll {
    /// As a search goes on from it; `None` where nothing was found, or its state is of no such design.
    fn known(&self, sheet: &Sheet) -> Option<KnownRoll> {
        let cell: Cell = self.cell.parse().ok()?;
        let own = sheet.model();
        let state = match cell == own.cell {
            true => self.state()?.state(own)?,
            false => self.state()?.state(&own.in_cell(cell))?,
        };
        let certified = self.curvature.filter(|_| self.is_certified()).map(|curvature| curvature * own.unit);
        let &Roll { direction_deg, axis, n_starts, n_distinct, better_chance, .. } = self;
        let task = RollTask { direction_deg, sense: axis.sense() };
        Some(KnownRoll { task, cell, state, certified, n_starts, n_distinct, better_chance })
    }
}

/// Finds the rolls of a question that are not among `rolls`, and improves all of them; gives them in order. `keep` gets each as it is found, and
/// again where it goes further. After `cancel`, and after an error of `keep`, the rest does not come.
///
/// # Errors
/// That of `keep`, and what cannot be asked: see [`RollQuestion::check`]; a tube that does not close.
pub fn find_rolls(
    sheet: &Sheet,
    design: &Design,
    question: &RollQuestion,
    mut rolls: Vec<Roll>,
    cancel: &AtomicBool,
    keep: &mut (dyn FnMut(&Roll) -> Result<(), RecordError> + Send),
) -> Result<Vec<Roll>, RollError> {
    let asked = question.rolls();
    if !question.wrap.is_empty() {
        return find_tubes(sheet, design, question, rolls, cancel, keep);
    }
    let task = |key: &RollKey| RollTask { direction_deg: key.direction_deg, sense: key.axis.sense() };
    let tasks: Vec<RollTask> = asked.iter().map(task).collect();
    let known = rolls.iter().filter_map(|roll| roll.known(sheet)).collect();
    let mut failed = None;
    let mut found = |task: RollTask, answer: &Answer, wall_s: f64| {
        let axis = if task.sense == Sense::Largest { Axis::Below } else { Axis::Above };
        let key = RollKey { direction_deg: task.direction_deg, axis, wrap: None, sought: Sought::Tightest };
        let one = question.question(key);
        let Some(mut roll) = Roll::new(design, &one, &sheet.model_of(answer), answer, wall_s) else { return };
        let place = rolls.iter().position(|known| known.key() == roll.key());
        roll.wall_s += place.map_or(0.0, |k| rolls[k].wall_s);
        if let Err(e) = keep(&roll) {
            failed = failed.take().or(Some(e));
            cancel.store(true, Ordering::Relaxed);
        }
        match place {
            Some(k) => drop(mem::replace(&mut rolls[k], roll)),
            None => rolls.push(roll),
        }
    };
    let any = asked.first().map(|first| question.question(*first));
    if let Some(any) = any {
        sheet.rolls(&any, &tasks, known, cancel, &mut found)?;
    }
    in_order(&mut rolls);
    match failed {
        Some(e) => Err(e.into()),
        None => Ok(rolls),
    }
}

fn find_tubes(
    sheet: &Sheet,
    design: &Design,
    question: &RollQuestion,
    mut rolls: Vec<Roll>,
    cancel: &AtomicBool,
    keep: &mut (dyn FnMut(&Roll) -> Result<(), RecordError> + Send),
) -> Result<Vec<Roll>, RollError> {
    for key in question.rolls() {
        if rolls.iter().any(|roll| roll.key() == key) {
            continue;
        }
        let (one, begun) = (question.question(key), Instant::now());
        let answer = sheet.answer_until(&one, cancel)?;
        if cancel.load(Ordering::Relaxed) {
            break;
        }
        let wall_s = begun.elapsed().as_secs_f64();
        if let Some(roll) = Roll::new(design, &one, &sheet.model_of(&answer), &answer, wall_s) {
            keep(&roll)?;
            rolls.push(roll);
        }
    }
    in_order(&mut rolls);
    Ok(rolls)
}

/// Why rolls could not be found.
#[derive(Debug, thiserror::Error)]
pub enum RollError {
    /// What cannot be asked.
    #[error(transparent)]
    Asked(#[from] InvalidInput),
    /// A record that cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
}
