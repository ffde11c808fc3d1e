//! The run that finds the rolls of a question.

use super::{Axis, Roll, RollKey, RollQuestion, Sought, in_order};
use crate::record::RecordError;
use maille::{
    Sheet,
    answer::Answer,
    error::InvalidInput,
    lattice::Cell,
    model::Model,
    survey::{KnownRoll, RollTask},
};
use std::{
    mem,
    sync::atomic::{AtomicBool, Ordering},
};

impl Roll {
    /// As a search goes on from it; `None` where its state is of no such design.
    fn known(&self, sheet: &Sheet) -> Option<KnownRoll> {
        let certified = if self.is_certified() {
            let (cell, own): (Cell, &Model) = (self.cell.parse().ok()?, sheet.model());
            let state = match cell == own.cell {
                true => self.state()?.state(own)?,
                false => self.state()?.state(&own.in_cell(cell))?,
            };
            Some((self.value(own.unit)?, cell, state))
        } else {
            None
        };
        let &Roll { n_starts, n_distinct, better_chance, .. } = self;
        Some(KnownRoll { task: self.key().task(), certified, n_starts, n_distinct, better_chance })
    }

    /// What is sought of it, in R or 1/R.
    fn value(&self, unit: f64) -> Option<f64> {
        match self.sought {
            Sought::Tightest => self.curvature.map(|curvature| curvature * unit),
            Sought::Roomiest => self.min_gap.map(|gap| gap / unit),
            Sought::Narrowest | Sought::Widest => self.neutral_radius.map(|radius| radius / unit),
            Sought::Shortest | Sought::Longest => self.l2,
        }
    }
}

impl RollKey {
    fn task(self) -> RollTask {
        RollTask { direction_deg: self.direction_deg, above: self.axis == Axis::Above }
    }

    /// The roll along another direction, or to the other side.
    fn of_task(self, task: RollTask) -> Self {
        let axis = if task.above { Axis::Above } else { Axis::Below };
        RollKey { direction_deg: task.direction_deg, axis, ..self }
    }
}

/// Finds the rolls of a question that are not among `rolls`, and improves all of them; gives them in order. `keep` gets each as it is found, and
/// again where it goes further. After `cancel`, and after an error of `keep`, the rest does not come.
///
/// # Errors
/// That of `keep`, and what cannot be asked: see [`RollQuestion::check`].
pub fn find_rolls(
    sheet: &Sheet,
    question: &RollQuestion,
    mut rolls: Vec<Roll>,
    cancel: &AtomicBool,
    keep: &mut (dyn FnMut(&Roll) -> Result<(), RecordError> + Send),
) -> Result<Vec<Roll>, RollError> {
    let free = question.strains().free;
    let mut failed = None;
    let (mut left, mut again) = (question.rolls(), question.rolls());
    again.retain(|key| key.sought != Sought::Tightest);
    // Those that differ in direction and side alone help each other; in a second pass those that differ in what is sought, too.
    while let Some(first) = left.first().or(again.first()).copied() {
        let alike = |key: &RollKey| key.of_task(first.task()) == first;
        let second = left.is_empty();
        let list = if second { &mut again } else { &mut left };
        let now: Vec<RollKey> = list.extract_if(.., |key| alike(key)).collect();
        let of_turn = |key: &RollKey| second && (key.wrap, key.at_curvature) == (first.wrap, first.at_curvature);
        let others = rolls.iter().filter(|roll| of_turn(&roll.key()) && !alike(&roll.key()));
        let others: Vec<KnownRoll> = others.filter_map(|roll| roll.known(sheet)).collect();
        let tasks: Vec<RollTask> = now.iter().map(|key| key.task()).collect();
        let known = rolls.iter().filter(|roll| alike(&roll.key())).filter_map(|roll| roll.known(sheet)).collect();
        let mut found = |task: RollTask, answer: &Answer, wall_s: f64| {
            let mut roll = Roll::new(first.of_task(task), free, &sheet.model_of(answer), answer, wall_s);
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
        sheet.rolls(&question.question(first, sheet.model().unit), &tasks, (known, &others), cancel, &mut found)?;
        if cancel.load(Ordering::Relaxed) {
            break;
        }
    }
    in_order(&mut rolls);
    match failed {
        Some(e) => Err(e.into()),
        None => Ok(rolls),
    }
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
