//! Extremes in the space of in-plane strains: one Green strain as large or as small as can be, the others held or free.
//!
//! The unknown is the Green strain E = ½(C − 1), C = FᵀF, with the tensor shear E_xy. It is linear in C, and C is what a
//! common turn of the sheet leaves alone, so a query is: E = E_held + Σ p_m B_m with a matrix B_m for all that is free, and
//! p₀ maximised. The lattice vectors are F(C) a_k with the triangular factor F of C (see [`crate::constraint::metric`]), whose
//! curvature enters the second derivatives: the certificate is that of a limit. The bound is convex in C
//! ([`crate::bound::metric_bound`]); where it is attained the extreme is proved for every cell.

use super::{
    CellTrend,
    climb::{Solve, climb, own_image_force, shaken_from, tiled},
    exact::FREE_SLACK,
    pull::farthest,
};
use crate::{
    bound::{ChainBound, MetricBound, metric_bound},
    constraint::{Contact, Parameter, Pull, SheetProgram, metric::factor},
    error::InvalidInput,
    lattice::direction,
    model::Model,
    record::Status,
    solve::{
        certificate::Certificate,
        sqp::{SqpOptions, maximize},
    },
    state::State,
};
use nalgebra::{Matrix2, Vector2};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::{AtomicBool, Ordering};

/// A line or a plane or all of the space of strains, and the end of it that is sought.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainQuery {
    /// What is held: E where all parameters are 0.
    pub held: Matrix2<f64>,
    /// Rates of E with the parameters, orthogonal to each other; the first parameter is maximised.
    pub free: Vec<Matrix2<f64>>,
}

/// A component of E.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strain {
    /// Along x.
    Exx,
    /// Along y.
    Eyy,
    /// The tensor shear.
    Exy,
}

impl Strain {
    /// All of them.
    pub const ALL: [Strain; 3] = [Strain::Exx, Strain::Eyy, Strain::Exy];

    /// `exx`, `eyy` or `exy`.
    pub fn name(self) -> &'static str {
        ["exx", "eyy", "exy"][self as usize]
    }

    /// E where this component is 1 and the others are 0, with x along `direction_deg`.
    pub fn unit(self, direction_deg: f64) -> Matrix2<f64> {
        let (x, y) = axes(direction_deg);
        match self {
            Strain::Exx => x * x.transpose(),
            Strain::Eyy => y * y.transpose(),
            Strain::Exy => x * y.transpose() + y * x.transpose(),
        }
    }

    /// This component of E, with x along `direction_deg`.
    pub fn of(self, e: &Matrix2<f64>, direction_deg: f64) -> f64 {
        let (x, y) = axes(direction_deg);
        let (a, b) = [(x, x), (y, y), (x, y)][self as usize];
        a.dot(&(e * b))
    }
}

/// The axes of the strains.
fn axes(direction_deg: f64) -> (Vector2<f64>, Vector2<f64>) {
    let x = direction(direction_deg);
    (x, Vector2::new(-x.y, x.x))
}

impl StrainQuery {
    /// The largest (`sign` 1) or least (−1) value of `goal`, with the strains of `fix` held, those of `free` left to the sheet,
    /// and the others held at 0, x along `direction_deg`. Refused where a strain is named twice or no lattice has what is held.
    pub fn of(
        goal: Strain,
        sign: f64,
        fix: &[(Strain, f64)],
        free: &[Strain],
        direction_deg: f64,
    ) -> Result<Self, InvalidInput> {
        let mut named = vec![goal];
        for strain in fix.iter().map(|(strain, _)| *strain).chain(free.iter().copied()) {
            if named.contains(&strain) {
                let problem = format!("{} is named twice", strain.name());
                let help = "a strain is sought, held, or left to the sheet: name it once";
                return Err(InvalidInput::new("fix", problem, help));
            }
            named.push(strain);
        }
        let held = fix.iter().map(|(strain, value)| strain.unit(direction_deg) * *value).sum::<Matrix2<f64>>();
        if factor(&(Matrix2::identity() + held * 2.0)).is_none() {
            let help = "a strain of -0.5 is a length of 0; take larger values, or a smaller exy";
            return Err(InvalidInput::new("fix", "no lattice has the strains that are held", help));
        }
        let rest = free.iter().map(|strain| strain.unit(direction_deg));
        Ok(StrainQuery { held, free: std::iter::once(goal.unit(direction_deg) * sign).chain(rest).collect() })
    }
}

