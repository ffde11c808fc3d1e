//! The limit of one pull by the exact method: l1 is maximised subject to every gap ≥ 0, the result is certified, and
//! compared with a proven bound.
//!
//! What a certificate claims: the state is feasible to rounding, its links are those of the start and were never
//! crossed on the way, and no small motion raises l1, to second order. What it does not claim: that no distant state
//! is better (only an attained bound proves that), nor that a path without overlap leads there from the start.

use super::{
    CellTrend, ExactFigures, LimitOutcome,
    climb::{ROUNDS, Solve, climb, own_image_force, shaken_from, tiled},
    overlap::{self, Overlapping, beyond_repair},
    pull::{Family, Strained},
};
use crate::{
    bound::{Bound, ChainBound, ImageBound, LinkBound, NearImages, best_bound_across},
    constraint::SheetProgram,
    lattice::Across,
    model::Model,
    record::Status,
    solve::{
        certificate::{GAP_TOLERANCE, RESIDUAL_TOLERANCE},
        sqp::{SqpOptions, maximize},
    },
    state::State,
    symmetry::{Image, Operation, between, operations, same_direction},
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};
use std::{
    ops::Range,
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
};

/// Parameters of the exact method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactOptions {
    /// Starts of a limit whose bound is not attained: the neighbouring limit's state, then shaken design states.
    pub starts: usize,
    /// Seed of the shaking.
    pub seed: u64,
    /// Whether width and shear are held or left to the sheet.
    #[serde(default)]
    pub across: Across,
    /// Whether l1 is made as small as can be, not as large.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub compression: bool,
}

/// The options with everything that is fixed: what a record needs to repeat a run.
#[derive(Clone, Debug, Serialize)]
pub struct ExactParameters {
    #[serde(flatten)]
    options: ExactOptions,
    gap_tolerance: f64,
    residual_tolerance: f64,
    bound_attained_within: f64,
    same_limit_within: f64,
    kicks: usize,
    larger_cell_kicks: usize,
    rounds: usize,
    shakes: [f64; 6],
    more_starts: usize,
    cell_shakes: [f64; 1],
    cell_starts: usize,
    own_image_force: f64,
    free_slack: f64,
    rung: f64,
    best_rungs: usize,
    widths: usize,
    nearly: f64,
    nearly_tries: u64,
    nearly_shake: f64,
    slight_overlap: f64,
    freeing_shakes: [f64; overlap::STARTS],
}

impl ExactOptions {
    /// All parameters and tolerances of a run.
    pub fn parameters(&self) -> ExactParameters {
        ExactParameters {
            options: self.clone(),
            gap_tolerance: GAP_TOLERANCE,
            residual_tolerance: RESIDUAL_TOLERANCE,
            bound_attained_within: ATTAINED,
            same_limit_within: SAME_LIMIT,
            kicks: KICKS,
            larger_cell_kicks: LARGER_CELL_KICKS,
            rounds: ROUNDS,
            shakes: SHAKES,
            more_starts: MORE_STARTS,
            cell_shakes: CELL_SHAKES,
            cell_starts: CELL_STARTS,
            own_image_force: OWN_IMAGE_FORCE,
            free_slack: FREE_SLACK,
            rung: RUNG,
            best_rungs: BEST_RUNGS,
            widths: WIDTHS,
            nearly: NEARLY,
            nearly_tries: NEARLY_TRIES,
            nearly_shake: NEARLY_SHAKE,
            slight_overlap: overlap::SLIGHT,
            freeing_shakes: overlap::SHAKES,
        }
    }
}

impl Default for ExactOptions {
    fn default() -> Self {
        ExactOptions { starts: 4, seed: 1, across: Across::HELD, compression: false }
    }
}

/// Limits that differ by less are the same.
pub(super) const SAME_LIMIT: f64 = 1e-7;
/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// Amplitudes of the shaken starts, in reference radii and radians.
const SHAKES: [f64; 6] = [0.03, 0.1, 0.3, 0.05, 0.2, 0.02];
/// Kicks of a solve whose certificate stays incomplete.
const KICKS: usize = 6;
/// The same in larger cells, where a solve is costly.
const LARGER_CELL_KICKS: usize = 1;
/// A force between an element and its own image above this (per unit pull) calls for a larger cell.
const OWN_IMAGE_FORCE: f64 = 1e-6;
/// Further starts where none reached the wanted l2.
const MORE_STARTS: usize = 6;
/// Shake of the smaller cell's state that starts a larger cell's solve.
const CELL_SHAKES: [f64; 1] = [0.1];
/// Starts of a larger cell of its own, at most: its solves are costly.
const CELL_STARTS: usize = 3;

