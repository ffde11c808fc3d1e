//! The limits along one direction: each is solved from its neighbour's states, outwards from l2 = 0. Then neighbours hand states to
//! each other until none goes further: one that is found only at a strong lateral strain can go furthest at a weaker one, too.

use super::{
    multistart::{CellStarts, LargerCells},
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
    at: Stretch,
    /// Its place among those that are asked for.
    place: usize,
    answer: Answer,
    starts: CellStarts,
    wall_s: f64,
    /// Whether its states are still to be tried at the neighbour of smaller l2, and at that of larger.
    to_hand: [bool; 2],
}

/// The states of a limit take the place of those of the limit beside it, cell by cell.
fn take_over(states: &mut CellStarts, found: &[(Cell, Start)]) {
    states.retain(|(cell, _)| found.iter().all(|(new, _)| new != cell));
    states.extend(found.iter().cloned());
}

/// Whether another state can change a limit. Where a certificate contradicts a bound, that is what is to be told.
fn sought(answer: &Answer) -> bool {
    let certified = || answer.certificate.as_ref().is_some_and(|certificate| certificate.holds());
    match answer.status {
        Status::Local | Status::L2NotReached => true,
        Status::Uncertified => !certified(),
        _ => false,
    }
}

impl ExactMethod<'_> {
    /// The limits along one direction, in the order of `l2`. Solved outwards from l2 = 0, each from its neighbour's states; then
    /// states are handed on between neighbours.
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
        let mut solved: Vec<Solved> = Vec::new();
        for place in order {
            begins(place);
            let at = stretch(l2[place]);
            let (answer, starts) = self.limit(&at, &sides[usize::from(at.l2 > 0.0)], cancel);
            for (side, _) in sides.iter_mut().zip([at.l2 <= 0.0, at.l2 >= 0.0]).filter(|(_, belongs)| *belongs) {
                take_over(side, &starts);
            }
            let wall_s = began.elapsed().as_secs_f64();
            // Outer neighbours begin with them anyway.
            solved.push(Solved { at, place, answer, starts, wall_s, to_hand: [at.l2 > 0.0, at.l2 < 0.0] });
            began = Instant::now();
        }
        solved.sort_by(|a, b| a.at.l2.total_cmp(&b.at.l2));
        self.hand_on(&mut solved, cancel);
        let stopped = cancel.load(Ordering::Relaxed);
        for Solved { place, mut answer, wall_s, .. } in solved {
            if stopped && sought(&answer) {
                // What was not handed on is not what a whole run finds.
                answer = self.without_state(Status::Interrupted);
            }
            finished(place, self.without_one_trend(answer), wall_s);
        }
    }

    /// Of a largest l1 what each cell gave is told where it is more than one.
    pub(super) fn without_one_trend(&self, mut answer: Answer) -> Answer {
        if !self.options.compression && answer.by_cell.len() == 1 {
            answer.by_cell.clear();
        }
        answer
    }

    /// Tries the states of each limit at its neighbours, to and fro, until none goes further; `solved` is in the order of l2.
    fn hand_on(&self, solved: &mut [Solved], cancel: &AtomicBool) {
        let pairs = |n: usize| (1..n).rev().map(|k| (k, k - 1, 0)).chain((1..n).map(|k| (k - 1, k, 1)));
        let mut handed = true;
        while std::mem::take(&mut handed) {
            for (from, to, side) in pairs(solved.len()) {
                if !std::mem::take(&mut solved[from].to_hand[side]) {
                    continue;
                }
                handed = true;
                let began = Instant::now();
                for (cell, start) in solved[from].starts.clone() {
                    // What a smaller cell found is in the first one's starts.
                    let smaller = cell.copies() < self.models[0].cell.copies();
                    if !smaller && sought(&solved[to].answer) && !cancel.load(Ordering::Relaxed) {
                        self.tried_again(&mut solved[to], cell, start, cancel);
                    }
                }
                solved[to].wall_s += began.elapsed().as_secs_f64();
            }
        }
    }

    /// A limit tried once more from one state; the better one is kept. Where that is new, larger cells are tried from it, too.
    fn tried_again(&self, solved: &mut Solved, cell: Cell, start: Start, cancel: &AtomicBool) {
        let at = solved.at;
        let one;
        let models = if cell == self.models[0].cell {
            self.models
        } else {
            one = [of_cell(self.models, cell).into_owned()];
            &one
        };
        let old = &mut solved.answer;
        let search = self.search(&at, old.bound.unwrap_or(f64::INFINITY), cancel);
        let here = search.run(&models[0], vec![start], StopRule::given_only());
        let known =
            old.value.filter(|_| old.status == Status::Local).map_or(f64::NEG_INFINITY, |value| at.sign * value);
        let best = here.best.as_ref().filter(|best| best.certified);
        if best.is_none_or(|best| best.value() <= known + SAME_VALUE) {
            (old.runs, old.iterations) = (old.runs + here.runs, old.iterations + here.iterations);
            old.n_starts = old.n_starts.map(|starts| starts + here.runs);
            add_trend(&mut old.by_cell, at.trend(here.by_cell(cell)), at.sign);
            return;
        }
        let rule = LargerCells { every: false, own_starts: 0, where_none: false, ..self.larger(&at, None, &[]) };
        let found = search.larger_cells(models, here, &rule);
        for &trend in &found.by_cell {
            add_trend(&mut old.by_cell, at.trend(trend), at.sign);
        }
        let (model, wave) = (found.model(models).clone(), found.wave);
        take_over(&mut solved.starts, &found.starts);
        solved.to_hand = [true; 2];
        let judged = self.judge(&model, &at, search.upper_bound, found.result, cancel);
        solved.answer = Answer {
            n_starts: old.n_starts.map(|starts| starts + judged.runs),
            n_distinct: old.n_distinct.map(|distinct| distinct + 1),
            better_chance: old.better_chance.filter(|_| judged.status == Status::Local),
            runs: old.runs + judged.runs,
            iterations: old.iterations + judged.iterations,
            by_cell: std::mem::take(&mut old.by_cell),
            wave,
            bound: old.bound,
            bound_kind: old.bound_kind,
            chain: old.chain.take(),
            dual: std::mem::take(&mut old.dual),
            note: judged.note.or_else(|| old.note.take().filter(|_| old.status == Status::Local)),
            ..judged
        };
    }
}

/// Adds what a cell found to what all cells did: the better value stays.
fn add_trend(known: &mut Vec<CellTrend>, found: CellTrend, sign: f64) {
    let Some(old) = known.iter_mut().find(|trend| trend.cell == found.cell) else {
        known.push(found);
        return;
    };
    old.n_starts += found.n_starts;
    let better = |value: f64| old.value.is_none_or(|than| sign * (value - than) > SAME_VALUE);
    if let Some(value) = found.value.filter(|value| better(*value)) {
        old.value = Some(value);
        old.n_distinct += 1;
    }
}
