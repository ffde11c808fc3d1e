//! One question on rolls along many directions, to both sides.
//!
//! A roll that a symmetry of the design makes the image of another one is searched from that state alone. Then rolls hand their states on: to
//! their images, and to the rolls of the same side along the directions beside, until none goes further.

use crate::{
    answer::Answer,
    lattice::{Cell, Direction},
    model::{Model, of_cell},
    question::{Goal, Question, RollStrains, Sense},
    search::{
        ExtremeOptions,
        curl::{Curl, roll_from, tightest_roll},
        rolled::{Rolled, rolled},
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
/// A value that goes further by less is the same, in 1/R or R.
const SAME: f64 = 1e-7;

/// One roll that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollTask {
    /// Direction that is rolled, in degrees.
    pub direction_deg: f64,
    /// Whether the axis lies above the written sheet, not below.
    pub above: bool,
}

impl RollTask {
    /// The question of all tasks, asked of this one.
    pub(crate) fn question(self, of_all: &Question) -> Question {
        let mut question = of_all.clone();
        match &mut question.goal {
            Goal::Curvature { direction_deg, .. } => {
                *direction_deg = self.direction_deg;
                question.sense = if self.above { Sense::Least } else { Sense::Largest };
            }
            Goal::Rolled { direction_deg, above, .. } => {
                (*direction_deg, *above) = (self.direction_deg, self.above);
            }
            _ => {}
        }
        question
    }

    fn side(self) -> f64 {
        if self.above { -1.0 } else { 1.0 }
    }
}

/// What is known of a roll: its state, and what its search took.
#[derive(Clone, Debug)]
pub struct KnownRoll {
    /// Which roll.
    pub task: RollTask,
    /// The value of its answer, in R or 1/R, and its state with the cell; `None` where it is not certified.
    pub certified: Option<(f64, Cell, State)>,
    /// Starts that were searched.
    pub n_starts: Option<u64>,
    /// Distinct certified values among their ends.
    pub n_distinct: Option<u64>,
    /// Estimated chance that another start goes further.
    pub better_chance: Option<f64>,
}

impl KnownRoll {
    fn new(task: RollTask, answer: &Answer) -> Self {
        let Answer { cell, n_starts, n_distinct, better_chance, .. } = *answer;
        let value = answer.value.filter(|_| answer.is_limit());
        let certified = value.map(|value| (value, cell, answer.state.clone()));
        KnownRoll { task, certified, n_starts, n_distinct, better_chance }
    }
}

/// Whether an operation makes one roll the image of another: turned over, a sheet has the axis on its other side.
fn leads_to(operation: &Operation, from: RollTask, to: RollTask, shear: f64) -> bool {
    let in_plane = operation.matrix.fixed_view::<2, 2>(0, 0).determinant();
    // In a mirror the sheet leans the other way.
    (shear == 0.0 || in_plane > 0.0)
        && from.side() * operation.matrix[(2, 2)] == to.side()
        && same_direction(operation.direction_deg(from.direction_deg), to.direction_deg)
}

/// Rolls of one sheet.
struct Rolls<'a> {
    models: &'a [Model],
    operations: Vec<Operation>,
    question: &'a Question,
    strains: RollStrains,
    cancel: &'a AtomicBool,
}

/// See [`crate::Sheet::rolls`].
pub(crate) fn rolls(
    models: &[Model],
    question: &Question,
    tasks: &[RollTask],
    (mut known, others): (Vec<KnownRoll>, &[KnownRoll]),
    cancel: &AtomicBool,
    finished: &mut dyn FnMut(RollTask, &Answer, f64),
) {
    let (Goal::Curvature { strains, .. } | Goal::Rolled { strains, .. }) = question.goal else { return };
    let rolls = Rolls { models, operations: operations(&models[0]), question, strains, cancel };
    for task in tasks {
        if known.iter().any(|roll| roll.task == *task) {
            continue;
        }
        let begun = Instant::now();
        let image = rolls.images(&known, *task).next().and_then(|(from, start)| rolls.image(from, *task, start));
        let Some(answer) = image.or_else(|| rolls.answer(*task, None)) else { continue };
        if cancel.load(Ordering::Relaxed) {
            return;
        }
        finished(*task, &answer, begun.elapsed().as_secs_f64());
        known.push(KnownRoll::new(*task, &answer));
    }
    for roll in &mut known {
        let task = roll.task;
        for (_, cell, state) in others.iter().filter(|other| other.task == task).filter_map(|o| o.certified.as_ref()) {
            rolls.improve(roll, (*cell, state.clone()), finished);
        }
    }
    rolls.hand_on(&mut known, finished);
}