/// How the search goes.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainOptions {
    /// Starts of a query whose bound is not attained.
    pub starts: usize,
    /// Seed of the shaking.
    pub seed: u64,
    /// Whether p₀ is a compression. All cells are solved then, as a fold can be larger than a cell that shows no sign of it,
    /// and no answer is `global`: a still larger cell can fold further.
    pub compression: bool,
}

impl Default for StrainOptions {
    fn default() -> Self {
        StrainOptions { starts: 8, seed: 1, compression: false }
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct StrainOutcome {
    /// `global`, `local`, `uncertified`, `l2-unreachable` (what is held is proved impossible), `l2-not-reached` (it was not
    /// reached), `interrupted`; of a pull also `unbounded` and `infeasible-start`.
    pub status: Status,
    /// Largest p₀; none where nothing was found that holds it.
    pub value: Option<f64>,
    /// p₀ of the first start, which goes straight from the design's state: where it is first stopped.
    pub first: Option<f64>,
    /// Proven bound of p₀.
    pub bound: Option<f64>,
    /// E at the state.
    pub strain: Matrix2<f64>,
    /// Least and largest value found of each free parameter after the first, with p₀ given way by a millionth of 1 + |p₀| and
    /// the others free; cut off where the bound excludes them at p₀ itself. A range of some width: the state is not the only one.
    /// Empty where the answer is not certified.
    pub ranges: Vec<[f64; 2]>,
    /// The state.
    pub state: State,
    /// Which of the cells.
    pub cell: usize,
    /// Its certificate.
    pub certificate: Option<Certificate>,
    /// Its loaded contacts, force per unit of p₀.
    pub contacts: Vec<Contact>,
    /// Whether the links are those of the design.
    pub links_ok: bool,
    /// Largest force between an element and its own image.
    pub own_image_force: f64,
    /// Starts that were solved.
    pub n_starts: u64,
    /// Distinct certified values among them, apart by more than 1e-7.
    pub n_distinct: u64,
    /// What each cell that was solved reached.
    pub trend: Vec<CellTrend>,
    /// Quadratic programs.
    pub iterations: u64,
}

/// Values that differ by less are the same.
const SAME: f64 = 1e-7;
/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// Amplitudes of the shaken starts, in reference radii and radians.
const SHAKES: [f64; 6] = [0.003, 0.1, 0.3, 0.03, 0.2, 0.05];
/// Kicks of a solve whose certificate stays incomplete.
const KICKS: usize = 4;
/// A force between an element and its own image above this calls for a larger cell.
const OWN_IMAGE_FORCE: f64 = 1e-6;

/// Answers queries on one sheet.
pub struct StrainMethod<'a> {
    models: &'a [Model],
    options: StrainOptions,
    chain: ChainBound,
}

impl<'a> StrainMethod<'a> {
    /// `models` are the same design compiled for cells of growing size; the larger ones are solved where an element presses
    /// on its own image. Panics if there is none.
    pub fn new(models: &'a [Model], options: StrainOptions) -> Self {
        StrainMethod { models, options, chain: ChainBound::new(&models[0]) }
    }

    /// The proven bound of p₀.
    pub fn bound(&self, query: &StrainQuery) -> MetricBound {
        let rates: Vec<Matrix2<f64>> = query.free.iter().map(|rate| rate * 2.0).collect();
        metric_bound(&self.chain, &(Matrix2::identity() + query.held * 2.0), &rates)
    }

