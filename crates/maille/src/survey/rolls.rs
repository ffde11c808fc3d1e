//! The tightest rolls along many directions, both ways.
//!
//! A roll that a symmetry of the design makes the image of another one is searched from that state alone. Then rolls hand their states on: to
//! their images, and to the rolls of the same side along the directions beside, until none goes further.

use crate::{
    answer::Answer,
    lattice::{Across, Cell, Direction},
    model::{Model, of_cell},
    question::Sense,
    search::{
        ExtremeOptions,
        curl::{Curl, roll_from, tightest_roll},
    },
    state::State,
    symmetry::{Image, Operation, operations, same_direction},
};
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// States are handed on between directions that are at most so far apart, in degrees: farther ones have other links.
const BESIDE_DEG: f64 = 15.0;
/// A curvature that is larger by less is the same, in 1/R.
const SAME_CURVATURE: f64 = 1e-7;

/// One roll that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollTask {
    /// Direction that is rolled, in degrees.
    pub direction_deg: f64,
    /// The largest curvature has the axis below the sheet, the least above.
    pub sense: Sense,
}

/// What is known of a roll: its state, and what its search took.
#[derive(Clone, Debug)]
pub struct KnownRoll {
    /// Which roll.
    pub task: RollTask,
    /// The cell of the state.
    pub cell: Cell,
    /// The state.
    pub state: State,
    /// κ in 1/R, with its sign; `None` where it is not certified.
    pub certified: Option<f64>,
    /// Starts that were searched.
    pub n_starts: Option<u64>,
    /// Distinct certified curvatures among their ends.
    pub n_distinct: Option<u64>,
    /// Estimated chance that another start goes further.
    pub better_chance: Option<f64>,
}

impl KnownRoll {
    fn new(task: RollTask, answer: &Answer) -> Option<Self> {
        let Answer { cell, n_starts, n_distinct, better_chance, .. } = *answer;
        let certified = answer.value.filter(|_| answer.is_limit());
        let state = answer.value.map(|_| answer.state.clone())?;
        Some(KnownRoll { task, cell, state, certified, n_starts, n_distinct, better_chance })
    }

    /// Its curvature in the sense of the roll.
    fn reach(&self) -> f64 {
        self.certified.map_or(f64::NEG_INFINITY, |value| self.task.sense.sign() * value)
    }
}

/// Whether an operation makes one roll the image of another: turned over, a sheet has the axis on its other side.
fn leads_to(operation: &Operation, from: RollTask, to: RollTask) -> bool {
    from.sense.sign() * operation.matrix[(2, 2)] == to.sense.sign()
        && same_direction(operation.direction_deg(from.direction_deg), to.direction_deg)
}

/// Rolls of one sheet.
struct Rolls<'a> {
    models: &'a [Model],
    operations: Vec<Operation>,
    free: Across,
    options: &'a ExtremeOptions,
    cancel: &'a AtomicBool,
}

/// See [`crate::Sheet::rolls`].
pub(crate) fn rolls(
    models: &[Model],
    (free, options): (Across, &ExtremeOptions),
    tasks: &[RollTask],
    mut known: Vec<KnownRoll>,
    cancel: &AtomicBool,
    finished: &mut dyn FnMut(RollTask, &Answer, f64),
) {
    let rolls = Rolls { models, operations: operations(&models[0]), free, options, cancel };
    for task in tasks {
        if known.iter().any(|roll| roll.task == *task) {
            continue;
        }
        let begun = Instant::now();
        let image = rolls.images(&known, *task).next().and_then(|(from, start)| rolls.image(from, *task, start));
        let answer = image.unwrap_or_else(|| tightest_roll(models, rolls.target(*task), options, cancel));
        if cancel.load(Ordering::Relaxed) {
            return;
        }
        finished(*task, &answer, begun.elapsed().as_secs_f64());
        known.extend(KnownRoll::new(*task, &answer));
    }
    rolls.hand_on(&mut known, finished);
}

