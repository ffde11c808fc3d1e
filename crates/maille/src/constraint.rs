//! The sheet as a constrained program: maximise one strain parameter over poses, every gap non-negative.
//!
//! Unknowns of a step: a translation and a turn for every element (the first element's translation is fixed, because
//! a common translation changes nothing; the turn of a single ring about its own axis is left out for the same
//! reason), then the free strain parameters p. The lattice is affine in p: a_k = base_k + Σ p_m rate_mk.

use crate::{
    contact::kernel::{PairFrame, RootMotion},
    model::Model,
    solve::sqp::{Program, Row},
    state::State,
    topology::{
        self, RingPair,
        crossing::{Motion, StepBound},
    },
};
use maille_geometry::{Vec3, circle_distance_minima};
use nalgebra::{DMatrix, SMatrix};

/// One free strain parameter: how fast it moves the lattice vectors, and its weight in the objective.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Rates of a1 and a2.
    pub rate: [Vec3; 2],
    /// Weight in the maximised sum.
    pub weight: f64,
    /// The parameter may not exceed this.
    pub most: Option<f64>,
}

/// A family of lattices, and what of it is maximised.
#[derive(Clone, Debug)]
pub struct Pull {
    /// Lattice vectors where all parameters are 0.
    pub base: [Vec3; 2],
    /// The free parameters.
    pub parameters: Vec<Parameter>,
}

/// Poses with the values of the strain parameters.
#[derive(Clone, Debug)]
pub struct Posed {
    /// Poses and the lattice that the parameters give.
    pub state: State,
    /// Values of the parameters.
    pub p: Vec<f64>,
}

/// The program of one pull.
pub struct SheetProgram<'a> {
    model: &'a Model,
    pull: &'a Pull,
    /// First unknown of each element's translation (none for the first), and of its turn.
    columns: Vec<(Option<usize>, usize)>,
    spins_freely: Vec<bool>,
    first_parameter: usize,
}

/// Contacts whose 2×2 Hessian in the contact angles is below this (and whose gap is below [`NEAR`]) get extra rows.
const FLAT: f64 = 0.3;
/// See [`FLAT`]; in units of the reference radius.
const NEAR: f64 = 0.1;
/// Angles of the extra rows beside a flat contact.
const BESIDE_RAD: [f64; 6] = [-0.18, -0.12, -0.06, 0.06, 0.12, 0.18];
/// Largest motion of an element in one step, in largest radii.
const STEP_CAP: f64 = 0.5;

impl<'a> SheetProgram<'a> {
    /// The program of `pull` on `model`.
    pub fn new(model: &'a Model, pull: &'a Pull) -> Self {
        let mut next = 0;
        let mut take = |n: usize| {
            next += n;
            next - n
        };
        let spins_freely: Vec<bool> =
            model.elements.iter().map(|e| e.rings.len() == 1 && model.rings[e.rings.start].offset.norm() < 1e-12).collect();
        let columns = spins_freely
            .iter()
            .enumerate()
            .map(|(e, &free)| ((e > 0).then(|| take(3)), take(if free { 2 } else { 3 })))
            .collect();
        let first_parameter = next;
        SheetProgram { model, pull, columns, spins_freely, first_parameter }
    }

    /// Poses of `state` with the lattice of the parameters `p`.
    pub fn posed(&self, mut state: State, p: Vec<f64>) -> Posed {
        let lattice = |k: usize| {
            let free = self.pull.parameters.iter().zip(&p);
            self.pull.base[k] + free.map(|(parameter, value)| parameter.rate[k] * *value).sum::<Vec3>()
        };
        (state.a1, state.a2) = (lattice(0), lattice(1));
        Posed { state, p }
    }

    /// Basis of the turns of element `e` at `state`: two axes across a single ring's normal, or x, y, z.
    fn turns(&self, state: &State, e: usize) -> Vec<Vec3> {
        if !self.spins_freely[e] {
            return vec![Vec3::x(), Vec3::y(), Vec3::z()];
        }
        let circle = state.circle(self.model, self.model.elements[e].rings.start, [0, 0]);
        let (u, v) = circle.frame();
        vec![u, v]
    }

    /// Motion of the step `y` at `state`.
    fn motion(&self, state: &State, y: &[f64]) -> Motion {
        let elements = (0..self.model.elements.len())
            .map(|e| {
                let (translation, turn) = self.columns[e];
                let shift = translation.map_or(Vec3::zeros(), |t| Vec3::new(y[t], y[t + 1], y[t + 2]));
                let turn = self.turns(state, e).iter().enumerate().map(|(k, axis)| axis * y[turn + k]).sum();
                (shift, turn)
            })
            .collect();
        let lattice = [0, 1].map(|k| {
            let rates = self.pull.parameters.iter().enumerate();
            rates.map(|(m, parameter)| parameter.rate[k] * y[self.first_parameter + m]).sum()
        });
        Motion { elements, lattice }
    }

