//! The sheet as a constrained program: maximise one strain parameter over poses, every gap non-negative.
//!
//! Unknowns of a step: a translation and a turn for every element (the first element's translation is fixed, because
//! a common translation changes nothing; the turn of a single ring about its own axis is left out for the same
//! reason), then the free strain parameters p. The lattice is affine in p: a_k = base_k + Σ p_m rate_mk.

use crate::{
    contact::kernel::{PairFrame, RootMotion},
    model::Model,
    solve::sqp::{Multiplier, Program, Row},
    state::State,
    topology::{
        self, RingPair,
        crossing::{Motion, StepBound},
    },
};
use maille_geometry::{Vec3, circle_distance_minima, point_circle_distance};
use nalgebra::{DMatrix, SMatrix};
use std::collections::BTreeSet;

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
    flat: BTreeSet<u64>,
}

/// Contacts whose 2×2 Hessian in the contact angles is below this (and whose gap is below [`NEAR`]) get extra rows.
const FLAT: f64 = 0.3;
/// See [`FLAT`]; in units of the reference radius.
const NEAR: f64 = 0.1;
/// Angles of the extra rows beside a flat contact.
const BESIDE_RAD: [f64; 6] = [-0.18, -0.12, -0.06, 0.06, 0.12, 0.18];
/// Largest motion of an element in one step, in largest radii.
const STEP_CAP: f64 = 0.5;
/// Sine of the tilt below which a pair can be flat.
const FLAT_TILT: f64 = 0.08;
/// Offset of the axes below which a pair can be flat, in radii.
const FLAT_APART: f64 = 0.08;
/// Heights that stand for a flat pair's gap.
const HEIGHTS: usize = 16;

/// A loaded contact of a locked state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The rings.
    pub pair: RingPair,
    /// Point on A's core circle.
    pub point_a: Vec3,
    /// Point on B's core circle, in the image.
    pub point_b: Vec3,
    /// Force on B per unit of the objective, along point_b − point_a: the row's multiplier.
    pub force: f64,
}

impl<'a> SheetProgram<'a> {
    /// The program of `pull` on `model`.
    pub fn new(model: &'a Model, pull: &'a Pull) -> Self {
        let mut next = 0;
        let mut take = |n: usize| {
            next += n;
            next - n
        };
        let spins_freely: Vec<bool> = model
            .elements
            .iter()
            .map(|e| e.rings.len() == 1 && model.rings[e.rings.start].offset.norm() < 1e-12)
            .collect();
        let columns = spins_freely
            .iter()
            .enumerate()
            .map(|(e, &free)| ((e > 0).then(|| take(3)), take(if free { 2 } else { 3 })))
            .collect();
        let first_parameter = next;
        SheetProgram { model, pull, columns, spins_freely, first_parameter, flat: BTreeSet::new() }
    }

