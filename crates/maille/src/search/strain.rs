//! Extremes in the space of in-plane strains: one Green strain as large or as small as can be, the others held or free.
//!
//! The unknown is the Green strain E = ½(C − 1), C = FᵀF, with the tensor shear E_xy. It is linear in C, and C is what a
//! common turn of the sheet leaves alone, so a query is: E = E_held + Σ p_m B_m with a matrix B_m for all that is free, and
//! p₀ maximised. The lattice vectors are F(C) a_k with the triangular factor F of C (see [`crate::program::metric`]), whose
//! curvature enters the second derivatives: the certificate is that of a limit. The bound is convex in C
//! ([`crate::bound::metric_bound`]); where it is attained the extreme is proved for every cell.

use super::{
    local::LocalSolution,
    multistart::{CellStarts, Entered, FollowedWaves, LargerCells, Multistart, Target, verdict},
    options::{FREE_SLACK, STRAIGHT},
    starts::{Start, Use, perturbed, rng},
    stop::StopRule,
    stretch_lattices::farthest,
    waves::OwnCell,
};
use crate::{
    answer::{Answer, CellTrend},
    bound::{ChainBound, MetricBound, metric_bound},
    lattice::Cell,
    model::{Model, of_cell},
    program::{LatticeFamily, Parameter, SheetProgram},
    question::{Effort, Sense, StrainQuery},
    record::Status,
    solver::sqp::{SqpOptions, maximize},
    state::State,
};
use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, Ordering};

/// How the search goes.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainOptions {
    /// How long a query is searched whose bound is not attained.
    pub effort: Effort,
    /// So many starts in place of an effort.
    pub starts: Option<usize>,
    /// Seed of the starts that are drawn.
    pub seed: u64,
    /// Which end is sought. A least strain is searched in all cells, as a fold can be larger than a cell that shows no sign of it,
    /// and no answer is `global`: a still larger cell can fold further.
    pub sense: Sense,
    /// Whether unstable waves are followed into cells of which there is no model.
    pub follow_waves: bool,
}

impl Default for StrainOptions {
    fn default() -> Self {
        StrainOptions { effort: Effort::Normal, starts: None, seed: 1, sense: Sense::Largest, follow_waves: false }
    }
}

/// Which starts a query gets beside the states of its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OtherStarts {
    /// The straight way, and drawn ones as the effort says.
    Usual,
    /// The same, and where waves are followed one unstable wave into each cell.
    AndEveryWave,
    /// The straight way, and drawn ones until two starts lead to the best; none where all states are of larger cells.
    WhereNeighboursDiffer,
    /// None, and only a value above this is of interest.
    NoneAndBeyond(f64),
}

/// Answers queries on one sheet.
pub struct StrainMethod<'a> {
    models: &'a [Model],
    options: StrainOptions,
    chain: ChainBound,
    /// The design's own cell, where the first one is larger: its answer is a start.
    own: Option<Model>,
}

fn parameter(rate: &Matrix2<f64>) -> Parameter {
    Parameter { metric: rate * 2.0, ..Parameter::default() }
}

/// The sheet's lattices where E is `at` with all parameters at 0.
fn lattices(model: &Model, at: &Matrix2<f64>, parameters: Vec<Parameter>) -> LatticeFamily {
    let base = [model.start.a1, model.start.a2];
    LatticeFamily { base, parameters, metric: Some(Matrix2::identity() + at * 2.0), roll: None }
}

impl Target for StrainQuery {
    fn family(&self, model: &Model) -> LatticeFamily {
        let mut parameters: Vec<Parameter> = self.free.iter().map(parameter).collect();
        parameters[0].weight = 1.0;
        lattices(model, &self.held, parameters)
    }