/// A certified l1 that is short of its bound by less than this is climbed on from there: in cells of many elements contacts
/// that hardly carry can hold it.
const NEARLY: f64 = 1e-6;
/// So often at most.
const NEARLY_TRIES: u64 = 3;
/// With its state shaken by this.
const NEARLY_SHAKE: f64 = 0.003;

/// What l1 gives way, relative to 1 + l1, while the ranges of what is free are found.
pub(super) const FREE_SLACK: f64 = 1e-6;
/// With l2 free: distance of the held l2 whose limits are starts.
const RUNG: f64 = 0.125;
/// As many of the largest of them are starts.
const BEST_RUNGS: usize = 3;
/// Times that the limit with l2 held where it was found is asked for, at most.
const WIDTHS: usize = 3;

/// Finds limits of one sheet by the exact method.
pub struct ExactMethod<'a> {
    pub(super) models: &'a [Model],
    pub(super) options: ExactOptions,
    pub(super) chain: ChainBound,
    pub(super) link: LinkBound,
    /// Found where a limit is not reached.
    image: OnceLock<ImageBound>,
    /// Symmetries of the design that keep the first cell.
    operations: Vec<Operation>,
    /// Where no search can begin.
    pub(super) overlapping: Option<Overlapping>,
}

impl<'a> ExactMethod<'a> {
    /// Prepares the bounds. `models` are the same design compiled for cells of growing size: the first is solved, the
    /// others where it asks for more (see [`Self::limits`]). After `cancel` limits come back as interrupted. Panics if there is none.
    pub fn new(models: &'a [Model], options: ExactOptions, cancel: &AtomicBool) -> Self {
        let chain = ChainBound::new(&models[0]);
        // A larger cell's program is convex and symmetric under the shifts of the design's own cell: the mean of a solution over
        // them is one too, so that the own cell has the same bound.
        let link = LinkBound::new(&models[0].primitive(), &chain);
        let overlapping = beyond_repair(&models[0], options.seed, cancel);
        let operations = operations(&models[0]);
        ExactMethod { models, options, chain, link, image: OnceLock::new(), operations, overlapping }
    }

    /// The limits along one direction, in the order of `l2`. Solved outwards from l2 = 0, each from its neighbour's state.
    ///
    /// With compression the least l1, see the `least` module. Where an element presses on its own image, or a compression is not reached, the larger cells are solved too, from the
    /// smaller cell's state; the largest limit counts, and the outcome says which cell gave it.
    /// `finished` gets each limit with its index in `l2`; after `cancel` the rest comes back as interrupted.
    pub fn limits(
        &self,
        direction_deg: f64,
        l2: &[f64],
        cancel: &AtomicBool,
        finished: &mut dyn FnMut(usize, LimitOutcome),
    ) {
        let mut order: Vec<usize> = (0..l2.len()).collect();
        order.sort_by(|&a, &b| l2[a].abs().total_cmp(&l2[b].abs()).then(l2[a].total_cmp(&l2[b])));
        if self.options.compression {
            return self.least_limits(direction_deg, l2, &order, cancel, finished);
        }
        let (mut above, mut below): (Option<Strained>, Option<Strained>) = (None, None);
        if !l2.contains(&0.0) {
            let at_zero = self.limit(direction_deg, 0.0, None, cancel).1;
            (above, below) = (at_zero.clone(), at_zero);
        }
        for k in order {
            let neighbour = if l2[k] > 0.0 { above.clone() } else { below.clone() };
            let (outcome, reached) = self.limit(direction_deg, l2[k], neighbour, cancel);
            if let Some(reached) = reached {
                if l2[k] >= 0.0 {
                    above = Some(reached.clone());
                }
                if l2[k] <= 0.0 {
                    below = Some(reached);
                }
            }
            finished(k, outcome);
        }
    }

