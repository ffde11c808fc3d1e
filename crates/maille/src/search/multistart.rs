//! The one search behind every exact answer: local maximisation from many starts, in one cell and then in larger ones.
//!
//! What is maximised is the first parameter of a family of lattices, see [`Target`]. Starts are solved until the proven upper
//! bound is attained or [`StopRule`] says that they were enough: one at a time where there is a
//! bound, else some side by side. A result depends on the starts and the seed alone, not on the number of threads.

use super::{
    local::{Course, LocalSolution, local_maximize},
    options::{
        ATTAINED, BOUND_RETRIES, BOUND_RETRY_GAP, BOUND_RETRY_SIZE, CELL_PERTURBATION, EXPLORATIONS,
        LARGER_CELL_RESTARTS, OWN_IMAGE_FORCE, RESTARTS, SAME_VALUE, WIRE_PAUSE,
    },
    starts::{Start, Use, explored, perturbed, rng, tiled},
    stop::{StopRule, better_chance},
};
use crate::{
    answer::{Answer, CellTrend, WaveCurvature},
    lattice::Cell,
    model::{Model, of_cell},
    program::{Contact, LatticeFamily, SheetProgram},
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::State,
    topology::smallest_gap,
};
use rayon::prelude::*;
use std::{
    sync::atomic::{AtomicBool, Ordering},
    time::Instant,
};

/// A start that was brought to what is held.
pub(super) struct Entered {
    /// The state and its parameters; `None` where what is held was not reached.
    pub at: Option<(State, Vec<f64>)>,
    /// Quadratic programs.
    pub iterations: u64,
}

/// What is maximised: the first parameter of a family of lattices.
pub(super) trait Target: Sync {
    /// The family in one cell.
    fn family(&self, model: &Model) -> LatticeFamily;

    /// Brings a start to what is held.
    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered;

    /// A start that is drawn, see [`explored`].
    fn explored(&self, model: &Model, seed: u64, number: usize) -> Start {
        explored(model, seed, number)
    }

    /// A solution as a start.
    fn start(&self, solution: &LocalSolution) -> Start;
}

/// A search for the largest value of one target.
pub(super) struct Multistart<'a, T> {
    pub target: &'a T,
    /// A proven upper bound; infinite where none is known.
    pub upper_bound: f64,
    pub seed: u64,
    pub cancel: &'a AtomicBool,
}

/// What the solves of one cell found.
#[derive(Default)]
pub(super) struct SearchResult {
    pub best: Option<LocalSolution>,
    /// Distinct certified values, and how many starts led to each.
    pub distinct: Vec<(f64, u64)>,
    /// Starts.
    pub starts: u64,
    /// Estimated chance that another start of its cell finds more; `None` where the bound is attained.
    pub chance: Option<f64>,
    /// Quadratic programs.
    pub iterations: u64,
    /// Local maximisations.
    pub runs: u64,
}

/// What the cells found together.
pub(super) struct CellSearch {
    /// The best of all cells, with the counts of all.
    pub result: SearchResult,
    /// Index of its cell among those that are listed.
    pub cell: usize,
    /// Its cell, where that is none of these.
    pub further: Option<Model>,
    /// The least curvature on waves at it.
    pub wave: Option<WaveCurvature>,
    /// What each cell found.
    pub by_cell: Vec<CellTrend>,
    /// The best of each listed cell, and of the best cell, as starts.
    pub starts: CellStarts,
}

/// Starts, each in its cell.
pub(super) type CellStarts = Vec<(Cell, Start)>;

impl CellSearch {
    /// The model of its cell, where `models` were searched.
    pub fn model<'m>(&'m self, models: &'m [Model]) -> &'m Model {
        self.further.as_ref().unwrap_or(&models[self.cell])
    }
}

/// Which unstable waves of a state are followed, each into the smallest cell that holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FollowedWaves {
    /// None.
    None,
    /// The three worst, until one gives more.
    Worst,
    /// One into each cell.
    All,
}

