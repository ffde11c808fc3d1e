//! The thesis's energy (chapter 4): contacts, the lattice's targets, and the objective made of them.

pub mod barrier;
mod contacts;
pub mod target;

pub use contacts::{ContactOptions, MinimaMethod};

use crate::{
    model::Model,
    solve::newton::{Derivatives, Objective},
    state::State,
    topology::{self, RingPair},
};
use faer::Mat;
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use target::Target;

/// How the Hessian is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HessianMethod {
    /// From formulas.
    Analytic,
    /// Central differences of the gradient, symmetrised (eq. 4.3.9, with its second sign put right), ε = 1e-7.
    FiniteDifference,
}

/// A state with the fourth corner of its cell (relative to x1), which only the corner protocol leaves free.
#[derive(Clone, Debug)]
pub struct Configuration {
    /// Poses and lattice.
    pub state: State,
    /// x4 − x1.
    pub corner: Vec3,
}

impl Configuration {
    /// The starting state with its fourth corner in place.
    pub fn start(state: State) -> Self {
        let corner = state.a1 + state.a2;
        Configuration { state, corner }
    }
}

/// E = E_c + E_b + E_f of a cell, as a function of six unknowns an element and those of the lattice.
pub struct SheetEnergy<'a> {
    /// The sheet.
    pub model: &'a Model,
    /// The pull.
    pub target: &'a Target,
    /// The contacts.
    pub contacts: &'a ContactOptions,
    /// How the Hessian is found.
    pub hessian: HessianMethod,
    /// Seed of the kicks.
    pub seed: u64,
}

/// Pairs near enough to matter for a step, with their core distances.
pub struct Guard {
    pairs: Vec<(RingPair, f64)>,
    reach_growth: f64,
}

/// Pairs up to this many largest radii apart bound a step one by one.
const GUARD_MARGIN: f64 = 1.5;
/// Largest motion of an element in one step, in largest radii.
const STEP_CAP: f64 = 0.3;
/// Largest fraction of a pair's core distance that a step may use: below 1 the circles cannot meet on the way.
const CROSSING_MARGIN: f64 = 0.9;

impl SheetEnergy<'_> {
    fn lattice_index(&self) -> usize {
        6 * self.model.elements.len()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.lattice_index() + self.target.lattice_unknowns()
    }

    /// Energy and gradient alone.
    pub fn gradient(&self, x: &Configuration) -> (f64, Vec<f64>) {
        let mut gradient = vec![0.0; self.unknowns()];
        let mut hessian = Mat::zeros(self.unknowns(), self.unknowns());
        let contact = contacts::add_derivatives(self, &x.state, &mut gradient, &mut hessian);
        self.target.add_derivatives(&x.state, &x.corner, self.lattice_index(), &mut gradient, &mut hessian);
        (contact + self.target.energy(&x.state, &x.corner), gradient)
    }

    /// Hessian by central differences of the gradient.
    pub fn finite_difference_hessian(&self, x: &Configuration) -> Mat<f64> {
        const EPSILON: f64 = 1e-7;
        let n = self.unknowns();
        let columns: Vec<Vec<f64>> = (0..n)
            .map(|j| {
                let mut unit = vec![0.0; n];
                unit[j] = 1.0;
                let plus = self.gradient(&self.moved(x, &unit, EPSILON)).1;
                let minus = self.gradient(&self.moved(x, &unit, -EPSILON)).1;
                plus.iter().zip(minus).map(|(p, m)| (p - m) / (2.0 * EPSILON)).collect()
            })
            .collect();
        Mat::from_fn(n, n, |i, j| 0.5 * (columns[j][i] + columns[i][j]))
    }
}

fn block(v: &[f64], at: usize) -> Vec3 {
    Vec3::new(v[at], v[at + 1], v[at + 2])
}

