//! The sheet as a constrained program: maximise one parameter over poses, every gap non-negative.
//!
//! Unknowns of a step: a translation and a turn for every element (the first element's translation is fixed, because
//! a common translation changes nothing; the turn of a single ring about its own axis is left out for the same
//! reason), then the free parameters p. The lattice carries the copies of the design's cell along, so that in a large cell
//! translations are what is left beside a common strain. The lattice is affine in p, a_k = base_k + Σ p_m rate_mk, or its metric is (see
//! [`metric`]). The core distance s that two rings must keep is affine: s = (r_a + r_b)(1 + Σ p_m thicken_m) + Σ p_m
//! widen_m.

mod area;
mod closed;
pub(crate) mod curve_kernel;
mod curve_pair;
pub mod flat;
pub mod gap_kernel;
pub mod key;
pub mod metric;
mod neutral;
mod pair;
mod rolled;
pub mod waves;

use self::{
    key::{bound_key, pair_key, pair_of_key},
    metric::Factored,
};
use crate::{
    model::{Core, Model},
    solver::{
        certificate::CARRIED,
        constraints::{Derivatives, Loads, Multiplier, Row},
        sqp::Program,
    },
    state::{Roll, State},
    topology::{
        RingPair,
        motion::{MARGIN, Motion},
        near_pairs::{NearPair, near_pairs},
        step_bound::StepBound,
        winding::winds,
    },
};
use maille_geometry::{Vec3, point_circle_distance};
use nalgebra::Matrix2;
use std::{cell::OnceCell, collections::BTreeSet, rc::Rc};

/// One free parameter: how fast it moves the lattice vectors or thickens the wire, and its weight in the objective.
#[derive(Clone, Debug, Default)]
pub struct Parameter {
    /// Rates of a1 and a2.
    pub rate: [Vec3; 2],
    /// Rates of the turns of a1 and a2, where the sheet is rolled.
    pub turn_rad: [f64; 2],
    /// Rate of the metric C instead, where the pull has one.
    pub metric: Matrix2<f64>,
    /// Growth of all minor radii, as a share of them.
    pub thicken: f64,
    /// Growth of the gap that all rings must keep.
    pub widen: f64,
    /// Weight in the maximised sum.
    pub weight: f64,
    /// The parameter may not exceed this.
    pub most: Option<f64>,
    /// The parameter may not exceed the share of the area that is saved, 1 − A/A₀; see `area.rs`.
    pub saves_area: bool,
    /// The parameter may not exceed this sign times the radius of the neutral surface, whose turns are held; 0 where it does not bound it. See
    /// `neutral.rs`.
    pub radius_sign: f64,
}

impl Parameter {
    /// Rates of the lattice vector with these coordinates and of its turn.
    fn at(&self, [first, second]: [f64; 2]) -> (Vec3, f64) {
        (self.rate[0] * first + self.rate[1] * second, self.turn_rad[0] * first + self.turn_rad[1] * second)
    }

    /// Rate of the distance that rings which touch at `touching` must keep.
    fn keeps(&self, touching: f64) -> f64 {
        self.thicken * touching + self.widen
    }
}

/// A family of lattices, and what of it is maximised.
#[derive(Clone, Debug)]
pub struct LatticeFamily {
    /// Lattice vectors where all parameters are 0.
    pub base: [Vec3; 2],
    /// The free parameters.
    pub parameters: Vec<Parameter>,
    /// The metric C where all parameters are 0, if it is C that is affine in them: the lattice vectors are then F(C) base.
    pub metric: Option<Matrix2<f64>>,
    /// How the sheet is rolled where all parameters are 0; `None` where it stays flat. A family with a metric stays flat.
    pub roll: Option<Roll>,
}

impl LatticeFamily {
    /// The metric at `p`, where the pull has one.
    fn metric_at(&self, p: &[f64]) -> Option<Matrix2<f64>> {
        let moved = self.parameters.iter().zip(p).map(|(parameter, value)| parameter.metric * *value);
        self.metric.map(|base| base + moved.sum::<Matrix2<f64>>())
    }

