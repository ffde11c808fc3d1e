//! Limits of stretches by the exact method: l1 is maximised subject to every gap ≥ 0, the result is certified, and compared with
//! a proven bound.
//!
//! What a certificate claims: the state is feasible to rounding, its links are those of the start and were never
//! crossed on the way, and no small motion raises l1, to second order. What it does not claim: that no distant state
//! is better (only an attained bound proves that), nor that a path without overlap leads there from the start.
//!
//! **Compression.** The least l1 is the same program with −l1 maximised. Rings can fold in many ways, and a larger cell can fold
//! where a smaller one cannot, so all cells are searched. No bound from below is known, and a still larger cell can fold further:
//! such a limit is `local` at best.

use super::{
    local::LocalSolution,
    multistart::{CellStarts, Entered, FollowedWaves, LargerCells, Multistart, SearchResult, Target, verdict},
    options::{ATTAINED, ExactOptions, LATERAL_ROUNDS, LATERAL_STARTS, LATERAL_STEP, SAME_VALUE},
    overlap::{Overlapping, beyond_repair},
    starts::{Start, explored, explored_or_buckled},
    stop::StopRule,
    stretch_lattices::StretchLattices,
    waves::OwnCell,
};
use crate::{
    answer::{Answer, CellTrend},
    bound::{Bound, ChainBound, ImageBound, LinkBound, NearImages, best_bound_across, lowered},
    lattice::{Across, Cell, Direction},
    model::Model,
    program::{LatticeFamily, SheetProgram},
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::State,
    topology::links_kept,
};
use std::sync::{
    OnceLock,
    atomic::{AtomicBool, Ordering},
};

/// Finds limits of one sheet by the exact method.
pub struct ExactMethod<'a> {
    pub(super) models: &'a [Model],
    pub(super) options: ExactOptions,
    pub(super) chain: ChainBound,
    pub(super) link: LinkBound,
    /// Found where a limit is not reached.
    image: OnceLock<ImageBound>,
    /// Where no search can begin.
    overlapping: Option<Overlapping>,
    /// The design's own cell, where the first one is larger: its answer is a start.
    own: Option<Model>,
}

/// The stretch whose limit is sought.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub direction: Direction,
    /// Where it is held.
    pub l2: f64,
    pub across: Across,
    /// 1 where l1 is maximised, −1 where it is minimised.
    pub sign: f64,
}

impl Stretch {
    pub(crate) fn lattices(&self, model: &Model) -> StretchLattices {
        StretchLattices::new(model, self.direction, self.across, self.sign)
    }

    /// What a cell found, as l1: what was maximised is −l1 where the least is sought.
    pub(super) fn trend(&self, found: CellTrend) -> CellTrend {
        CellTrend { value: found.value.map(|value| self.sign * value), ..found }
    }
}

impl Target for Stretch {
    fn family(&self, model: &Model) -> LatticeFamily {
        self.lattices(model).pull(self.l2)
    }

    /// First l2 is brought to its value with l1 free.
    fn enter(&self, model: &Model, at: Start, cancel: &AtomicBool) -> Entered {
        let lattices = self.lattices(model);
        if at.l2 == self.l2 || self.across.lateral_free {
            let p = lattices.parameters(&at);
            return Entered { at: Some((at.state, p)), iterations: 0 };
        }
        let pull = lattices.approach(&at, self.l2);
        let program = SheetProgram::new(model, &pull);
        let enough = (self.l2 - at.l2).abs() - 1e-9;
        let start = program.posed(at.state, vec![at.l1, 0.0]);
        let options = SqpOptions { enough, ..SqpOptions::default() };
        let end = maximize(&program, start, Vec::new(), &options, cancel);
        let reached = end.point.p[1] >= enough - 1e-9 && end.violation <= 1e-6;
        let at = reached.then(|| {
            let at = Start { l1: end.point.p[0], state: end.point.state, l2: self.l2, ..at };
            let p = lattices.parameters(&at);
            (at.state, p)
        });
        Entered { at, iterations: end.iterations as u64 }
    }

    /// Where the least l1 is sought the sheet folds.
    fn explored(&self, model: &Model, seed: u64, number: usize) -> Start {
        if self.sign < 0.0 { explored_or_buckled(model, seed, number) } else { explored(model, seed, number) }
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        let mut free = solution.p[1..].iter().copied();
        let l2 = if self.across.lateral_free { free.next().unwrap_or(self.l2) } else { self.l2 };
        let shear = free.next().unwrap_or(0.0);
        Start { l1: self.sign * solution.p[0], l2, shear, ..Start::written(solution.state.clone()) }
    }
}

