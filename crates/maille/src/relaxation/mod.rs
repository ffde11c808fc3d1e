//! The thesis's energy (chapter 4): contacts, the lattice's targets, forces, and the objective made of them.

pub mod barrier;
mod contacts;
#[doc(hidden)]
pub mod flat;
pub mod limit;
#[doc(hidden)]
pub mod load;
mod options;
pub mod simulate;
#[doc(hidden)]
pub mod target;

pub use contacts::{ContactOptions, MinimaMethod};
pub use target::Protocol;

use crate::{
    model::Model,
    solver::{
        curvature::Curvature,
        newton::{Derivatives, Objective},
    },
    state::State,
    topology::{motion::Motion, side_signs::SideSigns, step_bound::StepBound},
};
use faer::Mat;
use load::Loads;
use maille_geometry::Vec3;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use serde::{Deserialize, Serialize};
use target::Target;

/// How the Hessian is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HessianMethod {
    /// From formulas.
    Analytic,
    /// Central differences of the gradient, symmetrised (eq. 4.3.9, with its second sign put right), ε = 1e-7.
    FiniteDifference,
}

/// A state with the fourth corner of its cell (relative to x1), which only the corner protocol leaves free.
#[doc(hidden)]
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

/// E = E_c + E_b + E_f of a cell or of a finite sheet, as a function of six unknowns an element and, where the lattice
/// has a target, those of the lattice.
#[doc(hidden)]
pub struct SheetEnergy<'a> {
    /// The sheet.
    pub model: &'a Model,
    /// The pull on the lattice; without one the lattice does not move.
    pub target: Option<&'a Target>,
    /// Forces on single elements.
    pub loads: Loads,
    /// The contacts.
    pub contacts: &'a ContactOptions,
    /// How the Hessian is found.
    pub hessian: HessianMethod,
    /// Side signs that steps must keep.
    pub side_signs: Option<&'a SideSigns>,
    /// Seed of the kicks.
    pub seed: u64,
}

/// Largest motion of an element in one step, in largest radii.
const STEP_CAP: f64 = 0.3;

impl<'a> SheetEnergy<'a> {
    /// Contacts alone, with nothing that pulls and no rule but the step bound.
    pub fn new(model: &'a Model, contacts: &'a ContactOptions) -> Self {
        SheetEnergy {
            model,
            target: None,
            loads: Loads::default(),
            contacts,
            hessian: HessianMethod::Analytic,
            side_signs: None,
            seed: 1,
        }
    }

    fn lattice_index(&self) -> usize {
        6 * self.model.elements.len()
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.lattice_index() + self.target.map_or(0, Target::lattice_unknowns)
    }

    /// Energy and gradient alone.
    pub fn gradient(&self, x: &Configuration) -> (f64, Vec<f64>) {
        let (energy, gradient, _) = self.formulas(x);
        (energy, gradient)
    }

    fn formulas(&self, x: &Configuration) -> (f64, Vec<f64>, Curvature) {
        let held = self.loads.held_unknowns();
        let (mut gradient, mut hessian) = (vec![0.0; self.unknowns()], Curvature::new(self.unknowns(), &held));
        let contact = contacts::add_derivatives(self.model, self.contacts, &x.state, &mut gradient, &mut hessian);
        let mut energy = contact + self.loads.energy(self.model, &x.state);
        self.loads.add_derivatives(self.model, &x.state, &mut gradient, &mut hessian);
        if let Some(target) = self.target {
            target.add_derivatives(&x.state, &x.corner, self.lattice_index(), &mut gradient, &mut hessian);
            energy += target.energy(&x.state, &x.corner);
        }
        held.into_iter().for_each(|k| gradient[k] = 0.0);
        (energy, gradient, hessian)
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
    type Guard = StepBound;

    fn energy(&self, x: &Configuration) -> f64 {
        contacts::energy(self.model, self.contacts, &x.state)
            + self.loads.energy(self.model, &x.state)
            + self.target.map_or(0.0, |target| target.energy(&x.state, &x.corner))
    }

    fn slope(&self, x: &Configuration) -> (f64, Vec<f64>, StepBound) {
        let (energy, gradient) = self.gradient(x);
        (energy, gradient, StepBound::new(self.model, &x.state))
    }

    fn derivatives(&self, x: &Configuration) -> Derivatives<StepBound> {
        let (energy, gradient, mut hessian) = self.formulas(x);
        if self.hessian == HessianMethod::FiniteDifference {
            hessian = Curvature::dense(self.finite_difference_hessian(x));
        }
        Derivatives { energy, gradient, hessian, guard: StepBound::new(self.model, &x.state) }
    }

    fn allows(&self, _from: &Configuration, to: &Configuration) -> bool {
        self.side_signs.is_none_or(|signs| signs.kept(self.model, &to.state))
    }

    fn largest_step(&self, guard: &StepBound, step: &[f64]) -> f64 {
        let lattice = self.lattice_index();
        let elements = (0..self.model.elements.len()).map(|e| (block(step, 6 * e), block(step, 6 * e + 3))).collect();
        let moved = match self.target {
            Some(_) => [block(step, lattice), block(step, lattice + 3)],
            None => [Vec3::zeros(); 2],
        };
        let motion = Motion { elements, lattice: moved, ..Motion::default() };
        guard.largest_fraction(self.model, &motion, STEP_CAP * self.model.largest_radius)
    }

    fn moved(&self, x: &Configuration, step: &[f64], fraction: f64) -> Configuration {
        let part = |at: usize| block(step, at) * fraction;
        let lattice = self.lattice_index();
        let poses = x.state.poses.iter().enumerate().map(|(e, p)| p.moved(&part(6 * e), &part(6 * e + 3))).collect();
        let mut state = State { poses, ..x.state };
        if self.target.is_some() {
            state.a1 += part(lattice);
            state.a2 += part(lattice + 3);
        }
        let corner = match self.unknowns() - lattice {
            9 => x.corner + part(lattice + 6),
            _ => state.a1 + state.a2,
        };
        Configuration { state, corner }
    }

    fn kick(&self, attempt: usize) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed.wrapping_add(attempt as u64));
        let size = 1e-3 * self.model.largest_radius;
        let mut kick: Vec<f64> = (0..self.unknowns())
            .map(|k| if k < self.lattice_index() { size * rng.random_range(-1.0..1.0) } else { 0.0 })
            .collect();
        self.loads.held_unknowns().into_iter().for_each(|k| kick[k] = 0.0);
        kick
    }
}