impl FollowedWaves {
    pub(super) fn worst_if(followed: bool) -> Self {
        if followed { FollowedWaves::Worst } else { FollowedWaves::None }
    }
}

/// Which larger cells are searched, and from where.
pub(super) struct LargerCells<'a> {
    /// All of them; otherwise only where the first cell's solution presses an element on its own image. Unstable waves are followed into
    /// others in either case.
    pub every: bool,
    /// Starts of a larger cell of its own.
    pub own_starts: u64,
    /// How unstable waves are followed into cells that are not listed.
    pub waves: FollowedWaves,
    /// Whether larger cells are tried where the first one has no state.
    pub where_none: bool,
    /// The state that is repeated over a larger cell where the first one has none.
    pub fallback: Option<Start>,
    /// Only a value above this is of interest: less is not followed.
    pub beyond: f64,
    /// States of cells at neighbouring questions. A larger cell that is not searched otherwise is tried from them alone.
    pub neighbours: &'a [(Cell, Start)],
}

impl LargerCells<'_> {
    /// The neighbours' states of one cell.
    fn of(&self, cell: Cell) -> impl Iterator<Item = Start> {
        self.neighbours.iter().filter(move |(other, _)| *other == cell).map(|(_, start)| start.clone())
    }
}

impl<T: Target> Multistart<'_, T> {
    /// Solves `given` in one cell, then starts that are drawn until `rule` says that these were enough or the upper bound is
    /// attained, and keeps the best: certified first, then by value; of equals the first.
    pub(crate) fn run(&self, model: &Model, given: Vec<Start>, rule: StopRule) -> SearchResult {
        self.run_beyond(model, given, rule, f64::NEG_INFINITY)
    }

    /// The same where only a value above `beyond` is of interest.
    fn run_beyond(&self, model: &Model, given: Vec<Start>, rule: StopRule, beyond: f64) -> SearchResult {
        let began = Instant::now();
        // Where a bound can end the search at any start, one at a time.
        let batch = if self.upper_bound.is_finite() { 1 } else { EXPLORATIONS.len() };
        let mut result = SearchResult::default();
        let (mut given, mut drawn) = (given.into_iter(), 0);
        while !self.cancelled() && !result.attains(self.upper_bound) {
            let mut starts: Vec<Start> = given.by_ref().take(batch).collect();
            let left = rule.left(result.starts, result.chance_of_more(), began.elapsed().as_secs_f64());
            let found_twice = starts.is_empty() && result.times_of_best() > 1;
            let own = match rule.until_found_twice && (found_twice || !starts.is_empty()) {
                true => 0,
                false => batch.min(left as usize).saturating_sub(starts.len()),
            };
            starts.extend((drawn..drawn + own).map(|k| self.target.explored(model, self.seed, k)));
            drawn += own;
            if starts.is_empty() {
                break;
            }
            let numbered: Vec<(u64, Start)> = (result.starts..).zip(starts).collect();
            let certified = result.best.as_ref().filter(|best| best.certified);
            let floor = certified.map_or(beyond, |best| best.value().max(beyond));
            let solve = |(k, start): (u64, Start)| (!self.cancelled()).then(|| self.retried(model, start, k, floor));
            let solved: Vec<Option<SearchResult>> = numbered.into_par_iter().with_max_len(1).map(solve).collect();
            solved.into_iter().flatten().for_each(|found| result.take(found));
        }
        result.with_chance(self.upper_bound)
    }

    /// One start. A certified solution just short of the upper bound is perturbed and solved again: in cells of many elements
    /// contacts that hardly carry can hold it there.
    fn retried(&self, model: &Model, start: Start, number: u64, floor: f64) -> SearchResult {
        let first = number * (1 + BOUND_RETRIES);
        let mut result = self.solve(model, start, first, floor);
        for retry in 1..=BOUND_RETRIES {
            let Some(solution) = result.best.as_ref().filter(|best| best.certified) else { break };
            let short = self.upper_bound - solution.value();
            if !(ATTAINED..BOUND_RETRY_GAP).contains(&short) || self.cancelled() {
                break;
            }
            let from = self.target.start(solution);
            let state = perturbed(model, &from.state, BOUND_RETRY_SIZE, &mut rng(self.seed, Use::Retry, first + retry));
            let again = self.solve(model, Start { state, ..from }, first + retry, floor);
            let better = again.best.filter(|new| (new.certified, new.value()) > (true, solution.value()));
            (result.iterations, result.runs) = (result.iterations + again.iterations, result.runs + again.runs);
            if let Some(better) = better {
                result.distinct = vec![(better.value(), 1)];
                result.best = Some(better);
            }
        }
        result
    }

    /// One local maximisation, by the start's route.
    fn solve(&self, model: &Model, start: Start, number: u64, floor: f64) -> SearchResult {
        let restarts = if model.cell.copies() > 1 { LARGER_CELL_RESTARTS } else { RESTARTS };
        let course = Course { restarts, first_radius: start.route.first_radius, floor };
        self.solve_by(model, start, number, course)
    }

    /// The same from a start that is near what is sought: without beginning again.
    pub(super) fn solve_nearby(&self, model: &Model, start: Start) -> SearchResult {
        let (first_radius, floor) = (start.route.first_radius, f64::NEG_INFINITY);
        self.solve_by(model, start, 0, Course { restarts: 0, first_radius, floor })
    }

    fn solve_by(&self, model: &Model, start: Start, number: u64, course: Course) -> SearchResult {
        let route = start.route;
        let Entered { at, mut iterations } = self.target.enter(model, start, self.cancel);
        let one = SearchResult { starts: 1, runs: 1, ..SearchResult::default() };
        let Some((state, p)) = at else { return SearchResult { iterations, ..one } };
        let family = self.target.family(model);
        let mut program = SheetProgram::new(model, &family);
        let mut x = program.posed(state, p);
        for &wire in route.wires {
            let program = SheetProgram::new(model, &family).with_wire(wire);
            let options = SqpOptions { pause_at: WIRE_PAUSE, ..SqpOptions::default() };
            let end = maximize(&program, x, Vec::new(), &options, self.cancel);
            iterations += end.iterations as u64;
            x = end.point;
        }
        let mut stream = rng(self.seed, Use::Restart, number);
        let (best, more) = local_maximize(model, &mut program, x, course, &mut stream, self.cancel);
        let distinct = best.iter().filter(|best| best.certified).map(|best| (best.value(), 1)).collect();
        SearchResult { best, distinct, iterations: iterations + more, ..one }
    }

    /// Goes on from the first of `models` to larger ones, see [`LargerCells`]. `result` is what the first cell found.
    pub(crate) fn larger_cells(&self, models: &[Model], result: SearchResult, rule: &LargerCells<'_>) -> CellSearch {
        let own = models[0].cell;
        let mut by_cell = vec![result.by_cell(own)];
        let best = |result: &SearchResult| result.best.as_ref().map(|best| self.target.start(best));
        let smallest = best(&result).or_else(|| rule.fallback.clone());
        let mut starts: CellStarts = best(&result).map(|start| (own, start)).into_iter().collect();
        let presses = |best: &LocalSolution| own_image_force(&models[0], &best.contacts) > OWN_IMAGE_FORCE;
        let asks = rule.every || result.best.as_ref().map_or(rule.where_none, presses);
        let (mut result, mut cell) = (result, 0);
        for (larger, model) in models.iter().enumerate().skip(1) {
            // The last cell is for values that have grown.
            let idle = !rule.every && larger + 1 == models.len() && larger > 1 && cell == 0 && result.best.is_some();
            if !asks || idle || result.attains(self.upper_bound) || self.cancelled() {
                break;
            }
            let repeated = smallest.iter().map(|from| {
                let mut stream = rng(self.seed, Use::Cell, larger as u64);
                let state = perturbed(model, &tiled(model, own, &from.state), CELL_PERTURBATION, &mut stream);
                Start { state, ..from.clone() }
            });
            // Then starts of its own: the smaller cell's answer can hide what they find.
            let given: Vec<Start> = repeated.chain(rule.of(model.cell)).collect();
            let count = given.len() as u64 + rule.own_starts;
            let found = self.run(model, given, StopRule::exactly(count));
            by_cell.push(found.by_cell(model.cell));
            starts.extend(best(&found).map(|start| (model.cell, start)));
            if found.improves_on(&result) {
                cell = larger;
            }
            result.merge(found);
        }
        let mut found = CellSearch { result, cell, further: None, wave: None, by_cell, starts };
        self.try_neighbours(models, rule, &mut found);
        if found.result.best.as_ref().is_some_and(|best| best.value() > rule.beyond) {
            self.follow_waves(models, rule, &mut found);
        }
        let further = found.further.as_ref().map(|model| model.cell);
        found.starts.extend(further.zip(best(&found.result)));
        found
    }

    /// Solves the larger cells in which neighbouring questions found states, and which were not searched.
    fn try_neighbours(&self, models: &[Model], rule: &LargerCells<'_>, found: &mut CellSearch) {
        for &(cell, _) in rule.neighbours {
            let known = found.by_cell.iter().any(|trend| trend.cell == cell);
            let larger = cell.copies() > models[0].cell.copies();
            if known || !larger || found.result.attains(self.upper_bound) || self.cancelled() {
                continue;
            }
            let model = of_cell(models, cell).into_owned();
            let here = self.run_beyond(&model, rule.of(cell).collect(), StopRule::given_only(), rule.beyond);
            found.by_cell.push(here.by_cell(cell));
            if here.improves_on(&found.result) {
                found.further = Some(model);
            }
            found.result.merge(here);
        }
    }

    pub(super) fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