impl<'a> ExactMethod<'a> {
    /// Prepares the bounds. `models` are the same design compiled for cells of growing size: the first is solved, the
    /// others where it asks for more (see [`Self::limits`]). After `cancel` limits come back as interrupted.
    ///
    /// # Panics
    /// If there is no model.
    pub fn new(models: &'a [Model], options: ExactOptions, cancel: &AtomicBool) -> Self {
        let chain = ChainBound::new(&models[0]);
        // A larger cell's program is convex and symmetric under the shifts of the design's own cell: the mean of a solution over
        // them is one too, so that the own cell has the same bound.
        let link = LinkBound::new(&models[0].primitive(), &chain);
        let overlapping = beyond_repair(&models[0], options.seed, cancel);
        let own = (models[0].cell.copies() > 1).then(|| models[0].primitive());
        ExactMethod { models, options, chain, link, image: OnceLock::new(), overlapping, own }
    }

    /// One limit, with what each cell gave; and the states of the cells at it, from which the next one goes on.
    pub(super) fn limit(
        &self,
        stretch: &Stretch,
        neighbours: &[(Cell, Start)],
        cancel: &AtomicBool,
    ) -> (Answer, CellStarts) {
        let least = stretch.sign < 0.0;
        let Stretch { direction, l2, across, .. } = *stretch;
        let bound = best_bound_across(&self.chain, Some(&self.link), direction, l2, across);
        let unreachable = matches!(bound, Bound::L2Unreachable { .. });
        // The bounds are of the largest l1; of the least one they tell only that no state has this l2.
        let proved = |answer: Answer, bound: &Bound| match bound {
            Bound::Finite { .. } if least => answer,
            _ => answer.bounded_by(bound),
        };
        let ended = |status: Status, note: Option<String>, bound: &Bound| {
            (proved(Answer { note, ..self.without_state(status) }, bound), Vec::new())
        };
        if cancel.load(Ordering::Relaxed) {
            return ended(Status::Interrupted, None, &bound);
        }
        if unreachable {
            return ended(Status::L2Unreachable, None, &bound);
        }
        if let Some(overlapping) = &self.overlapping {
            return ended(Status::InfeasibleStart, Some(overlapping.message()), &bound);
        }
        let of = |cell: Cell| neighbours.iter().find(|(other, _)| *other == cell).map(|(_, start)| start.clone());
        let neighbour = of(self.models[0].cell);
        let upper_bound = match bound {
            Bound::Finite { l1, .. } if !least => l1,
            Bound::Unbounded if !least => return self.unlinked(stretch, neighbour, cancel),
            _ => f64::INFINITY,
        };
        let search = self.search(stretch, upper_bound, cancel);
        let own = self.own_cell(&search, of(Cell::PRIMITIVE));
        let mut first = if least {
            let given = own.starts.into_iter().chain(neighbour.iter().cloned()).collect();
            search.run(&self.models[0], given, self.stop())
        } else {
            self.first_cell(&search, own.starts, neighbour.clone())
        };
        (first.runs, first.iterations) = (first.runs + own.runs, first.iterations + own.iterations);
        let near =
            (first.best.is_none() && !least && !across.any()).then(|| self.too_near(stretch, upper_bound)).flatten();
        let rule = self.larger(stretch, neighbour, neighbours);
        let found = search.larger_cells(self.models, first, &rule);
        if cancel.load(Ordering::Relaxed) {
            return ended(Status::Interrupted, None, &bound);
        }
        if let (None, Some(near)) = (&found.result.best, &near) {
            return ended(Status::L2Unreachable, Some(self.near_note(near)), &bound);
        }
        let bound = self.lowered(bound, stretch, &found.result);
        let upper_bound = match bound {
            Bound::Finite { l1, .. } if !least => l1,
            Bound::L2Unreachable { .. } if found.result.best.as_ref().is_none_or(|best| !best.certified) => {
                return ended(Status::L2Unreachable, None, &bound);
            }
            // A certificate against a proof: the verdict says so.
            Bound::L2Unreachable { .. } => -1.0,
            _ => upper_bound,
        };
        let (model, wave) = (found.model(self.models).clone(), found.wave);
        let answer = proved(self.judge(&model, stretch, upper_bound, found.result, cancel), &bound);
        // Ranges of what is free are solved for after the search: without them the answer is not whole.
        if cancel.load(Ordering::Relaxed) {
            return ended(Status::Interrupted, None, &bound);
        }
        let by_cell = found.by_cell.into_iter().map(|trend| stretch.trend(trend)).collect();
        // Of a largest l1 the best cell is enough.
        let best = |cell: &Cell| least || [self.models[0].cell, model.cell].contains(cell);
        let reached = found.starts.into_iter().filter(|(cell, _)| best(cell));
        let own = own.best.map(|start| (Cell::PRIMITIVE, start));
        (Answer { by_cell, wave, ..answer }, reached.chain(own).collect())
    }

