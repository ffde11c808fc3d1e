//! The limit of one pull by the exact method: l1 is maximised subject to every gap ≥ 0, the result is certified, and
//! compared with a proven bound.
//!
//! What a certificate claims: the state is feasible to rounding, its links are those of the start and were never
//! crossed on the way, and no small motion raises l1, to second order. What it does not claim: that no distant state
//! is better (only an attained bound proves that), nor that a path without overlap leads there from the start.

use super::{ExactFigures, LimitOutcome};
use crate::{
    bound::{Bound, ChainBound, LinkBound, best_bound},
    constraint::{Parameter, Posed, Pull, SheetProgram},
    energy::target::target_gradient,
    lattice::direction,
    model::Model,
    record::Status,
    solve::{
        kkt::{Certificate, polish},
        sqp::{Multiplier, Program, SqpOptions, maximize, violation},
    },
    state::State,
    topology::{
        self,
        crossing::{Motion, StepBound},
    },
};
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};

/// Parameters of the exact method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExactOptions {
    /// Starts of a limit whose bound is not attained: the neighbouring limit's state, then shaken design states.
    pub starts: usize,
    /// Seed of the shaking.
    pub seed: u64,
}

impl Default for ExactOptions {
    fn default() -> Self {
        ExactOptions { starts: 4, seed: 1 }
    }
}

/// Limits that differ by less are the same; also the difference at which a bound counts as attained, times 100.
const SAME_LIMIT: f64 = 1e-7;
/// A bound is attained within this.
const ATTAINED: f64 = 1e-9;
/// Amplitudes of the shaken starts, in reference radii and radians.
const SHAKES: [f64; 6] = [0.03, 0.1, 0.3, 0.05, 0.2, 0.02];
/// Kicks of a solve whose certificate stays incomplete.
const KICKS: usize = 6;
/// Rounds of maximising and polishing between kicks.
const ROUNDS: usize = 6;

/// Finds limits of one model by the exact method.
pub struct ExactMethod<'a> {
    model: &'a Model,
    options: ExactOptions,
    chain: ChainBound,
    link: LinkBound,
}

/// A solve from one start.
struct Solve {
    x: Posed,
    certificate: Certificate,
    figures: (Vec<crate::constraint::Contact>, bool),
    certified: bool,
}

/// The lattice family of one pull, with F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ.
struct Family {
    reference: [Vec3; 2],
    direction_deg: f64,
}

impl Family {
    fn lattice(&self, l1: f64, l2: f64) -> [Vec3; 2] {
        let f = target_gradient(self.direction_deg, l1, l2);
        self.reference.map(|a| {
            let v = f * a.xy();
            Vec3::new(v.x, v.y, 0.0)
        })
    }

    /// Rates of the lattice with l1, or with l2.
    fn rates(&self, across: bool) -> [Vec3; 2] {
        let d = direction(self.direction_deg);
        let axis = if across { Vec3::new(-d.y, d.x, 0.0) } else { Vec3::new(d.x, d.y, 0.0) };
        self.reference.map(|a| axis * axis.dot(&a))
    }

    /// l2 held, l1 maximised.
    fn pull(&self, l2: f64) -> Pull {
        let l1 = Parameter { rate: self.rates(false), weight: 1.0, most: None };
        Pull { base: self.lattice(0.0, l2), parameters: vec![l1] }
    }

    /// From l2 = `from` towards `to`, l1 free.
    fn approach(&self, from: f64, to: f64) -> Pull {
        let sign = (to - from).signum();
        let l1 = Parameter { rate: self.rates(false), weight: 0.0, most: None };
        let l2 = Parameter { rate: self.rates(true).map(|v| v * sign), weight: 1.0, most: Some((to - from).abs()) };
        Pull { base: self.lattice(0.0, from), parameters: vec![l1, l2] }
    }
}

/// A state with the strains of its lattice in one direction.
#[derive(Clone)]
struct Strained {
    state: State,
    l1: f64,
    l2: f64,
}

impl<'a> ExactMethod<'a> {
    /// Prepares the bounds.
    pub fn new(model: &'a Model, options: ExactOptions) -> Self {
        let chain = ChainBound::new(model);
        let link = LinkBound::new(model, &chain);
        ExactMethod { model, options, chain, link }
    }

