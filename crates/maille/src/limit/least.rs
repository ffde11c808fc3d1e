//! The least l1 of a direction: how far a sheet can be pushed together, by the program of a limit with −l1 maximised.
//!
//! Rings can fold in many ways, and a larger cell can fold where a smaller one cannot, so all cells are searched, each from
//! the same number of shaken starts, from the smallest cell's answer repeated, and from what the cell found at the
//! neighbouring l2. No bound from below is known, and a still larger cell can fold further: such a limit is `local` at best.

use super::{
    CellTrend, ExactFigures, LimitOutcome,
    climb::{shaken_from, tiled},
    exact::{ExactMethod, Tally},
    pull::Strained,
};
use crate::{
    bound::{Bound, best_bound_across},
    record::Status,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicBool, Ordering};

/// Shake of the smallest cell's answer, repeated over a larger cell.
const CELL_SHAKE: f64 = 0.1;

/// What each cell found, for the next l2.
type Neighbours = Vec<Option<Strained>>;

impl ExactMethod<'_> {
    /// The least l1 for each of `l2`, taken in `order`; from l2 = 0 outwards each has its neighbour's states as starts.
    pub(super) fn least_limits(
        &self,
        direction_deg: f64,
        l2: &[f64],
        order: &[usize],
        cancel: &AtomicBool,
        finished: &mut dyn FnMut(usize, LimitOutcome),
    ) {
        let mut sides: [Neighbours; 2] = [vec![None; self.models.len()], vec![None; self.models.len()]];
        for &k in order {
            let (outcome, found) = self.least(direction_deg, l2[k], &sides[usize::from(l2[k] > 0.0)], cancel);
            for (side, belongs) in sides.iter_mut().zip([l2[k] <= 0.0, l2[k] >= 0.0]) {
                for (known, new) in side.iter_mut().zip(&found).filter(|(_, new)| belongs && new.is_some()) {
                    known.clone_from(new);
                }
            }
            finished(k, outcome);
        }
    }

    fn least(
        &self,
        direction_deg: f64,
        l2: f64,
        neighbours: &Neighbours,
        cancel: &AtomicBool,
    ) -> (LimitOutcome, Neighbours) {
        let across = self.options.across;
        let mut found: Neighbours = vec![None; self.models.len()];
        let bound = best_bound_across(&self.chain, Some(&self.link), direction_deg, l2, across);
        if let Bound::L2Unreachable { .. } = bound {
            return (self.nothing(Status::L2Unreachable, ExactFigures::of_bound(&bound)), found);
        }
        if let Some(overlapping) = &self.overlapping {
            let outcome = self.nothing(Status::InfeasibleStart, ExactFigures::default());
            return (LimitOutcome { note: Some(overlapping.words()), ..outcome }, found);
        }
        let mut trend = Vec::new();
        let (mut cell, mut best): (usize, Option<Tally>) = (0, None);
        let (mut runs, mut iterations, mut distinct) = (0, 0, Vec::new());
        for larger in 0..self.models.len() {
            let model = &self.models[larger];
            let repeated = found[0].clone().filter(|_| larger > 0).map(|from| {
                let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed.wrapping_add(larger as u64));
                let state = shaken_from(model, &tiled(model, &from.state), CELL_SHAKE, &mut rng);
                Strained { state, ..from }
            });
            let known = repeated.into_iter().chain(neighbours[larger].clone());
            let starts = known.chain(self.fresh(larger, 0..self.options.starts.max(1))).collect();
            // No bound is attained, so every start is solved.
            let tally = self.search(larger, direction_deg, l2, starts, (f64::INFINITY, across), cancel);
            if cancel.load(Ordering::Relaxed) {
                return (self.nothing(Status::Interrupted, ExactFigures::default()), found);
            }
            // What was maximised is −l1.
            let found_here = tally.trend(larger);
            trend.push(CellTrend { value: found_here.value.map(|x| -x), ..found_here });
            found[larger] = tally.best.as_ref().map(|b| Strained::at(b, self.sign(), l2, across));
            (runs, iterations) = (runs + tally.runs, iterations + tally.iterations);
            distinct.extend(tally.distinct.iter().copied());
            if tally.goes_further(best.as_ref()) {
                (cell, best) = (larger, Some(tally));
            }
        }
        let tally = Tally { runs, iterations, distinct: apart(distinct), best: best.and_then(|tally| tally.best) };
        let figures = ExactFigures { trend, ..ExactFigures::default() };
        let outcome = self.judge(cell, direction_deg, l2, f64::INFINITY, tally, figures, cancel);
        (outcome, found)
    }
}

impl CellTrend {
    /// In words, as `1x1 -0.037600000 (8 starts, 3 limits)`; `cell` is its name.
    pub fn words(&self, cell: &str) -> String {
        let value = self.value.map_or("none".to_owned(), |x| format!("{x:.9}"));
        format!("{cell} {value} ({} starts, {} limits)", self.n_starts, self.n_distinct)
    }
}

/// Values that are apart by more than what makes two the same.
fn apart(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values.dedup_by(|a, b| (*a - *b).abs() < super::exact::SAME_LIMIT);
    values
}