    /// Takes the pairs of `x` that touch along nearly the whole circle as flat: equal radii, nearly parallel and
    /// coaxial. Their one gap is a cone there, h − s − R |tilt|, with its tip at the limit; from now on sixteen heights
    /// of B's points over A's plane must be at least s, which implies the gap, is smooth, and is exact where the rings
    /// are parallel. Returns whether the set of flat pairs has changed.
    pub fn take_flat_pairs(&mut self, x: &Posed) -> bool {
        let (model, state) = (self.model, &x.state);
        let mut flat = BTreeSet::new();
        for pair in topology::close_pairs(model, state, 0.0) {
            let a = state.circle(model, pair.ring_a, [0, 0]);
            let b = state.circle(model, pair.ring_b, pair.shift);
            let touching = model.contact_distance(pair.ring_a, pair.ring_b);
            let between = b.center - a.center;
            let height = between.dot(&a.normal);
            let apart = (between - a.normal.into_inner() * height).norm();
            let tilt = a.normal.cross(&b.normal).norm();
            let equal = (a.radius - b.radius).abs() < 1e-9 * a.radius;
            if equal && tilt < FLAT_TILT && apart < FLAT_APART * a.radius && height.abs() < touching * 1.1 {
                flat.insert(pair_key(&pair));
            }
        }
        let changed = flat != self.flat;
        self.flat = flat;
        changed
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

    /// The contacts that carry `multipliers` at `x`.
    pub fn contacts(&self, x: &Posed, multipliers: &[Multiplier]) -> Vec<Contact> {
        let loaded = multipliers.iter().filter(|m| m.value > 1e-9 && m.key < bound_key(0xffff));
        loaded
            .map(|m| {
                let pair = pair_of_key(m.key);
                let a = x.state.circle(self.model, pair.ring_a, [0, 0]);
                let point_b = x.state.circle(self.model, pair.ring_b, pair.shift).point(m.angle);
                Contact { pair, point_a: point_circle_distance(&point_b, &a).point, point_b, force: m.value }
            })
            .collect()
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

/// The pair of a key.
fn pair_of_key(key: u64) -> RingPair {
    let small = |bits: u64| ((bits & 0xfff) as i32) << 20 >> 20;
    RingPair {
        ring_a: (key >> 44) as usize,
        ring_b: (key >> 24 & 0xf_ffff) as usize,
        shift: [small(key >> 12), small(key)],
    }
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
                rows.push(Row {
                    key,
                    angle: 0.0,
                    gap,
                    minimum: true,
                    columns,
                    gradient: vec![-1.0],
                    hessian: vec![0.0],
                });
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
                rows.push(Row {
                    key,
                    angle,
                    gap: distance - touching,
                    minimum,
                    columns: columns.clone(),
                    gradient,
                    hessian,
                });
            };
            if self.flat.contains(&key) {
                for k in 0..HEIGHTS {
                    let angle = std::f64::consts::TAU * k as f64 / HEIGHTS as f64;
                    let (z, grad, hess) = frame.height(angle);
                    let side = (b.center - a.center).dot(&a.normal).signum();
                    add(angle, false, side * z, grad * side, hess * side);
                }
                continue;
            }
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
        let poses =
            x.state.poses.iter().zip(&motion.elements).map(|(pose, (shift, turn))| pose.moved(shift, turn)).collect();
        let p = x.p.iter().zip(&step[self.first_parameter..]).map(|(p, dp)| p + dp).collect();
        self.posed(State { poses, ..x.state.clone() }, p)
    }

    /// A flat pair with offset e of its axes: the true gap at B's direction u is (e·u)²/2s above the height. Of all ways
    /// to spread the pair's force Σ μ = N and moment Σ μ u = T over the circle, the one that uses this least leaves a
    /// curvature −(T·e)²/(N s).
    fn hidden_curvature(&self, x: &Posed, multipliers: &[Multiplier]) -> Vec<Vec<f64>> {
        let (model, state) = (self.model, &x.state);
        let n = self.first_parameter + self.pull.parameters.len();
        let mut out = Vec::new();
        for &key in &self.flat {
            let pair = pair_of_key(key);
            let b = state.circle(model, pair.ring_b, pair.shift);
            let (u, v) = b.frame();
            let (mut force, mut moment) = (0.0, Vec3::zeros());
            for m in multipliers.iter().filter(|m| m.key == key && m.value > 0.0) {
                force += m.value;
                moment += (u * m.angle.cos() + v * m.angle.sin()) * m.value;
            }
            if force < 1e-9 {
                continue;
            }
            let weight = (force * model.contact_distance(pair.ring_a, pair.ring_b)).sqrt();
            let turns: Vec<Vec<Vec3>> = (0..model.elements.len()).map(|e| self.turns(state, e)).collect();
            let (columns, map) = self.pair_map(&pair, &turns);
            let mut term = vec![0.0; n];
            for (c, &column) in columns.iter().enumerate() {
                term[column] = (0..3).map(|axis| map[(axis, c)] * moment[axis]).sum::<f64>() / weight;
            }
            out.push(term);
        }
        out
    }
}