    /// The limits along one direction, in the order of `l2`. Solved outwards from l2 = 0, each from its neighbour's state.
    ///
    /// `finished` gets each limit with its index in `l2`; after `cancel` the rest comes back as interrupted.
    pub fn limits(&self, direction_deg: f64, l2: &[f64], cancel: &AtomicBool, finished: &mut dyn FnMut(usize, LimitOutcome)) {
        let mut order: Vec<usize> = (0..l2.len()).collect();
        order.sort_by(|&a, &b| l2[a].abs().total_cmp(&l2[b].abs()).then(l2[a].total_cmp(&l2[b])));
        let (mut above, mut below): (Option<Strained>, Option<Strained>) = (None, None);
        if !l2.contains(&0.0) {
            let (_, at_zero) = self.limit(direction_deg, 0.0, None, cancel);
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

    fn limit(&self, direction_deg: f64, l2: f64, neighbour: Option<Strained>, cancel: &AtomicBool) -> (LimitOutcome, Option<Strained>) {
        let bound = best_bound(&self.chain, Some(&self.link), direction_deg, l2);
        let mut figures = ExactFigures {
            bound: bound.l1().zip(bound.kind()),
            chain: bound.chain().cloned(),
            ..ExactFigures::default()
        };
        let ended = |status, note: Option<&str>, figures| LimitOutcome {
            status,
            state: self.model.start.clone(),
            gradient: nalgebra::Matrix2::identity(),
            residual: None,
            iterations: 0,
            runs: 0,
            note: note.map(str::to_owned),
            exact: Some(figures),
        };
        match bound {
            Bound::Unbounded => {
                return (ended(Status::Unbounded, Some("no chain of links joins lattice vectors along this direction"), figures), None);
            }
            Bound::L2Unreachable { .. } => return (ended(Status::L2Unreachable, None, figures), None),
            Bound::Finite { .. } => {}
        }
        let family = Family { reference: [self.model.start.a1, self.model.start.a2], direction_deg };
        let mut search = Search { method: self, family, l2, cancel, iterations: 0, runs: 0 };
        let (mut best, mut found): (Option<Solve>, Vec<f64>) = (None, Vec::new());
        let most = bound.l1().unwrap_or(f64::INFINITY);
        for start in 0..self.options.starts.max(1) {
            if cancel.load(Ordering::Relaxed) {
                return (ended(Status::Interrupted, None, figures), None);
            }
            let from = match (&neighbour, start) {
                (Some(neighbour), 0) => neighbour.clone(),
                _ => Strained { state: self.shaken(start), l1: 0.0, l2: 0.0 },
            };
            let Some(solve) = search.solve(from) else { continue };
            let l1 = solve.x.p[0];
            if solve.certified && !found.iter().any(|other| (other - l1).abs() < SAME_LIMIT) {
                found.push(l1);
            }
            let better = best.as_ref().is_none_or(|b| (solve.certified, l1) > (b.certified, b.x.p[0]));
            if better {
                best = Some(solve);
            }
            if best.as_ref().is_some_and(|b| b.certified && (b.x.p[0] - most).abs() <= ATTAINED) {
                break;
            }
        }
        figures.n_starts = search.runs;
        figures.n_distinct = found.len() as u64;
        let (iterations, runs) = (search.iterations, search.runs);
        let Some(best) = best else {
            let note = "no start reached this l2 without overlap; nothing is proved";
            return (LimitOutcome { iterations, runs, ..ended(Status::L2NotReached, Some(note), figures) }, None);
        };
        let l1 = best.x.p[0];
        let own = |contact: &&crate::constraint::Contact| {
            self.model.rings[contact.pair.ring_a].element == self.model.rings[contact.pair.ring_b].element
        };
        figures.own_image_force = Some(best.figures.0.iter().filter(own).map(|c| c.force).fold(0.0, f64::max));
        figures.contacts = best.figures.0;
        figures.links_ok = Some(best.figures.1);
        let residual = Some((-best.certificate.smallest_gap).max(0.0));
        figures.certificate = Some(best.certificate);
        let above_bound = l1 > most + ATTAINED;
        let status = match (best.certified && !above_bound, (l1 - most).abs() <= ATTAINED) {
            (true, true) => Status::Global,
            (true, false) => Status::Local,
            (false, _) => Status::Uncertified,
        };
        if status == Status::Uncertified {
            figures.l1_uncertified = Some(l1);
        }
        let gradient = target_gradient(direction_deg, l1, l2);
        let note = above_bound.then(|| format!("l1 = {l1} lies above its proven bound {most}: one of them is wrong"));
        let outcome =
            LimitOutcome { status, state: best.x.state.clone(), gradient, residual, iterations, runs, note, exact: Some(figures) };
        (outcome, Some(Strained { state: best.x.state, l1, l2 }))
    }

    /// The design's state, every element moved and turned at random, but no circle across another.
    fn shaken(&self, start: usize) -> State {
        let mut rng = ChaCha8Rng::seed_from_u64(self.options.seed.wrapping_mul(0x9e37_79b9).wrapping_add(start as u64));
        shaken_from(self.model, &self.model.start, SHAKES[start % SHAKES.len()], &mut rng)
    }
}

/// `state` with its elements moved and turned by up to `size`, less where circles could meet.
fn shaken_from(model: &Model, state: &State, size: f64, rng: &mut ChaCha8Rng) -> State {
    let mut vector = || Vec3::from_fn(|_, _| size * rng.random_range(-1.0..1.0));
    let elements = state.poses.iter().map(|_| (vector(), vector())).collect();
    let motion = Motion { elements, lattice: [Vec3::zeros(); 2] };
    let fraction = StepBound::new(model, state).largest_fraction(model, &motion, f64::INFINITY);
    let moved = state.poses.iter().zip(&motion.elements).map(|(p, (shift, turn))| p.moved(&(shift * fraction), &(turn * fraction)));
    State { poses: moved.collect(), ..state.clone() }
}

struct Search<'a> {
    method: &'a ExactMethod<'a>,
    family: Family,
    l2: f64,
    cancel: &'a AtomicBool,
    iterations: u64,
    runs: u64,
}

impl Search<'_> {
    /// From a start: first l2 is brought to its value with l1 free, then l1 is maximised. `None` where l2 is not reached.
    fn solve(&mut self, from: Strained) -> Option<Solve> {
        self.runs += 1;
        let model = self.method.model;
        let mut at = from;
        if at.l2 != self.l2 {
            let pull = self.family.approach(at.l2, self.l2);
            let program = SheetProgram::new(model, &pull);
            let enough = (self.l2 - at.l2).abs() - 1e-9;
            let start = program.posed(at.state, vec![at.l1, 0.0]);
            let options = SqpOptions { enough, ..SqpOptions::default() };
            let end = maximize(&program, start, Vec::new(), &options, self.cancel);
            self.iterations += end.iterations as u64;
            if end.point.p[1] < enough - 1e-9 || end.violation > 1e-6 {
                return None;
            }
            at = Strained { l1: end.point.p[0], state: end.point.state, l2: self.l2 };
        }
        let pull = self.family.pull(self.l2);
        let mut program = SheetProgram::new(model, &pull);
        let mut x = program.posed(at.state, vec![at.l1]);
        let mut rng = ChaCha8Rng::seed_from_u64(self.method.options.seed ^ self.runs);
        let mut best: Option<Solve> = None;
        for kick in 0..=KICKS {
            if kick > 0 {
                let size = 0.003 * kick as f64;
                x = program.posed(shaken_from(model, &x.state, size, &mut rng), x.p.clone());
            }
            let (end, solve) = self.climb(&mut program, x);
            if solve.certified {
                return Some(solve);
            }
            x = end;
            if best.as_ref().is_none_or(|b| solve.x.p[0] > b.x.p[0]) && feasible(&program, &solve.x) {
                best = Some(solve);
            }
            if self.cancel.load(Ordering::Relaxed) {
                break;
            }
        }
        best
    }