    /// The largest p₀. `from` are further starts of the first cell, tried before the shaken ones.
    pub fn solve(&self, query: &StrainQuery, from: &[State], cancel: &AtomicBool) -> StrainOutcome {
        let mut out = StrainOutcome {
            status: Status::Interrupted,
            value: None,
            first: None,
            bound: None,
            strain: query.held,
            ranges: Vec::new(),
            state: self.models[0].start.clone(),
            cell: 0,
            certificate: None,
            contacts: Vec::new(),
            links_ok: false,
            own_image_force: 0.0,
            n_starts: 0,
            n_distinct: 0,
            trend: Vec::new(),
            iterations: 0,
        };
        match self.bound(query) {
            MetricBound::Unreachable => return StrainOutcome { status: Status::L2Unreachable, ..out },
            MetricBound::Finite(bound) => out.bound = Some(bound),
            MetricBound::Nothing => {}
        }
        let mut distinct: Vec<f64> = Vec::new();
        let mut smallest = self.models[0].start.clone();
        for cell in 0..self.models.len() {
            let asks = self.options.compression || out.own_image_force > OWN_IMAGE_FORCE;
            if cell > 0 && (out.status == Status::Global || !asks) {
                break;
            }
            let mut reached: Option<f64> = None;
            let (starts_before, mut own): (u64, Vec<f64>) = (out.n_starts, Vec::new());
            for start in self.starts(cell, &smallest, from) {
                if cancel.load(Ordering::Relaxed) {
                    return StrainOutcome { status: Status::Interrupted, ..out };
                }
                out.n_starts += 1;
                let (found, iterations) = self.climb(cell, query, start, out.n_starts, cancel);
                out.iterations += iterations;
                let Some(solve) = found else { continue };
                let value = solve.x.p[0];
                if solve.certified {
                    reached = Some(reached.map_or(value, |reached| reached.max(value)));
                    if !own.iter().any(|other| (other - value).abs() < SAME) {
                        own.push(value);
                    }
                }
                if out.n_starts == 1 {
                    out.first = Some(value);
                }
                if solve.certified && !distinct.iter().any(|other| (other - value).abs() < SAME) {
                    distinct.push(value);
                }
                let certified = matches!(out.status, Status::Local | Status::Global);
                if out.value.is_none_or(|best| (solve.certified, value) > (certified, best + SAME)) {
                    self.take(&mut out, cell, query, solve);
                }
                if out.status == Status::Global {
                    break;
                }
            }
            if cell == 0 {
                smallest = out.state.clone();
            }
            out.trend.push(CellTrend {
                cell,
                value: reached,
                n_starts: out.n_starts - starts_before,
                n_distinct: own.len() as u64,
            });
        }
        out.n_distinct = distinct.len() as u64;
        if out.value.is_none() {
            out.status = Status::L2NotReached;
        }
        if let (Status::Global | Status::Local, Some(value)) = (out.status, out.value) {
            self.ranges(query, value, &mut out, cancel);
        }
        // Without a bound, and where no contact pushes back: this is no limit, only where the search was stopped.
        if out.status == Status::Uncertified && out.bound.is_none() && out.contacts.is_empty() {
            (out.value, out.first) = (None, None);
        }
        out
    }

    /// Finds [`StrainOutcome::ranges`] at the value of p₀.
    pub(crate) fn ranges(&self, query: &StrainQuery, value: f64, out: &mut StrainOutcome, cancel: &AtomicBool) {
        let model = &self.models[out.cell];
        let given = value - FREE_SLACK * (1.0 + value.abs());
        let at = out.strain + query.free[0] * (given - value);
        for (m, rate) in query.free.iter().enumerate().skip(1) {
            let from = (out.strain - query.held).dot(rate) / rate.norm_squared();
            let others = || query.free[1..].iter().enumerate().filter(|(k, _)| k + 1 != m).map(|(_, other)| *other);
            let end = |sign: f64| {
                let wanted = Parameter { metric: rate * (2.0 * sign), weight: 1.0, ..Parameter::default() };
                let rest = others().map(|other| Parameter { metric: other * 2.0, ..Parameter::default() });
                let pull = Pull {
                    base: [model.start.a1, model.start.a2],
                    parameters: std::iter::once(wanted).chain(rest).collect(),
                    metric: Some(Matrix2::identity() + at * 2.0),
                };
                let (moved, iterations) = farthest(model, &pull, &out.state, cancel);
                let free = std::iter::once(rate * sign).chain(others()).collect();
                let held = query.held + query.free[0] * value;
                let most = match self.bound(&StrainQuery { held, free }) {
                    MetricBound::Finite(most) => most,
                    MetricBound::Nothing | MetricBound::Unreachable => f64::INFINITY,
                };
                // The state itself has its value, whatever rounding does to the bound.
                (sign * (sign * from + moved.unwrap_or(0.0)).min(most.max(sign * from)), iterations)
            };
            let [(least, some), (largest, more)] = [-1.0, 1.0].map(end);
            out.iterations += some + more;
            out.ranges.push([least, largest]);
        }
    }