impl Rolls<'_> {
    /// The answer of a roll: of a search, or of one start alone.
    fn answer(&self, task: RollTask, start: Option<(Cell, State)>) -> Option<Answer> {
        let question = task.question(self.question);
        let Question { effort, starts, seed, .. } = question;
        let options = ExtremeOptions { lattice_free: true, effort, starts, seed };
        if let Goal::Rolled { .. } = question.goal {
            let cell = start.as_ref().map_or(self.models[0].cell, |(cell, _)| *cell);
            let model = of_cell(self.models, cell);
            let target = Rolled::new(&model, &question).ok()?;
            return Some(rolled(&model, target, start.map(|(_, state)| state), &options, self.cancel));
        }
        let direction = Direction::of_degrees(task.direction_deg);
        let curl = Curl { direction, sign: task.side(), strains: self.strains };
        Some(match start {
            Some(start) => roll_from(self.models, start, curl, &options, self.cancel),
            None => tightest_roll(self.models, curl, &options, self.cancel),
        })
    }

    /// The value of a roll, more where it goes further.
    fn reach(&self, roll: &KnownRoll) -> f64 {
        let sign = match self.question.goal {
            Goal::Curvature { .. } => roll.task.side(),
            _ => self.question.sense.sign(),
        };
        roll.certified.as_ref().map_or(f64::NEG_INFINITY, |(value, ..)| sign * value)
    }

    /// The states of which the roll `task` is an image, as images: those of certified rolls, the farthest first.
    fn images<'k>(
        &self,
        known: &'k [KnownRoll],
        task: RollTask,
    ) -> impl Iterator<Item = (&'k KnownRoll, (Cell, State))> {
        let mut from: Vec<&KnownRoll> = known.iter().collect();
        from.sort_by(|a, b| self.reach(b).total_cmp(&self.reach(a)));
        from.into_iter().filter_map(move |roll| {
            let (_, cell, state) = roll.certified.as_ref()?;
            let operation = self.leading(roll.task, task)?;
            let image = operation.cell(*cell)?;
            let (here, there) = (of_cell(self.models, *cell), of_cell(self.models, image));
            let image = Image::new(operation, &here, &there)?;
            Some((roll, (there.cell, image.state(state))))
        })
    }

    /// The roll from the image of another one; `None` where it does not come as far.
    fn image(&self, from: &KnownRoll, task: RollTask, start: (Cell, State)) -> Option<Answer> {
        let answer = self.answer(task, Some(start))?;
        let reach = self.reach(&KnownRoll::new(task, &answer));
        let KnownRoll { n_starts, n_distinct, better_chance, .. } = *from;
        (reach > self.reach(from) - SAME).then_some(Answer { n_starts, n_distinct, better_chance, ..answer })
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
                    let Some(start) = self.start(&known[from], &known[to]) else { continue };
                    to_hand[to] |= self.improve(&mut known[to], start, finished);
                }
            }
        }
    }

    /// Tries a roll from another state; whether it goes further.
    fn improve(
        &self,
        known: &mut KnownRoll,
        start: (Cell, State),
        finished: &mut dyn FnMut(RollTask, &Answer, f64),
    ) -> bool {
        if self.cancel.load(Ordering::Relaxed) {
            return false;
        }
        let (begun, task) = (Instant::now(), known.task);
        let Some(answer) = self.answer(task, Some(start)) else { return false };
        if self.reach(&KnownRoll::new(task, &answer)) <= self.reach(known) + SAME {
            return false;
        }
        let answer = Answer {
            n_starts: known.n_starts.map(|starts| starts + answer.runs),
            n_distinct: known.n_distinct.map(|distinct| distinct + 1),
            better_chance: known.better_chance,
            ..answer
        };
        finished(task, &answer, begun.elapsed().as_secs_f64());
        *known = KnownRoll::new(task, &answer);
        true
    }

    /// Rolls to which the roll at `place` of `order` hands its state: on the same side along the nearest direction to the left and to the right, and
    /// its images.
    fn beside(&self, known: &[KnownRoll], order: &[usize], place: usize) -> Vec<usize> {
        let (n, from) = (order.len(), &known[order[place]]);
        let nearest = |step: usize| {
            let others = (1..n).map(|k| order[(place + step * k) % n]);
            let same_side = |&to: &usize| known[to].task.above == from.task.above;
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
        self.leading(from.task, to.task).is_some()
    }

    /// The first operation that makes one roll the image of another.
    fn leading(&self, from: RollTask, to: RollTask) -> Option<&Operation> {
        self.operations.iter().find(|operation| leads_to(operation, from, to, self.strains.shear))
    }

    /// The state of one roll as a start of another one: its image where it is one, and goes further.
    fn start(&self, from: &KnownRoll, to: &KnownRoll) -> Option<(Cell, State)> {
        let (_, cell, state) = from.certified.as_ref()?;
        if !self.is_image(from, to) {
            return Some((*cell, state.clone()));
        }
        let further = self.reach(from) > self.reach(to) + SAME;
        let image = self.images(std::slice::from_ref(from), to.task).next();
        image.filter(|_| further).map(|(_, start)| start)
    }
}