    /// One limit; with the first cell's state at it, from which the next one goes on.
    fn limit(
        &self,
        direction_deg: f64,
        l2: f64,
        neighbour: Option<Strained>,
        cancel: &AtomicBool,
    ) -> (LimitOutcome, Option<Strained>) {
        let across = self.options.across;
        let bound = best_bound_across(&self.chain, Some(&self.link), direction_deg, l2, across);
        let figures = ExactFigures::of_bound(&bound);
        let ended = |status, note: &str| {
            let mut outcome = self.nothing(status, figures.clone());
            outcome.note = (!note.is_empty()).then(|| note.to_owned());
            (outcome, None)
        };
        if cancel.load(Ordering::Relaxed) {
            return ended(Status::Interrupted, "");
        }
        if let (Some(overlapping), Bound::Unbounded | Bound::Finite { .. }) = (&self.overlapping, &bound) {
            return ended(Status::InfeasibleStart, &overlapping.words());
        }
        let most = match bound {
            Bound::Unbounded => return self.unlinked(direction_deg, l2, neighbour, cancel),
            Bound::L2Unreachable { .. } => return ended(Status::L2Unreachable, ""),
            Bound::Finite { l1, .. } => l1,
        };
        let mut starts: Vec<Strained> = neighbour.iter().cloned().collect();
        let fresh = self.options.starts.max(1) - starts.len();
        let (rungs, rung_runs, rung_iterations) = self.rungs(direction_deg, cancel);
        starts.extend(rungs);
        starts.extend(self.fresh(0, 0..fresh));
        starts.extend(self.of_images(direction_deg, 0..fresh));
        let mut first = self.search(0, direction_deg, l2, starts, (most, across), cancel);
        (first.runs, first.iterations) = (first.runs + rung_runs, first.iterations + rung_iterations);
        self.widths(&mut first, direction_deg, l2, (most, across), cancel);
        let near = if first.best.is_none() && !across.any() { self.too_near(direction_deg, l2, most) } else { None };
        if first.best.is_none() && near.is_none() {
            // Not reached: try harder before giving up.
            let more = self.fresh(0, fresh..fresh + MORE_STARTS).collect();
            let again = self.search(0, direction_deg, l2, more, (most, across), cancel);
            first = Tally { runs: first.runs + again.runs, iterations: first.iterations + again.iterations, ..again };
        }
        let reached = first.best.as_ref().map(|b| Strained::at(b, 1.0, l2, across));
        let mut tally = first;
        let mut trend = vec![tally.trend(0)];
        let mut cell = 0;
        // Under lateral compression a larger cell can fold where this one cannot.
        let asks = tally
            .best
            .as_ref()
            .map_or(l2 < 0.0, |best| own_image_force(&self.models[0], &best.contacts) > OWN_IMAGE_FORCE);
        let last = self.models.len() - 1;
        for larger in 1..self.models.len() {
            // The last cell is for limits that have grown.
            let idle = larger == last && larger > 1 && cell == 0 && tally.best.is_some();
            if !asks || idle || tally.attains(most) || cancel.load(Ordering::Relaxed) {
                break;
            }
            let from = reached.clone().or_else(|| neighbour.clone());
            let from = from.unwrap_or_else(|| Strained::start(self.models[0].start.clone()));
            let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed.wrapping_add(larger as u64));
            let shaken = CELL_SHAKES.iter().map(|&size| {
                let state = tiled(&self.models[larger], &from.state);
                Strained { state: shaken_from(&self.models[larger], &state, size, &mut rng), ..from.clone() }
            });
            // Then those of this cell solved alone: the smaller cell's answer can hide what they find.
            // With the width free a solve is long, and folds are found from the smaller cell's state.
            let own = if across.any() { 0 } else { self.options.starts.min(CELL_STARTS) };
            let starts = shaken.chain(self.fresh(larger, 0..own)).collect();
            let found = self.search(larger, direction_deg, l2, starts, (most, across), cancel);
            trend.push(found.trend(larger));
            let better = found.goes_further(Some(&tally));
            let (runs, iterations) = (tally.runs + found.runs, tally.iterations + found.iterations);
            if better {
                (cell, tally) = (larger, found);
            }
            (tally.runs, tally.iterations) = (runs, iterations);
        }
        if cancel.load(Ordering::Relaxed) {
            return ended(Status::Interrupted, "");
        }
        if let (None, Some(near)) = (&tally.best, &near) {
            let name = &self.models[0].elements[near.element].name;
            let [p, q] = near.shift;
            let note = format!(
                "in this cell element `{name}` and its image at ({p}, {q}) would be {:.3} R apart, which cannot be less than {:.3} R",
                near.distance, near.least
            );
            return ended(Status::L2Unreachable, &note);
        }
        let trend = if trend.len() > 1 { trend } else { Vec::new() };
        let figures = ExactFigures { trend, ..figures };
        let outcome = self.judge(cell, direction_deg, l2, most, tally, figures, cancel);
        (outcome, reached)
    }

    /// Own images that would be too near in the first cell, whatever l1 up to its bound `most`.
    fn too_near(&self, direction_deg: f64, l2: f64, most: f64) -> Option<NearImages> {
        let model = &self.models[0];
        let family = Family::new(model, direction_deg, Across::HELD);
        let [a1, a2] = family.lattice(most, l2, 0.0);
        let state = State { poses: Vec::new(), a1, a2 };
        self.image.get_or_init(|| ImageBound::new(model)).too_near(model, &state)
    }

    pub(super) fn nothing(&self, status: Status, figures: ExactFigures) -> LimitOutcome {
        LimitOutcome {
            status,
            state: self.models[0].start.clone(),
            gradient: nalgebra::Matrix2::identity(),
            residual: None,
            iterations: 0,
            runs: 0,
            note: None,
            exact: Some(figures),
            steps: Vec::new(),
        }
    }

    /// With l2 free: the states at the largest of the limits with l2 held, found outwards from 0; with what they cost.
    fn rungs(&self, direction_deg: f64, cancel: &AtomicBool) -> (Vec<Strained>, u64, u64) {
        let (mut rungs, mut runs, mut iterations) = (Vec::new(), 0, 0);
        if !self.options.across.lateral_free {
            return (rungs, runs, iterations);
        }
        for step in [RUNG, -RUNG] {
            let mut from: Vec<Strained> = self.fresh(0, 0..1).collect();
            for k in i32::from(step < 0.0).. {
                let l2 = f64::from(k) * step;
                if l2 <= -1.0 || cancel.load(Ordering::Relaxed) {
                    break;
                }
                let Bound::Finite { l1: most, .. } = self.chain.limit(direction_deg, l2) else { break };
                let found = self.search(0, direction_deg, l2, from, (most, Across::HELD), cancel);
                (runs, iterations) = (runs + found.runs, iterations + found.iterations);
                let Some(best) = &found.best else { break };
                let rung = Strained::at(best, 1.0, l2, Across::HELD);
                from = vec![rung.clone()];
                rungs.push(rung);
            }
        }
        rungs.sort_by(|a, b| b.l1.total_cmp(&a.l1));
        rungs.truncate(BEST_RUNGS);
        (rungs, runs, iterations)
    }

    /// With l2 free: the limit with l2 held where it was found, and on from there with l2 free, as long as that gives more.
    fn widths(
        &self,
        tally: &mut Tally,
        direction_deg: f64,
        l2: f64,
        (most, across): (f64, Across),
        cancel: &AtomicBool,
    ) {
        let held = Across { lateral_free: false, ..across };
        for _ in 0..WIDTHS {
            let Some(best) = tally.best.as_ref().filter(|_| across.lateral_free && !tally.attains(most)) else {
                return;
            };
            let at = Strained::at(best, 1.0, l2, across);
            let starts = std::iter::once(at.clone()).chain(self.fresh(0, 0..self.options.starts)).collect();
            let found = self.search(0, direction_deg, at.l2, starts, (f64::INFINITY, held), cancel);
            (tally.runs, tally.iterations) = (tally.runs + found.runs, tally.iterations + found.iterations);
            let better = found.best.filter(|solve| solve.x.p[0] > best.x.p[0] + SAME_LIMIT);
            let Some(from) = better.map(|solve| Strained::at(&solve, 1.0, at.l2, held)) else { return };
            let again = self.search(0, direction_deg, l2, vec![from], (most, across), cancel);
            (tally.runs, tally.iterations) = (tally.runs + again.runs, tally.iterations + again.iterations);
            if !again.goes_further(Some(tally)) {
                return;
            }
            let Tally { best, distinct, .. } = again;
            tally.best = best;
            tally.distinct.extend(distinct);
        }
    }

    /// 1 where l1 is made as large as can be, −1 where as small.
    pub(super) fn sign(&self) -> f64 {
        if self.options.compression { -1.0 } else { 1.0 }
    }

    fn family(&self, model: &Model, direction_deg: f64, across: Across) -> Family {
        let family = Family::new(model, direction_deg, across);
        if self.options.compression { family.least() } else { family }
    }

    /// A search in one cell, before its first solve.
    pub(super) fn searching<'s>(
        &'s self,
        cell: usize,
        direction_deg: f64,
        l2: f64,
        across: Across,
        cancel: &'s AtomicBool,
    ) -> Search<'s> {
        let model = &self.models[cell];
        let family = self.family(model, direction_deg, across);
        Search { model, seed: self.options.seed, family, l2, cancel, iterations: 0, runs: 0 }
    }

    /// Solves `starts` in one cell until the bound is attained; keeps the best.
    pub(super) fn search(
        &self,
        cell: usize,
        direction_deg: f64,
        l2: f64,
        starts: Vec<Strained>,
        (most, across): (f64, Across),
        cancel: &AtomicBool,
    ) -> Tally {
        let model = &self.models[cell];
        let mut search = self.searching(cell, direction_deg, l2, across, cancel);
        let mut tally = Tally::default();
        for start in starts {
            if cancel.load(Ordering::Relaxed) {
                break;
            }
            let Some(mut solve) = search.solve(start) else { continue };
            for round in 1..=NEARLY_TRIES {
                let short = most - solve.x.p[0];
                if !solve.certified || !(ATTAINED..NEARLY).contains(&short) || cancel.load(Ordering::Relaxed) {
                    break;
                }
                let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed.wrapping_add(round));
                let from = Strained::at(&solve, self.sign(), l2, across);
                let state = shaken_from(model, &from.state, NEARLY_SHAKE, &mut rng);
                match search.solve(Strained { state, ..from }) {
                    Some(again) if (again.certified, again.x.p[0]) > (true, solve.x.p[0]) => solve = again,
                    _ => {}
                }
            }
            let l1 = solve.x.p[0];
            if solve.certified && !tally.distinct.iter().any(|other| (other - l1).abs() < SAME_LIMIT) {
                tally.distinct.push(l1);
            }
            if tally.best.as_ref().is_none_or(|b| (solve.certified, l1) > (b.certified, b.x.p[0])) {
                tally.best = Some(solve);
            }
            if tally.attains(most) {
                break;
            }
        }
        (tally.iterations, tally.runs) = (search.iterations, search.runs);
        tally
    }

    /// Status and figures of the best solve.
    pub(super) fn judge(
        &self,
        cell: usize,
        direction_deg: f64,
        l2: f64,
        most: f64,
        tally: Tally,
        mut figures: ExactFigures,
        cancel: &AtomicBool,
    ) -> LimitOutcome {
        figures.n_starts = tally.runs;
        figures.n_distinct = tally.distinct.len() as u64;
        figures.cell = cell;
        let attained = tally.attains(most);
        let (mut iterations, runs) = (tally.iterations, tally.runs);
        let Some(best) = tally.best else {
            let note = Some("no start reached this l2 without overlap; nothing is proved".to_owned());
            return LimitOutcome {
                iterations,
                runs,
                note,
                ..self.nothing(Status::L2NotReached, ExactFigures { cell: 0, ..figures })
            };
        };
        let l1 = self.sign() * best.x.p[0];
        figures.own_image_force = Some(own_image_force(&self.models[cell], &best.contacts));
        let model = &self.models[cell];
        let across = self.options.across;
        let family = self.family(model, direction_deg, across);
        let gradient = family.gradient(&best.x.p, l2);
        if across.any() && best.certified {
            let (free, more) = family.ranges(model, &best, l2, cancel);
            let at = family.free_of(&best.x.p, l2);
            figures.free = Some(family.attainable(free, (&self.chain, &self.link), direction_deg, l1, at));
            iterations += more;
        }
        let residual = Some((-best.certificate.smallest_gap).max(0.0));
        figures.contacts = best.contacts;
        figures.links_ok = Some(best.links_ok);
        figures.certificate = Some(best.certificate);
        let above_bound = l1 > most + ATTAINED;
        let status = match (best.certified && !above_bound, attained) {
            (true, true) => Status::Global,
            (true, false) => Status::Local,
            (false, _) => Status::Uncertified,
        };
        if status == Status::Uncertified {
            figures.l1_uncertified = Some(l1);
        }
        let note = above_bound.then(|| format!("l1 = {l1} lies above its proven bound {most}: one of them is wrong"));
        let (state, exact, steps) = (best.x.state, Some(figures), Vec::new());
        LimitOutcome { status, state, gradient, residual, iterations, runs, note, exact, steps }
    }

    /// Starts of the first cell that stand for those of the directions that are images of this one: the images of the same shaken
    /// states. So a limit is searched from as many states as if each direction of its orbit were solved by itself.
    fn of_images(&self, direction_deg: f64, starts: Range<usize>) -> Vec<Strained> {
        let model = &self.models[0];
        let mut seen = vec![direction_deg.rem_euclid(180.0)];
        let mut out = Vec::new();
        for operation in &self.operations {
            let to_deg = operation.direction_deg(direction_deg);
            if seen.iter().any(|&known| same_direction(known, to_deg)) {
                continue;
            }
            seen.push(to_deg);
            let back = between(&self.operations, to_deg, direction_deg).next();
            if let Some(image) = back.and_then(|operation| Image::new(operation, model, model)) {
                out.extend(self.fresh(0, starts.clone()).map(|start| Strained::start(image.state(&start.state))));
            }
        }
        out
    }

    /// Starts of a cell: the design's state, every element moved and turned at random, but no circle across another.
    pub(super) fn fresh(&self, cell: usize, starts: Range<usize>) -> impl Iterator<Item = Strained> {
        let model = &self.models[cell];
        starts.map(move |k| {
            let seed = self.options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(k as u64);
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            let state = shaken_from(model, &model.start, SHAKES[k % SHAKES.len()], &mut rng);
            Strained::start(state)
        })
    }
}