    /// The factor of the metric at `p`, where the pull has one.
    fn factored(&self, p: &[f64]) -> Option<Factored> {
        let rates: Vec<Matrix2<f64>> = self.parameters.iter().map(|parameter| parameter.metric).collect();
        Factored::new(&self.metric_at(p)?, &rates)
    }

    /// The lattice vectors at `p`. A metric that is not positive definite gives those where all parameters are 0; no step
    /// leads there.
    fn lattice(&self, p: &[f64]) -> [Vec3; 2] {
        if let Some(c) = self.metric_at(p) {
            return metric::factor(&c).map_or(self.base, |f| self.base.map(|a| metric::apply(&f, &a)));
        }
        let moved = |k: usize| {
            let free = self.parameters.iter().zip(p);
            self.base[k] + free.map(|(parameter, value)| parameter.rate[k] * *value).sum::<Vec3>()
        };
        [moved(0), moved(1)]
    }

    /// How the sheet is rolled at `p`.
    fn rolled(&self, p: &[f64]) -> Option<Roll> {
        let moved =
            |k: usize| self.parameters.iter().zip(p).map(|(parameter, p)| parameter.turn_rad[k] * p).sum::<f64>();
        self.roll.map(|base| Roll { turn_rad: [0, 1].map(|k| base.turn_rad[k] + moved(k)), ..base })
    }

    /// Whether the metric stays positive definite, and far from not being so, on the step from `p` to `to`.
    fn stays_definite(&self, p: &[f64], to: &[f64]) -> bool {
        let (Some(from), Some(to)) = (self.metric_at(p), self.metric_at(to)) else { return true };
        to[(0, 0)] > STEEPEST * from[(0, 0)] && to.determinant() > STEEPEST * from.determinant()
    }
}

/// Poses with the values of the strain parameters.
#[derive(Clone)]
pub struct Posed {
    /// Poses and the lattice that the parameters give.
    pub state: State,
    /// Values of the parameters.
    pub p: Vec<f64>,
    /// Its near pairs, once they are asked for.
    near: OnceCell<Rc<[NearPair]>>,
}

/// The program of one pull.
pub struct SheetProgram<'a> {
    model: &'a Model,
    pull: &'a LatticeFamily,
    /// First unknown of each element's translation (none for the first), and of its turn.
    columns: Vec<(Option<usize>, usize)>,
    spins_freely: Vec<bool>,
    first_parameter: usize,
    /// Wire, as a share of the model's.
    wire: f64,
    /// Pairs whose rows are heights, see [`flat`].
    flat: BTreeSet<u64>,
    /// Pairs that were flat, and are not to be again.
    released: BTreeSet<u64>,
}