impl Objective for SheetEnergy<'_> {
    type Point = Configuration;
    type Guard = Guard;

    fn energy(&self, x: &Configuration) -> f64 {
        contacts::energy(self, &x.state) + self.target.energy(&x.state, &x.corner)
    }

    fn derivatives(&self, x: &Configuration) -> Derivatives<Guard> {
        let n = self.unknowns();
        let (mut gradient, mut hessian) = (vec![0.0; n], Mat::zeros(n, n));
        let contact = contacts::add_derivatives(self, &x.state, &mut gradient, &mut hessian);
        self.target.add_derivatives(&x.state, &x.corner, self.lattice_index(), &mut gradient, &mut hessian);
        if self.hessian == HessianMethod::FiniteDifference {
            hessian = self.finite_difference_hessian(x);
        }
        let state = &x.state;
        let pairs = topology::close_pairs(self.model, state, GUARD_MARGIN * self.model.largest_radius)
            .into_iter()
            .map(|pair| (pair, topology::core_distance(self.model, state, &pair)))
            .collect();
        // |Δa1 s1 + Δa2 s2| ≤ (|Δa1| |b1| + |Δa2| |b2|) |s1 a1 + s2 a2| with the dual vectors b.
        let (g11, g12, g22) = (state.a1.norm_squared(), state.a1.dot(&state.a2), state.a2.norm_squared());
        let reach_growth = (g11.max(g22) / (g11 * g22 - g12 * g12)).sqrt();
        let energy = contact + self.target.energy(&x.state, &x.corner);
        Derivatives { energy, gradient, hessian, guard: Guard { pairs, reach_growth } }
    }

    /// No two circles can meet on the way: along the step every point of a pair moves, relative to the other ring, by at
    /// most |relative motion of the reference points| + reach_i |ω_i| + reach_j |ω_j|, which stays below 0.9 × the
    /// pair's core distance. Pairs farther than the margin are covered together.
    fn largest_step(&self, guard: &Guard, step: &[f64]) -> f64 {
        let model = self.model;
        let lattice = self.lattice_index();
        let (da1, da2) = (block(step, lattice), block(step, lattice + 3));
        let swing = |e: usize| model.elements[e].reach * block(step, 6 * e + 3).norm();
        let mut largest: f64 = (0..model.elements.len()).map(|e| block(step, 6 * e).norm() + swing(e)).fold(0.0, f64::max);
        largest = largest.max(da1.norm()).max(da2.norm());
        let mut fraction: f64 = 1.0;
        let mut limit = |motion: f64, allowed: f64| {
            if motion * fraction > allowed {
                fraction = allowed / motion;
            }
        };
        limit(largest, STEP_CAP * model.largest_radius);
        let margin = GUARD_MARGIN * model.largest_radius;
        let widest = model.elements.iter().map(|e| e.reach).fold(0.0, f64::max);
        let growth = (da1.norm() + da2.norm()) * guard.reach_growth;
        // A pair beyond the margin: distance at least L − 2 widest, motion at most 2 largest + growth (L + cell).
        let origin = model.start.poses[0].position;
        let cell = 2.0 * model.start.poses.iter().map(|p| (p.position - origin).norm()).fold(0.0, f64::max);
        limit(2.0 * largest + growth * (2.0 * widest + margin + cell), CROSSING_MARGIN * margin);
        limit(growth, 0.5);
        for (pair, distance) in &guard.pairs {
            let (i, j) = (model.rings[pair.ring_a].element, model.rings[pair.ring_b].element);
            let (p, q) = (f64::from(pair.shift[0]), f64::from(pair.shift[1]));
            let relative = block(step, 6 * j) - block(step, 6 * i) + da1 * p + da2 * q;
            limit(relative.norm() + swing(i) + swing(j), CROSSING_MARGIN * distance);
        }
        fraction
    }

    fn moved(&self, x: &Configuration, step: &[f64], fraction: f64) -> Configuration {
        let part = |at: usize| block(step, at) * fraction;
        let lattice = self.lattice_index();
        let poses = x.state.poses.iter().enumerate().map(|(e, p)| p.moved(&part(6 * e), &part(6 * e + 3))).collect();
        let state = State { poses, a1: x.state.a1 + part(lattice), a2: x.state.a2 + part(lattice + 3) };
        let corner = match self.target.lattice_unknowns() {
            9 => x.corner + part(lattice + 6),
            _ => state.a1 + state.a2,
        };
        Configuration { state, corner }
    }

    fn kick(&self, attempt: usize) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed.wrapping_add(attempt as u64));
        let size = 1e-3 * self.model.largest_radius;
        (0..self.unknowns())
            .map(|k| if k < self.lattice_index() { size * rng.random_range(-1.0..1.0) } else { 0.0 })
            .collect()
    }
}