    /// Columns of the unknowns that move the pair, and the 9×k matrix from them to y = (x, α, β).
    fn pair_map(&self, pair: &RingPair, turns: &[Vec<Vec3>]) -> (Vec<usize>, DMatrix<f64>) {
        let (i, j) = (self.model.rings[pair.ring_a].element, self.model.rings[pair.ring_b].element);
        let (mut columns, mut entries): (Vec<usize>, Vec<[f64; 9]>) = (Vec::with_capacity(14), Vec::with_capacity(14));
        let mut add = |column: usize, block: usize, v: &Vec3, sign: f64| {
            let at = columns.iter().position(|&c| c == column).unwrap_or_else(|| {
                columns.push(column);
                entries.push([0.0; 9]);
                columns.len() - 1
            });
            for axis in 0..3 {
                entries[at][3 * block + axis] += sign * v[axis];
            }
        };
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
        if i != j {
            for (element, sign) in [(i, -1.0), (j, 1.0)] {
                if let Some(t) = self.columns[element].0 {
                    axes.iter().enumerate().for_each(|(k, axis)| add(t + k, 0, axis, sign));
                }
            }
        }
        for (element, block) in [(i, 1), (j, 2)] {
            let first = self.columns[element].1;
            turns[element].iter().enumerate().for_each(|(k, axis)| add(first + k, block, axis, 1.0));
        }
        for (m, parameter) in self.pull.parameters.iter().enumerate() {
            let rate = parameter.rate[0] * f64::from(pair.shift[0]) + parameter.rate[1] * f64::from(pair.shift[1]);
            if rate != Vec3::zeros() {
                add(self.first_parameter + m, 0, &rate, 1.0);
            }
        }
        let map = DMatrix::from_fn(9, columns.len(), |r, c| entries[c][r]);
        (columns, map)
    }
}

/// Number of a pair that stays the same from state to state.
fn pair_key(pair: &RingPair) -> u64 {
    let small = |x: i32| (x & 0xfff) as u64;
    (pair.ring_a as u64) << 44 | (pair.ring_b as u64) << 24 | small(pair.shift[0]) << 12 | small(pair.shift[1])
}

/// Key of the row that holds parameter `m` below its bound.
fn bound_key(m: usize) -> u64 {
    u64::MAX - m as u64
}

impl Program for SheetProgram<'_> {
    type Point = Posed;
    type Guard = StepBound;

    fn objective(&self) -> Vec<f64> {
        let mut c = vec![0.0; self.first_parameter + self.pull.parameters.len()];
        for (m, parameter) in self.pull.parameters.iter().enumerate() {
            c[self.first_parameter + m] = parameter.weight;
        }
        c
    }

    fn value(&self, x: &Posed) -> f64 {
        self.pull.parameters.iter().zip(&x.p).map(|(parameter, value)| parameter.weight * value).sum()
    }

    fn rows(&self, x: &Posed, band: f64, derivatives: bool) -> Vec<Row> {
        let (model, state) = (self.model, &x.state);
        let turns: Vec<Vec<Vec3>> = match derivatives {
            true => (0..model.elements.len()).map(|e| self.turns(state, e)).collect(),
            false => Vec::new(),
        };
        let mut rows = Vec::new();
        for (m, parameter) in self.pull.parameters.iter().enumerate() {
            if let Some(most) = parameter.most {
                let columns = vec![self.first_parameter + m];
                let (key, gap) = (bound_key(m), most - x.p[m]);
                rows.push(Row { key, angle: 0.0, gap, minimum: true, columns, gradient: vec![-1.0], hessian: vec![0.0] });
            }
        }
        for pair in topology::close_pairs(model, state, band) {
            let a = state.circle(model, pair.ring_a, [0, 0]);
            let b = state.circle(model, pair.ring_b, pair.shift);
            let touching = model.contact_distance(pair.ring_a, pair.ring_b);
            let minima = circle_distance_minima(&a, &b);
            if minima.closest().distance - touching > band {
                continue;
            }
            let key = pair_key(&pair);
            if !derivatives {
                for m in minima.as_slice() {
                    rows.push(Row::value(key, m.angle_b_rad, m.distance - touching));
                }
                continue;
            }
            let reference_a = state.poses[model.rings[pair.ring_a].element].position;
            let reference_b = state.poses[model.rings[pair.ring_b].element].position + state.translation(pair.shift);
            let frame = PairFrame::new(&a, &reference_a, &b, &reference_b);
            let (columns, map) = self.pair_map(&pair, &turns);
            let mut add = |angle: f64, minimum: bool, distance: f64, grad, hess: SMatrix<f64, 9, 9>| {
                let gradient = (map.transpose() * grad as SMatrix<f64, 9, 1>).data.into();
                let hessian = (map.transpose() * hess * &map).data.into();
                rows.push(Row { key, angle, gap: distance - touching, minimum, columns: columns.clone(), gradient, hessian });
            };
            for m in minima.as_slice().iter().filter(|m| m.distance - touching <= band) {
                let root = frame.jet(m.angle_b_rad);
                let (grad, hess) = root.distance_derivatives(&RootMotion::at(&root));
                add(m.angle_b_rad, true, m.distance, grad, hess);
                let [[aa, ab], [_, bb]] = m.hessian;
                let least = 0.5 * (aa + bb) - (0.5 * (aa - bb)).hypot(ab);
                if least < FLAT && m.distance - touching < NEAR {
                    for offset in BESIDE_RAD {
                        let beside = frame.jet(m.angle_b_rad + offset);
                        let (grad, hess) = beside.distance_derivatives_fixed();
                        add(m.angle_b_rad + offset, false, beside.distance, grad, hess);
                    }
                }
            }
        }
        rows
    }

    fn guard(&self, x: &Posed) -> StepBound {
        StepBound::new(self.model, &x.state)
    }

    fn largest_step(&self, x: &Posed, guard: &StepBound, step: &[f64]) -> f64 {
        guard.largest_fraction(self.model, &self.motion(&x.state, step), STEP_CAP * self.model.largest_radius)
    }

    fn moved(&self, x: &Posed, step: &[f64]) -> Posed {
        let motion = self.motion(&x.state, step);
        let poses = x.state.poses.iter().zip(&motion.elements).map(|(pose, (shift, turn))| pose.moved(shift, turn)).collect();
        let p = x.p.iter().zip(&step[self.first_parameter..]).map(|(p, dp)| p + dp).collect();
        self.posed(State { poses, ..x.state.clone() }, p)
    }
}