impl SearchResult {
    /// What it found, as that of one cell.
    pub(super) fn by_cell(&self, cell: Cell) -> CellTrend {
        let value = self.best.as_ref().filter(|best| best.certified).map(LocalSolution::value);
        CellTrend { cell, value, n_starts: self.runs, n_distinct: self.distinct.len() as u64 }
    }

    /// The answer with what the search took.
    pub(crate) fn counted(&self, answer: Answer) -> Answer {
        Answer {
            n_starts: Some(self.runs),
            n_distinct: Some(self.distinct.len() as u64),
            better_chance: self.chance,
            runs: self.runs,
            iterations: self.iterations,
            ..answer
        }
    }

    /// The same with its estimated chance, where the bound is not attained.
    pub(super) fn with_chance(self, upper_bound: f64) -> Self {
        let chance = (!self.attains(upper_bound)).then(|| self.better_chance());
        SearchResult { chance, ..self }
    }

    /// How many starts led to the best certified value.
    fn times_of_best(&self) -> u64 {
        self.distinct.iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, times)| *times)
    }

    /// The chance by which a search stops: states without a certificate are no reason to.
    fn chance_of_more(&self) -> f64 {
        let lacks_certificate = self.best.as_ref().is_some_and(|best| !best.certified);
        if lacks_certificate { 1.0 } else { self.better_chance() }
    }

    /// The estimated chance that another start finds more.
    fn better_chance(&self) -> f64 {
        let times: Vec<u64> = self.distinct.iter().map(|(_, times)| *times).collect();
        better_chance(self.starts, &times)
    }

    /// Whether it has a better solution than `other`: certified first, and more than the same.
    pub(crate) fn improves_on(&self, other: &SearchResult) -> bool {
        match (&self.best, &other.best) {
            (Some(new), Some(old)) => (new.certified, new.value()) > (old.certified, old.value() + SAME_VALUE),
            (new, _) => new.is_some(),
        }
    }

    /// Whether the best certified value is the upper bound.
    pub(crate) fn attains(&self, upper_bound: f64) -> bool {
        self.best.as_ref().is_some_and(|best| best.certified && (best.value() - upper_bound).abs() <= ATTAINED)
    }

    /// Adds another start of the same cell: the better solution stays, of equals the one that was there.
    fn take(&mut self, found: SearchResult) {
        let better = match (&found.best, &self.best) {
            (Some(new), Some(old)) => (new.certified, new.value()) > (old.certified, old.value()),
            (new, _) => new.is_some(),
        };
        self.count(&found);
        if better {
            self.best = found.best;
        }
    }

    /// Adds another search: its solution is taken where it is better by more than what makes two the same.
    pub(crate) fn merge(&mut self, found: SearchResult) {
        let better = found.improves_on(self);
        self.count(&found);
        if better {
            (self.best, self.chance) = (found.best, found.chance);
        }
    }

    fn count(&mut self, found: &SearchResult) {
        (self.runs, self.iterations) = (self.runs + found.runs, self.iterations + found.iterations);
        self.starts += found.starts;
        for &(value, times) in &found.distinct {
            match self.distinct.iter_mut().find(|(other, _)| (other - value).abs() < SAME_VALUE) {
                Some((_, known)) => *known += times,
                None => self.distinct.push((value, times)),
            }
        }
    }
}