/// Rows are asked for up to this gap, in units of the reference radius.
const WIDEST_BAND: f64 = 1.0;
/// Largest motion of an element in one step, in largest radii.
const STEP_CAP: f64 = 0.5;
/// A step may not shrink the metric's determinant below this part.
const STEEPEST: f64 = 0.25;
/// Times that a step whose lattice moves on a curve is cut.
const CUTS: usize = 40;

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
    pub fn new(model: &'a Model, pull: &'a LatticeFamily) -> Self {
        let mut next = 0;
        let mut take = |n: usize| {
            next += n;
            next - n
        };
        let spins_freely: Vec<bool> = model
            .elements
            .iter()
            .map(|e| {
                let first = &model.rings[e.rings.start];
                e.rings.len() == 1 && first.is_round() && first.offset.norm() < 1e-12
            })
            .collect();
        let columns = spins_freely
            .iter()
            .enumerate()
            .map(|(e, &free)| ((e > 0).then(|| take(3)), take(if free { 2 } else { 3 })))
            .collect();
        let first_parameter = next;
        let (flat, released) = Default::default();
        SheetProgram { model, pull, columns, spins_freely, first_parameter, wire: 1.0, flat, released }
    }

    /// The same program with all minor radii this share of the model's.
    pub(crate) fn with_wire(self, wire: f64) -> Self {
        SheetProgram { wire, ..self }
    }

    /// Poses of `state` with the lattice of the parameters `p`.
    pub fn posed(&self, mut state: State, p: Vec<f64>) -> Posed {
        [state.a1, state.a2] = self.pull.lattice(&p);
        state.roll = self.pull.rolled(&p);
        Posed { state, p, near: OnceCell::new() }
    }

    /// The contacts that carry `multipliers` at `x`.
    pub fn contacts(&self, x: &Posed, multipliers: &[Multiplier]) -> Vec<Contact> {
        let loaded = multipliers.iter().filter(|m| m.value > CARRIED && m.key < bound_key(0xffff));
        loaded
            .map(|m| {
                let pair = pair_of_key(m.key);
                let a = x.state.core(self.model, pair.ring_a, [0, 0]);
                let b = x.state.core(self.model, pair.ring_b, pair.shift);
                let [point_a, point_b] = match (&a, &b) {
                    (Core::Circle(a), Core::Circle(b)) => {
                        let point_b = b.point(m.angle);
                        [point_circle_distance(&point_b, a).point, point_b]
                    }
                    _ => [a.at_angle(m.angle_a).point, b.at_angle(m.angle).point],
                };
                Contact { pair, point_a, point_b, force: m.value }
            })
            .collect()
    }

    /// The core distance that rings which touch at `touching` must keep at `x`.
    fn required(&self, x: &Posed, touching: f64) -> f64 {
        let parameters = self.pull.parameters.iter().zip(&x.p);
        self.wire * touching + parameters.map(|(parameter, p)| p * parameter.keeps(touching)).sum::<f64>()
    }

    /// The near pairs of `x`.
    fn near<'x>(&self, x: &'x Posed) -> &'x Rc<[NearPair]> {
        let margin = (MARGIN * self.model.largest_radius).max(WIDEST_BAND);
        x.near.get_or_init(|| near_pairs(self.model, &x.state, margin).into())
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

    fn all_turns(&self, state: &State) -> Vec<Vec<Vec3>> {
        (0..self.model.elements.len()).map(|e| self.turns(state, e)).collect()
    }

    /// Motion of the step `y` at `x`. Where the lattice moves on a curve it is the straight way to the curve's end: what the
    /// step bound asks for is some way on which no circles meet.
    fn motion(&self, x: &Posed, y: &[f64]) -> Motion {
        let elements = (0..self.model.elements.len())
            .map(|e| {
                let (translation, turn) = self.columns[e];
                let shift = translation.map_or(Vec3::zeros(), |t| Vec3::new(y[t], y[t + 1], y[t + 2]));
                let turn = self.turns(&x.state, e).iter().enumerate().map(|(k, axis)| axis * y[turn + k]).sum();
                (shift, turn)
            })
            .collect();
        let lattice = if self.pull.metric.is_some() {
            let [a1, a2] = self.pull.lattice(&self.stepped(x, y));
            [a1 - x.state.a1, a2 - x.state.a2]
        } else {
            [0, 1].map(|k| {
                let rates = self.pull.parameters.iter().enumerate();
                rates.map(|(m, parameter)| parameter.rate[k] * y[self.first_parameter + m]).sum()
            })
        };
        let turn_rad = [0, 1].map(|k| {
            let rates = self.pull.parameters.iter().enumerate();
            rates.map(|(m, parameter)| parameter.turn_rad[k] * y[self.first_parameter + m]).sum()
        });
        Motion { elements, lattice, turn_rad, carried: true }
    }

    /// The parameters after the step `y`.
    fn stepped(&self, x: &Posed, y: &[f64]) -> Vec<f64> {
        x.p.iter().zip(&y[self.first_parameter..]).map(|(p, dp)| p + dp).collect()
    }
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

    fn rows(&self, x: &Posed, band: f64, derivatives: Derivatives<'_>) -> Vec<Row> {
        let mut rows = self.bound_rows(x);
        let near = self.near(x);
        let required = |near: &NearPair| self.required(x, near.touching);
        let within = near.iter().filter(|near| near.within(band + required(near) - near.touching));
        if matches!(derivatives, Derivatives::None) {
            for near in within {
                let key = pair_key(&near.pair);
                rows.extend(near.curve_minima(band + required(near)).iter().map(|m| Row {
                    angle_a: m.a.angle_rad,
                    ..Row::value(key, m.b.angle_rad, m.distance - required(near))
                }));
                rows.extend(
                    near.minima().iter().map(|m| Row::value(key, m.angle_b_rad(), m.distance - required(near))),
                );
            }
            return rows;
        }
        let turns = self.all_turns(&x.state);
        let factored = self.pull.factored(&x.p);
        for near in within {
            let map = self.pair_map(x, &near.pair, &turns, factored.as_ref());
            self.pair_rows(x, near, band, &map, derivatives, &mut rows);
        }
        rows
    }

    fn closed_rows(&self, x: &Posed, band: f64, loads: &Loads) -> Option<Vec<Row>> {
        let flat: Vec<&NearPair> =
            self.near(x).iter().filter(|near| self.flat.contains(&pair_key(&near.pair))).collect();
        if !flat.iter().any(|near| loads.carries(pair_key(&near.pair))) {
            return None;
        }
        let rows = self.rows(x, band, Derivatives::First);
        let carried = loads.of(&rows);
        let carries = rows.into_iter().zip(carried).filter(|(row, mu)| *mu != 0.0 && !self.flat.contains(&row.key));
        let mut rows: Vec<Row> = carries.map(|(row, _)| row).collect();
        let turns = self.all_turns(&x.state);
        let factored = self.pull.factored(&x.p);
        for near in flat.into_iter().filter(|near| loads.carries(pair_key(&near.pair))) {
            self.closed_gaps(x, near, (&turns, factored.as_ref()), &mut rows);
        }
        Some(rows)
    }

    fn guard(&self, x: &Posed) -> StepBound {
        StepBound::of(self.model, &x.state, Rc::clone(self.near(x)))
    }

    fn largest_step(&self, x: &Posed, guard: &StepBound, step: &[f64]) -> f64 {
        let allowed = |step: &[f64]| {
            guard.largest_fraction(self.model, &self.motion(x, step), STEP_CAP * self.model.largest_radius)
        };
        if self.pull.metric.is_none() {
            return allowed(step);
        }
        let mut fraction = 1.0;
        for _ in 0..CUTS {
            let cut: Vec<f64> = step.iter().map(|s| s * fraction).collect();
            let part = if self.pull.stays_definite(&x.p, &self.stepped(x, &cut)) { allowed(&cut) } else { 0.5 };
            if part >= 1.0 {
                return fraction;
            }
            fraction *= 0.99 * part;
        }
        0.0
    }

    fn is_outside(&self, x: &Posed) -> bool {
        !winds(self.model, &x.state)
    }

    fn moved(&self, x: &Posed, step: &[f64]) -> Posed {
        let motion = self.motion(x, step);
        if x.state.roll.is_some() {
            return self.moved_rolled(x, &motion, self.stepped(x, step));
        }
        let moved = x.state.poses.iter().zip(&motion.elements).enumerate();
        let moved = moved.map(|(e, (pose, (shift, turn)))| pose.moved(&(shift + motion.carries(self.model, e)), turn));
        let poses = moved.collect();
        self.posed(State { poses, ..x.state.clone() }, self.stepped(x, step))
    }

    fn hidden_curvature(&self, x: &Posed, multipliers: &[Multiplier]) -> Vec<Vec<f64>> {
        let (turns, factored) = (self.all_turns(&x.state), self.pull.factored(&x.p));
        let n = self.first_parameter + self.pull.parameters.len();
        let term = |&key: &u64| {
            let v = self.flat_curvature(x, multipliers, key)?;
            let map = self.pair_map(x, &pair_of_key(key), &turns, factored.as_ref());
            let mut term = vec![0.0; n];
            map.columns.iter().zip(map.gradient(&v)).for_each(|(&column, entry)| term[column] = entry);
            Some(term)
        };
        self.flat.iter().filter_map(term).collect()
    }
}