    fn take(&self, out: &mut StrainOutcome, cell: usize, query: &StrainQuery, solve: Solve) {
        let value = solve.x.p[0];
        let attained = !self.options.compression && out.bound.is_some_and(|bound| (bound - value).abs() <= ATTAINED);
        let above = out.bound.is_some_and(|bound| value > bound + ATTAINED);
        out.status = match (solve.certified && !above, attained) {
            (true, true) => Status::Global,
            (true, false) => Status::Local,
            (false, _) => Status::Uncertified,
        };
        out.own_image_force = own_image_force(&self.models[cell], &solve.contacts);
        out.value = Some(value);
        out.strain = query.free.iter().zip(&solve.x.p).fold(query.held, |e, (rate, p)| e + rate * *p);
        out.cell = cell;
        out.links_ok = solve.links_ok;
        out.contacts = solve.contacts;
        out.certificate = Some(solve.certificate);
        out.state = solve.x.state;
    }

    /// Starts of a cell, all of them with the written lattice; a larger cell's first one is the smallest cell's answer.
    fn starts(&self, cell: usize, smallest: &State, from: &[State]) -> Vec<State> {
        let model = &self.models[cell];
        let rng = |k: usize| {
            ChaCha8Rng::seed_from_u64(
                self.options.seed.wrapping_mul(0x9e37_79b9).wrapping_add((1000 * cell + k) as u64),
            )
        };
        let shaken = |k: usize| shaken_from(model, &model.start, SHAKES[k % SHAKES.len()], &mut rng(k));
        if cell > 0 {
            let tiled = tiled(model, smallest);
            let own = if self.options.compression { self.options.starts } else { 0 };
            let fresh = (1..=own).map(shaken);
            return std::iter::once(shaken_from(model, &tiled, SHAKES[1], &mut rng(0))).chain(fresh).collect();
        }
        let count = self.options.starts.max(1);
        let mut shaken: Vec<State> = (0..count).map(shaken).collect();
        shaken.splice(1..1, from.iter().cloned());
        shaken
    }

    /// From a start: what is held is brought to its value with all else free, then p₀ is maximised.
    fn climb(
        &self,
        cell: usize,
        query: &StrainQuery,
        start: State,
        number: u64,
        cancel: &AtomicBool,
    ) -> (Option<Solve>, u64) {
        let model = &self.models[cell];
        let parameter = |rate: &Matrix2<f64>| Parameter { metric: rate * 2.0, ..Parameter::default() };
        let base = [model.start.a1, model.start.a2];
        let strain = (start.deformation_gradient(model).transpose() * start.deformation_gradient(model)
            - Matrix2::identity())
            * 0.5;
        // Where the start is, by what is free; the rest is brought to what is held.
        let p: Vec<f64> = query.free.iter().map(|b| (strain - query.held).dot(b) / b.norm_squared()).collect();
        let target = query.free.iter().zip(&p).fold(query.held, |e, (rate, p)| e + rate * *p);
        let way = target - strain;
        let (mut state, mut p, mut iterations) = (start, p, 0);
        if way.norm() > 1e-12 {
            let approach = Parameter { weight: 1.0, most: Some(1.0), ..parameter(&way) };
            let parameters = std::iter::once(approach).chain(query.free.iter().map(parameter)).collect();
            let pull = Pull { base, parameters, metric: Some(Matrix2::identity() + strain * 2.0) };
            let program = SheetProgram::new(model, &pull);
            let at = program.posed(state, vec![0.0; query.free.len() + 1]);
            let options = SqpOptions { enough: 1.0 - 1e-9, ..SqpOptions::default() };
            let end = maximize(&program, at, Vec::new(), &options, cancel);
            iterations += end.iterations as u64;
            if end.point.p[0] < 1.0 - 2e-9 || end.violation > 1e-6 {
                return (None, iterations);
            }
            p.iter_mut().zip(&end.point.p[1..]).for_each(|(p, moved)| *p += moved);
            state = end.point.state;
        }
        let mut parameters: Vec<Parameter> = query.free.iter().map(parameter).collect();
        parameters[0].weight = 1.0;
        let pull = Pull { base, parameters, metric: Some(Matrix2::identity() + query.held * 2.0) };
        let mut program = SheetProgram::new(model, &pull);
        let at = program.posed(state, p);
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed ^ number);
        let found = climb(model, &mut program, at, KICKS, &mut rng, cancel);
        (found.best, iterations + found.iterations)
    }
}