    /// What is held is brought to its value with all else free.
    fn enter(&self, model: &Model, start: Start, cancel: &AtomicBool) -> Entered {
        let f = start.state.deformation_gradient(model);
        let strain = (f.transpose() * f - Matrix2::identity()) * 0.5;
        // Where the start is, by what is free; the rest is brought to what is held.
        let mut p: Vec<f64> = self.free.iter().map(|b| (strain - self.held).dot(b) / b.norm_squared()).collect();
        let target = self.free.iter().zip(&p).fold(self.held, |e, (rate, p)| e + rate * *p);
        let way = target - strain;
        if way.norm() <= 1e-12 {
            return Entered { at: Some((start.state, p)), iterations: 0 };
        }
        let approach = Parameter { weight: 1.0, most: Some(1.0), ..parameter(&way) };
        let parameters = std::iter::once(approach).chain(self.free.iter().map(parameter)).collect();
        let pull = lattices(model, &strain, parameters);
        let program = SheetProgram::new(model, &pull);
        let at = program.posed(start.state, vec![0.0; self.free.len() + 1]);
        let options = SqpOptions { enough: 1.0 - 1e-9, ..SqpOptions::default() };
        let end = maximize(&program, at, Vec::new(), &options, cancel);
        let reached = end.point.p[0] >= 1.0 - 2e-9 && end.violation <= 1e-6;
        p.iter_mut().zip(&end.point.p[1..]).for_each(|(p, moved)| *p += moved);
        Entered { at: reached.then_some((end.point.state, p)), iterations: end.iterations as u64 }
    }

    fn start(&self, solution: &LocalSolution) -> Start {
        Start::written(solution.state.clone())
    }
}

impl<'a> StrainMethod<'a> {
    /// `models` are the same design compiled for cells of growing size; the larger ones are solved where an element presses
    /// on its own image.
    ///
    /// # Panics
    /// If there is no model.
    pub fn new(models: &'a [Model], options: StrainOptions) -> Self {
        let own = (models[0].cell.copies() > 1).then(|| models[0].primitive());
        StrainMethod { models, options, chain: ChainBound::new(&models[0]), own }
    }

    /// The proven bound of p₀.
    pub(crate) fn bound(&self, query: &StrainQuery) -> MetricBound {
        let rates: Vec<Matrix2<f64>> = query.free.iter().map(|rate| rate * 2.0).collect();
        metric_bound(&self.chain, &(Matrix2::identity() + query.held * 2.0), &rates)
    }

    /// The largest p₀, as the value of the strain itself: −p₀ of a least one. `from` are states of neighbouring queries, each with
    /// its cell. An unreachable strain is proved to be so by the chains; one that is not reached is not.
    pub fn solve(&self, query: &StrainQuery, from: &[(Cell, State)], cancel: &AtomicBool) -> Answer {
        self.solve_beside(query, from, OtherStarts::Usual, cancel)
    }