/// What the solves of one cell found.
#[derive(Default)]
pub(super) struct Tally {
    pub(super) best: Option<Solve>,
    pub(super) distinct: Vec<f64>,
    pub(super) iterations: u64,
    pub(super) runs: u64,
}

impl Tally {
    /// What it found, as that of the cell `cell`.
    pub(super) fn trend(&self, cell: usize) -> CellTrend {
        let value = self.best.as_ref().filter(|b| b.certified).map(|b| b.x.p[0]);
        CellTrend { cell, value, n_starts: self.runs, n_distinct: self.distinct.len() as u64 }
    }

    /// Whether it has a better limit than `other`: certified first, and more than the same.
    pub(super) fn goes_further(&self, other: Option<&Tally>) -> bool {
        match (&self.best, other.and_then(|tally| tally.best.as_ref())) {
            (Some(new), Some(old)) => (new.certified, new.x.p[0]) > (old.certified, old.x.p[0] + SAME_LIMIT),
            (new, _) => new.is_some(),
        }
    }

    fn attains(&self, most: f64) -> bool {
        self.best.as_ref().is_some_and(|b| b.certified && (b.x.p[0] - most).abs() <= ATTAINED)
    }
}

/// The solves of one limit in one cell.
pub(super) struct Search<'a> {
    pub(super) model: &'a Model,
    seed: u64,
    pub(super) family: Family,
    pub(super) l2: f64,
    pub(super) cancel: &'a AtomicBool,
    pub(super) iterations: u64,
    pub(super) runs: u64,
}