/// What is claimed of a solution: `global` where it attains its proven upper bound, `local` where it is certified. A value above
/// its bound is `uncertified`, as one of the two must be wrong.
pub(super) fn verdict(solution: &LocalSolution, upper_bound: f64) -> Status {
    let above = solution.value() - upper_bound;
    match (solution.certified && above <= ATTAINED, above.abs() <= ATTAINED) {
        (true, true) => Status::Global,
        (true, false) => Status::Local,
        (false, _) => Status::Uncertified,
    }
}

impl Answer {
    /// The same with a solution: its state, certificate and contacts, and its smallest gap.
    pub(super) fn with_solution(self, model: &Model, solution: LocalSolution) -> Self {
        let LocalSolution { state, certificate, contacts, links_ok, .. } = solution;
        Answer {
            gap: smallest_gap(model, &state).map(|(gap, _)| gap),
            links_ok: Some(links_ok),
            own_image_force: Some(own_image_force(model, &contacts)),
            certificate: Some(certificate),
            contacts,
            state,
            ..self
        }
    }
}

/// Largest force between an element and its own image.
pub(super) fn own_image_force(model: &Model, contacts: &[Contact]) -> f64 {
    let element = |ring: usize| model.rings[ring].element;
    let own = contacts.iter().filter(|c| element(c.pair.ring_a) == element(c.pair.ring_b));
    own.map(|c| c.force).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{question::Effort, solver::certificate::Certificate};
    use maille_geometry::Vec3;
    use std::collections::BTreeSet;

    fn found(certified: bool) -> SearchResult {
        let state = State { poses: Vec::new(), a1: Vec3::x(), a2: Vec3::y(), roll: None };
        let certificate = Certificate {
            smallest_gap: 0.0,
            dual_residual: if certified { 0.0 } else { 1.0 },
            complementarity: 0.0,
            min_multiplier: 0.0,
            min_curvature: None,
            zero_modes: 0,
            multipliers: Vec::new(),
        };
        let (contacts, flat) = (Vec::new(), BTreeSet::new());
        let best = LocalSolution { state, p: vec![0.4], certificate, contacts, links_ok: true, certified, flat };
        SearchResult { best: Some(best), starts: 40, ..SearchResult::default() }
    }

    /// Forty starts are enough where their limit is certified, and not where it is not.
    #[test]
    fn states_without_a_certificate_end_no_search() {
        let normal = StopRule::of(Effort::Normal, None);
        let left = |result: SearchResult| normal.left(result.starts, result.chance_of_more(), 0.0);
        assert_eq!(left(SearchResult { distinct: vec![(0.4, 40)], ..found(true) }), 0);
        // No value is counted as found.
        assert_eq!(left(SearchResult { starts: 60, ..found(false) }), 4);
        assert_eq!(left(found(false)), 24);
    }
}