impl Rolls<'_> {
    fn target(&self, task: RollTask) -> Curl {
        Curl { direction: Direction::of_degrees(task.direction_deg), sign: task.sense.sign(), free: self.free }
    }

    fn from(&self, start: (Cell, State), task: RollTask) -> Answer {
        roll_from(self.models, start, self.target(task), self.options, self.cancel)
    }

    /// The states of which the roll `task` is an image, as images: those of certified rolls, the farthest first.
    fn images<'k>(
        &self,
        known: &'k [KnownRoll],
        task: RollTask,
    ) -> impl Iterator<Item = (&'k KnownRoll, (Cell, State))> {
        let mut from: Vec<&KnownRoll> = known.iter().filter(|roll| roll.certified.is_some()).collect();
        from.sort_by(|a, b| b.reach().total_cmp(&a.reach()));
        from.into_iter().filter_map(move |roll| {
            let operation = self.operations.iter().find(|operation| leads_to(operation, roll.task, task))?;
            let cell = operation.cell(roll.cell)?;
            let (here, there) = (of_cell(self.models, roll.cell), of_cell(self.models, cell));
            let image = Image::new(operation, &here, &there)?;
            Some((roll, (there.cell, image.state(&roll.state))))
        })
    }

    /// The roll from the image of another one; `None` where it does not come as far.
    fn image(&self, from: &KnownRoll, task: RollTask, start: (Cell, State)) -> Option<Answer> {
        let answer = self.from(start, task);
        let reach = KnownRoll::new(task, &answer)?.reach();
        let KnownRoll { n_starts, n_distinct, better_chance, .. } = *from;
        (reach > from.reach() - SAME_CURVATURE).then_some(Answer { n_starts, n_distinct, better_chance, ..answer })
    }

    /// Tries the states of each roll at its images and beside it until none goes further.
    fn hand_on(&self, known: &mut [KnownRoll], finished: &mut dyn FnMut(RollTask, &Answer, f64)) {
        let mut order: Vec<usize> = (0..known.len()).collect();
        order.sort_by(|&a, &b| {
            let at = |k: usize| known[k].task.direction_deg.rem_euclid(180.0);
            at(a).total_cmp(&at(b))
        });
        let mut to_hand = vec![true; known.len()];
        while to_hand.iter().any(|open| *open) {
            for place in 0..order.len() {
                let from = order[place];
                if !std::mem::take(&mut to_hand[from]) {
                    continue;
                }
                for to in self.beside(known, &order, place) {
                    let begun = Instant::now();
                    if self.cancel.load(Ordering::Relaxed) {
                        return;
                    }
                    let Some(start) = self.start(&known[from], &known[to]) else { continue };
                    let task = known[to].task;
                    let answer = self.from(start, task);
                    let Some(found) = KnownRoll::new(task, &answer) else { continue };
                    if found.reach() <= known[to].reach() + SAME_CURVATURE {
                        continue;
                    }
                    let old = &known[to];
                    let answer = Answer {
                        n_starts: old.n_starts.map(|starts| starts + answer.runs),
                        n_distinct: old.n_distinct.map(|distinct| distinct + 1),
                        better_chance: old.better_chance,
                        ..answer
                    };
                    finished(task, &answer, begun.elapsed().as_secs_f64());
                    if let Some(found) = KnownRoll::new(task, &answer) {
                        (known[to], to_hand[to]) = (found, true);
                    }
                }
            }
        }
    }

    /// Rolls to which the roll at `place` of `order` hands its state: on the same side along the nearest direction to the left and to the right, and
    /// its images.
    fn beside(&self, known: &[KnownRoll], order: &[usize], place: usize) -> Vec<usize> {
        let (n, from) = (order.len(), &known[order[place]]);
        let nearest = |step: usize| {
            let others = (1..n).map(|k| order[(place + step * k) % n]);
            let same_side = |&to: &usize| known[to].task.sense == from.task.sense;
            let apart = |to: usize| {
                let apart = (known[to].task.direction_deg - from.task.direction_deg).rem_euclid(180.0);
                apart.min(180.0 - apart)
            };
            others.into_iter().find(same_side).filter(|&to| apart(to) <= BESIDE_DEG)
        };
        let mut out: Vec<usize> = [1, n - 1].into_iter().filter_map(nearest).collect();
        out.extend((0..n).filter(|&to| to != order[place] && self.is_image(from, &known[to])));
        out.sort_unstable();
        out.dedup();
        out
    }

    fn is_image(&self, from: &KnownRoll, to: &KnownRoll) -> bool {
        self.operations.iter().any(|operation| leads_to(operation, from.task, to.task))
    }

    /// The state of one roll as a start of another one: its image where it is one, and goes further.
    fn start(&self, from: &KnownRoll, to: &KnownRoll) -> Option<(Cell, State)> {
        from.certified?;
        if !self.is_image(from, to) {
            return Some((from.cell, from.state.clone()));
        }
        let further = from.reach() > to.reach() + SAME_CURVATURE;
        let image = self.images(std::slice::from_ref(from), to.task).next();
        image.filter(|_| further).map(|(_, start)| start)
    }
}