    fn near_note(&self, near: &NearImages) -> String {
        let name = &self.models[0].elements[near.element].name;
        let ([p, q], distance, least) = (near.shift, near.distance, near.least);
        format!(
            "in this cell element `{name}` and its image at ({p}, {q}) would be {distance:.3} R apart, which cannot be less than {least:.3} R"
        )
    }

    /// Which larger cells are searched.
    pub(super) fn larger<'n>(
        &self,
        stretch: &Stretch,
        neighbour: Option<Start>,
        neighbours: &'n [(Cell, Start)],
    ) -> LargerCells<'n> {
        let least = stretch.sign < 0.0;
        LargerCells {
            every: least,
            // With the width free a solve is long, and folds are found from the smaller cell's state.
            own_starts: match (least, stretch.across.any()) {
                (true, _) => self.stop().of_larger_cell(true),
                (false, true) => 0,
                (false, false) => self.stop().of_larger_cell(false),
            },
            // Under lateral compression a larger cell can fold where this one cannot.
            where_none: stretch.l2 < 0.0,
            fallback: (!least).then(|| neighbour.unwrap_or_else(|| Start::written(self.models[0].start.clone()))),
            waves: FollowedWaves::worst_if(self.models.len() > 1),
            beyond: f64::NEG_INFINITY,
            neighbours,
        }
    }

    /// The bound, or a lower one where the search does not attain it. Of the least l1 bounds only tell that no state has this l2.
    fn lowered(&self, bound: Bound, stretch: &Stretch, found: &SearchResult) -> Bound {
        let least = stretch.sign < 0.0;
        let settled = if least { found.best.is_some() } else { bound.l1().is_none_or(|l1| found.attains(l1)) };
        if settled {
            return bound;
        }
        lowered(bound, &self.link, stretch.direction, stretch.l2, stretch.across)
    }

    /// What the design's own cell gives to a larger first one.
    fn own_cell(&self, search: &Multistart<'_, Stretch>, neighbour: Option<Start>) -> OwnCell {
        let Some(own) = &self.own else { return OwnCell::default() };
        search.own_cell(own, neighbour.into_iter().collect(), self.stop(), &self.models[0])
    }

    /// The search of the first cell for a largest l1: from the states that are given, then from drawn ones.
    fn first_cell(&self, search: &Multistart<'_, Stretch>, own: Vec<Start>, neighbour: Option<Start>) -> SearchResult {
        let mut starts: Vec<Start> = own.into_iter().chain(neighbour).collect();
        let (wide, runs, iterations) = self.lateral_starts(search);
        starts.extend(wide);
        let mut found = search.run(&self.models[0], starts, self.stop());
        (found.runs, found.iterations) = (found.runs + runs, found.iterations + iterations);
        self.refine_width(search, &mut found);
        found
    }

    pub(super) fn search<'s>(
        &self,
        target: &'s Stretch,
        upper_bound: f64,
        cancel: &'s AtomicBool,
    ) -> Multistart<'s, Stretch> {
        Multistart { target, upper_bound, seed: self.options.seed, cancel }
    }

    /// When a search of the first cell stops.
    pub(super) fn stop(&self) -> StopRule {
        StopRule::of(self.options.effort, self.options.starts)
    }

    /// Own images that would be too near in the first cell, whatever l1 up to its bound.
    fn too_near(&self, stretch: &Stretch, upper_bound: f64) -> Option<NearImages> {
        let model = &self.models[0];
        let [a1, a2] = stretch.lattices(model).lattice(upper_bound, stretch.l2, 0.0);
        let state = State { poses: Vec::new(), a1, a2, roll: None };
        self.image.get_or_init(|| ImageBound::new(model)).too_near(model, &state)
    }

    /// An answer with the start for its state.
    pub(super) fn without_state(&self, status: Status) -> Answer {
        let model = &self.models[0];
        let links_ok = (status == Status::L2NotReached).then(|| links_kept(model, &model.start));
        Answer { n_starts: Some(0), n_distinct: Some(0), links_ok, ..Answer::new(model, status) }
    }

    /// With l2 free: the states at the largest of the limits with l2 held, found outwards from 0; with the local maximisations and
    /// quadratic programs that they took.
    fn lateral_starts(&self, search: &Multistart<'_, Stretch>) -> (Vec<Start>, u64, u64) {
        let (mut found, mut runs, mut iterations) = (Vec::new(), 0, 0);
        if !search.target.across.lateral_free {
            return (found, runs, iterations);
        }
        for step in [LATERAL_STEP, -LATERAL_STEP] {
            let mut from = vec![explored(&self.models[0], self.options.seed, 0)];
            for k in i32::from(step < 0.0).. {
                let held = Stretch { l2: f64::from(k) * step, across: Across::HELD, ..*search.target };
                if held.l2 <= -1.0 || search.cancel.load(Ordering::Relaxed) {
                    break;
                }
                let Bound::Finite { l1, .. } = self.chain.limit(held.direction, held.l2) else { break };
                let here = self.search(&held, l1, search.cancel).run(&self.models[0], from, StopRule::given_only());
                (runs, iterations) = (runs + here.runs, iterations + here.iterations);
                let Some(best) = &here.best else { break };
                let start = held.start(best);
                from = vec![start.clone()];
                found.push(start);
            }
        }
        found.sort_by(|a, b| b.l1.total_cmp(&a.l1));
        found.truncate(LATERAL_STARTS);
        (found, runs, iterations)
    }

    /// With l2 free: the limit with l2 held where it was found, and on from there with l2 free, as long as that gives more.
    fn refine_width(&self, search: &Multistart<'_, Stretch>, found: &mut SearchResult) {
        let (model, stretch) = (&self.models[0], search.target);
        for _ in 0..LATERAL_ROUNDS {
            let attained = found.attains(search.upper_bound);
            let Some(best) = found.best.as_ref().filter(|_| stretch.across.lateral_free && !attained) else { return };
            let at = stretch.start(best);
            let across = Across { lateral_free: false, ..stretch.across };
            let held = Stretch { l2: at.l2, across, ..*stretch };
            let here = self.search(&held, f64::INFINITY, search.cancel).run(model, vec![at], self.stop());
            (found.runs, found.iterations) = (found.runs + here.runs, found.iterations + here.iterations);
            let better = here.best.filter(|solution| solution.value() > best.value() + SAME_VALUE);
            let Some(from) = better.map(|solution| held.start(&solution)) else { return };
            let again = search.run(model, vec![from], StopRule::given_only());
            let improves = again.improves_on(found);
            found.merge(again);
            if !improves {
                return;
            }
        }
    }

    /// Status and figures of the best solution.
    pub(super) fn judge(
        &self,
        model: &Model,
        stretch: &Stretch,
        upper_bound: f64,
        mut found: SearchResult,
        cancel: &AtomicBool,
    ) -> Answer {
        let Some(best) = found.best.take() else {
            let what = if stretch.across.lateral_free { "a state" } else { "this l2" };
            let note = Some(format!("no start reached {what} without overlap; nothing is proved"));
            return found.counted(Answer { note, ..self.without_state(Status::L2NotReached) });
        };
        let Stretch { l2, across, direction, sign } = *stretch;
        let lattices = stretch.lattices(model);
        let gradient = lattices.gradient(&best.p, l2);
        let along = direction.along();
        let (status, reached) = (verdict(&best, upper_bound), sign * best.value());
        let above = best.certified && best.value() > upper_bound + ATTAINED;
        let note =
            above.then(|| format!("l1 = {reached} lies above its proven bound {upper_bound}: one of them is wrong"));
        let mut answer = found.counted(Answer {
            value: Some(along.dot(&(gradient * along)) - 1.0),
            gradient,
            residual: Some((-best.certificate.smallest_gap).max(0.0)),
            note,
            ..Answer::new(model, status)
        });
        if across.any() && best.certified {
            let (free, more) = lattices.ranges(model, &best, l2, cancel);
            let at = lattices.free_of(&best.p, l2);
            answer.free = Some(lattices.attainable(free, (&self.chain, &self.link), reached, at));
            answer.iterations += more;
        }
        answer.with_solution(model, best)
    }
}