    /// The same with other starts beside the states.
    pub(crate) fn solve_beside(
        &self,
        query: &StrainQuery,
        from: &[(Cell, State)],
        others: OtherStarts,
        cancel: &AtomicBool,
    ) -> Answer {
        let (model, sign) = (&self.models[0], self.options.sense.sign());
        let none = |status: Status| Answer { n_starts: Some(0), n_distinct: Some(0), ..Answer::new(model, status) };
        let bound = match self.bound(query) {
            MetricBound::Unreachable => return none(Status::L2Unreachable),
            MetricBound::Finite(bound) => Some(bound),
            MetricBound::Nothing => None,
        };
        let least = self.options.sense == Sense::Least;
        // A least strain is never called global: larger cells can fold further.
        let upper_bound = bound.filter(|_| !least).unwrap_or(f64::INFINITY);
        let StrainOptions { effort, starts, seed, follow_waves, .. } = self.options;
        let waves = match others {
            OtherStarts::AndEveryWave if follow_waves => FollowedWaves::All,
            _ => FollowedWaves::worst_if(follow_waves),
        };
        let stop = match others {
            OtherStarts::Usual | OtherStarts::AndEveryWave => StopRule::of(effort, starts),
            // What the own cell can reach, its neighbours have left behind.
            OtherStarts::WhereNeighboursDiffer
                if !from.is_empty() && from.iter().all(|(cell, _)| *cell != model.cell) =>
            {
                StopRule::given_only()
            }
            OtherStarts::WhereNeighboursDiffer => StopRule::of(effort, starts).until_found_twice(),
            OtherStarts::NoneAndBeyond(_) => StopRule::given_only(),
        };
        let search = Multistart { target: query, upper_bound, seed, cancel };
        let straight = (!matches!(others, OtherStarts::NoneAndBeyond(_)))
            .then(|| perturbed(model, &model.start, STRAIGHT, &mut rng(seed, Use::Start, u64::from(u32::MAX))));
        let neighbours: CellStarts = from.iter().map(|(cell, state)| (*cell, Start::written(state.clone()))).collect();
        let of =
            |cell: Cell| neighbours.iter().filter(move |(other, _)| *other == cell).map(|(_, start)| start.clone());
        let own = self.own.as_ref().map(|own| search.own_cell(own, of(own.cell).collect(), stop, model));
        let OwnCell { starts: repeated, runs, iterations, .. } = own.unwrap_or_default();
        let given = straight.map(Start::written).into_iter().chain(repeated).chain(of(model.cell));
        let mut first = search.run(model, given.collect(), stop);
        (first.runs, first.iterations) = (first.runs + runs, first.iterations + iterations);
        let own_starts = stop.of_larger_cell(least);
        let beyond = match others {
            OtherStarts::NoneAndBeyond(value) => value,
            _ => f64::NEG_INFINITY,
        };
        let fallback = Some(Start::written(model.start.clone()));
        let rule = LargerCells {
            every: least,
            own_starts,
            where_none: true,
            fallback,
            waves,
            beyond,
            neighbours: &neighbours,
        };
        let found = search.larger_cells(self.models, first, &rule);
        let model = &found.model(self.models).clone();
        let wave = found.wave;
        let by_cell = found.by_cell.into_iter().map(|t| CellTrend { value: t.value.map(|p| sign * p), ..t }).collect();
        let mut result = found.result;
        let best = result.best.take();
        let counted =
            |answer: Answer| Answer { bound: bound.map(|bound| sign * bound), by_cell, ..result.counted(answer) };
        if cancel.load(Ordering::Relaxed) {
            return counted(none(Status::Interrupted));
        }
        let Some(best) = best else { return counted(none(Status::L2NotReached)) };
        let status = verdict(&best, upper_bound);
        // Without a bound, and where no contact pushes back: this is no limit, only where the search was stopped.
        let stopped = status == Status::Uncertified && bound.is_none() && best.contacts.is_empty();
        let value = Some(sign * best.value()).filter(|_| !stopped);
        let answer = counted(Answer { value, ..Answer::new(model, status) }).with_solution(model, best);
        let gradient = answer.state.deformation_gradient(model);
        let answer = Answer { gradient, wave, ..answer };
        if !answer.is_limit() {
            return answer;
        }
        let answer = self.with_ranges(query, answer, cancel);
        match cancel.load(Ordering::Relaxed) {
            true => none(Status::Interrupted),
            false => answer,
        }
    }

    /// The answer with the ranges of the strains that are free, see [`Answer::ranges`].
    pub(crate) fn with_ranges(&self, query: &StrainQuery, answer: Answer, cancel: &AtomicBool) -> Answer {
        let Some(p) = answer.value.map(|value| self.options.sense.sign() * value) else { return answer };
        let model = &*of_cell(self.models, answer.cell);
        let strain = answer.green_strain();
        let at = strain - query.free[0] * (FREE_SLACK * (1.0 + p.abs()));
        let (mut ranges, mut iterations) = (Vec::new(), answer.iterations);
        for (m, rate) in query.free.iter().enumerate().skip(1) {
            let from = (strain - query.held).dot(rate) / rate.norm_squared();
            let others = || query.free[1..].iter().enumerate().filter(|(k, _)| k + 1 != m).map(|(_, other)| *other);
            let end = |sign: f64| {
                let wanted = Parameter { weight: 1.0, ..parameter(&(rate * sign)) };
                let rest = others().map(|other| parameter(&other));
                let pull = lattices(model, &at, std::iter::once(wanted).chain(rest).collect());
                let (moved, iterations) = farthest(model, &pull, &answer.state, cancel);
                let free = std::iter::once(rate * sign).chain(others()).collect();
                let held = query.held + query.free[0] * p;
                let most = match self.bound(&StrainQuery { held, free }) {
                    MetricBound::Finite(most) => most,
                    MetricBound::Nothing | MetricBound::Unreachable => f64::INFINITY,
                };
                // The state itself has its value, whatever rounding does to the bound.
                (sign * (sign * from + moved.unwrap_or(0.0)).min(most.max(sign * from)), iterations)
            };
            let [(least, some), (largest, more)] = [-1.0, 1.0].map(end);
            iterations += some + more;
            ranges.push([least, largest]);
        }
        Answer { ranges, iterations, ..answer }
    }
}
