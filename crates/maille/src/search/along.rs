//! The limits along one direction: each is solved from its neighbour's states, outwards from l2 = 0. Least limits are also handed
//! back inwards: a fold that is found only at a strong lateral compression can go furthest at a weaker one, too.

use super::{
    multistart::{CellStarts, SearchResult, Target},
    options::{ExactOptions, SAME_VALUE},
    starts::Start,
    stop::StopRule,
    stretch::{ExactMethod, Stretch},
};
use crate::{
    answer::{Answer, CellTrend},
    lattice::{Cell, Direction},
    model::of_cell,
    record::Status,
};
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// A limit that is solved, with what its neighbours begin with.
struct Solved {
    /// Its place among those that are asked for.
    place: usize,
    answer: Answer,
    starts: CellStarts,
    wall_s: f64,
}

/// The states of a limit take the place of those of the limit beside it, cell by cell.
fn take_over(states: &mut CellStarts, found: &[(Cell, Start)]) {
    states.retain(|(cell, _)| found.iter().all(|(new, _)| new != cell));
    states.extend(found.iter().cloned());
}

/// Whether another state can change a limit.
fn sought(status: Status) -> bool {
    matches!(status, Status::Local | Status::Uncertified | Status::L2NotReached)
}

impl ExactMethod<'_> {
    /// The limits along one direction, in the order of `l2`. Solved outwards from l2 = 0, each from its neighbour's states; least
    /// limits then inwards again, each from its outer neighbour's states alone.
    ///
    /// Where an element presses on its own image, or a lateral compression is not reached, and of every least l1, larger cells
    /// are solved, too, from the smaller cell's state, and unstable waves are followed; the best limit counts, and the answer says which cell gave it.
    /// `begins` hears of each limit before it is solved, and `finished` gets it, with its index in `l2` and the seconds that it took;
    /// after `cancel` the rest comes back as interrupted.
    pub fn limits(
        &self,
        direction: Direction,
        l2: &[f64],
        cancel: &AtomicBool,
        begins: &dyn Fn(usize),
        finished: &mut dyn FnMut(usize, Answer, f64),
    ) {
        let ExactOptions { across, compression, .. } = self.options;
        let stretch = |l2: f64| Stretch { direction, l2, across, sign: if compression { -1.0 } else { 1.0 } };
        let mut order: Vec<usize> = (0..l2.len()).collect();
        order.sort_by(|&a, &b| l2[a].abs().total_cmp(&l2[b].abs()).then(l2[a].total_cmp(&l2[b])));
        let mut sides: [CellStarts; 2] = [Vec::new(), Vec::new()];
        let mut began = Instant::now();
        if !compression && !l2.contains(&0.0) {
            let (_, at_zero) = self.limit(&stretch(0.0), &[], cancel);
            sides = [at_zero.clone(), at_zero];
        }
        let mut held: Vec<(Stretch, Solved)> = Vec::new();
        for place in order {
            begins(place);
            let at = stretch(l2[place]);
            let (answer, starts) = self.limit(&at, &sides[usize::from(at.l2 > 0.0)], cancel);
            for (side, _) in sides.iter_mut().zip([at.l2 <= 0.0, at.l2 >= 0.0]).filter(|(_, belongs)| *belongs) {
                take_over(side, &starts);
            }
            let wall_s = began.elapsed().as_secs_f64();
            began = Instant::now();
            if compression {
                held.push((at, Solved { place, answer, starts, wall_s }));
            } else {
                finished(place, answer, wall_s);
            }
        }
        self.hand_back(&mut held, cancel);
        let stopped = cancel.load(Ordering::Relaxed);
        for (_, Solved { place, answer, wall_s, .. }) in held {
            // What was not handed back is not what a whole run finds.
            let unfinished = stopped && sought(answer.status);
            finished(place, if unfinished { self.without_state(Status::Interrupted) } else { answer }, wall_s);
        }
    }

    /// Tries the states of each limit at the one before it, from the outermost inwards on both sides; `solved` is in the order of |l2|.
    fn hand_back(&self, solved: &mut [(Stretch, Solved)], cancel: &AtomicBool) {
        for belongs in [|l2: f64| l2 <= 0.0, |l2: f64| l2 >= 0.0] {
            let mut outer: CellStarts = Vec::new();
            for (at, inner) in solved.iter_mut().rev().filter(|(at, _)| belongs(at.l2)) {
                let began = Instant::now();
                for (cell, start) in &outer {
                    self.tried_again(at, inner, *cell, start, cancel);
                }
                take_over(&mut outer, &inner.starts);
                inner.wall_s += began.elapsed().as_secs_f64();
            }
        }
    }

    /// A limit tried once more from one state; the better one is kept.
    fn tried_again(&self, at: &Stretch, solved: &mut Solved, cell: Cell, start: &Start, cancel: &AtomicBool) {
        if !sought(solved.answer.status) || cancel.load(Ordering::Relaxed) {
            return;
        }
        let model = of_cell(self.models, cell);
        let search = self.search(at, f64::INFINITY, cancel);
        let here = search.run(&model, vec![start.clone()], StopRule::given_only());
        let old = &mut solved.answer;
        (old.runs, old.iterations) = (old.runs + here.runs, old.iterations + here.iterations);
        old.n_starts = old.n_starts.map(|starts| starts + here.runs);
        let Some(best) = here.best.as_ref().filter(|best| best.certified) else { return };
        let (value, from) = (at.sign * best.value(), at.start(best));
        let less = |than: Option<f64>| than.is_none_or(|than| value < than - SAME_VALUE);
        match old.by_cell.iter_mut().find(|trend| trend.cell == cell) {
            Some(trend) if less(trend.value) => {
                trend.value = Some(value);
                trend.n_distinct += 1;
            }
            Some(_) => (),
            None => old.by_cell.push(CellTrend { cell, value: Some(value), n_starts: here.runs, n_distinct: 1 }),
        }
        if old.status == Status::Local && !less(old.value) {
            return;
        }
        take_over(&mut solved.starts, &[(cell, from)]);
        let wave = search.waves(&model, best).curvature();
        // The ranges of what is free are counted by themselves.
        let better = self.judge(&model, at, f64::INFINITY, SearchResult { iterations: 0, ..here }, cancel);
        solved.answer = Answer {
            n_starts: old.n_starts,
            n_distinct: old.n_distinct.map(|distinct| distinct + 1),
            better_chance: old.better_chance,
            runs: old.runs,
            iterations: old.iterations + better.iterations,
            by_cell: std::mem::take(&mut old.by_cell),
            wave,
            ..better
        };
    }
}