    /// Maximises and polishes in turns, until a certificate holds or nothing more is promised.
    fn climb(&mut self, program: &mut SheetProgram<'_>, start: Posed) -> (Posed, Solve) {
        let mut x = start;
        let mut known: Vec<Multiplier> = Vec::new();
        let (mut pause_at, mut first_radius) = (1e-2, 0.1);
        let mut last = None;
        for round in 0..ROUNDS {
            let options = SqpOptions { pause_at, first_radius, ..SqpOptions::default() };
            let end = maximize(program, x, known, &options, self.cancel);
            self.iterations += end.iterations as u64;
            let (polished, certificate) = polish(program, &end);
            let links_ok = topology::links_kept(self.method.model, &polished.state);
            let certified = certificate.holds() && links_ok;
            let contacts = program.contacts(&polished, &certificate.multipliers);
            let solve = Solve { x: polished, certificate, figures: (contacts, links_ok), certified };
            (x, known) = (end.point, end.multipliers);
            last = Some(solve);
            if certified {
                break;
            }
            if program.take_flat_pairs(&x) {
                known.clear();
                (pause_at, first_radius) = (1e-2, 0.03);
                continue;
            }
            if end.settled && round > 0 {
                break;
            }
            pause_at *= 0.03;
            first_radius = (30.0 * pause_at).max(1e-3);
        }
        let solve = last.unwrap_or_else(|| unreachable!("at least one round"));
        (x, solve)
    }
}

fn feasible(program: &SheetProgram<'_>, x: &Posed) -> bool {
    violation(&program.rows(x, 0.0, false)) < 1e-9
}