impl Search<'_> {
    /// From a start: first l2 is brought to its value with l1 free, then l1 is maximised. `None` where l2 is not reached.
    fn solve(&mut self, from: Strained) -> Option<Solve> {
        self.runs += 1;
        let at = self.at_lateral(from)?;
        let model = self.model;
        let pull = self.family.pull(self.l2);
        let mut program = SheetProgram::new(model, &pull);
        let p = self.family.parameters(&at);
        let x = program.posed(at.state, p);
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ self.runs);
        let kicks = if model.cell.copies() > 1 { LARGER_CELL_KICKS } else { KICKS };
        let found = climb(model, &mut program, x, kicks, &mut rng, self.cancel);
        self.iterations += found.iterations;
        found.best
    }

    /// A state of the wanted l2, if it is reached from this one with l1 free.
    pub(super) fn at_lateral(&mut self, at: Strained) -> Option<Strained> {
        if at.l2 == self.l2 || self.family.across.lateral_free {
            return Some(at);
        }
        let pull = self.family.approach(&at, self.l2);
        let program = SheetProgram::new(self.model, &pull);
        let enough = (self.l2 - at.l2).abs() - 1e-9;
        let start = program.posed(at.state, vec![at.l1, 0.0]);
        let options = SqpOptions { enough, ..SqpOptions::default() };
        let end = maximize(&program, start, Vec::new(), &options, self.cancel);
        self.iterations += end.iterations as u64;
        if end.point.p[1] < enough - 1e-9 || end.violation > 1e-6 {
            return None;
        }
        Some(Strained { l1: end.point.p[0], state: end.point.state, l2: self.l2, shear: at.shear })
    }
}
