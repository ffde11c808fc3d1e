//! The lattices of a stretch, and what of them is free.
//!
//! F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ + γ D D⊥ᵀ (see [`Across`]): linear in l1, l2, γ. A limit maximises l1 with the free ones of
//! l2 and γ as further unknowns. At a limit they need not be unique, so two more solves for each give the least and the
//! largest value that was found with l1 held at the limit.

use super::{
    local::LocalSolution,
    options::{FEASIBLE, FREE_SLACK, RANGE_ROUNDS},
    starts::Start,
};
use crate::{
    answer::FreeRanges,
    bound::{Bound, ChainBound, LinkBound, best_bound_across},
    lattice::{Across, Direction},
    model::Model,
    program::{LatticeFamily, Parameter, SheetProgram},
    solver::sqp::{SqpOptions, maximize},
    state::State,
    topology,
};
use maille_geometry::Vec3;
use nalgebra::Matrix2;
use std::sync::atomic::AtomicBool;

/// The lattices of a stretch along one direction.
pub(super) struct StretchLattices {
    reference: [Vec3; 2],
    direction: Direction,
    pub across: Across,
    /// 1 where l1 is maximised, −1 where it is minimised: the first parameter is this times l1.
    sign: f64,
}

/// How far the first parameter of `pull` can be raised from 0, beginning with `state`; with the quadratic programs that it took.
/// Not certified: it is where a state was found, so a range that ends there is an inner one. `None` where none was found.
pub(super) fn farthest(model: &Model, pull: &LatticeFamily, state: &State, cancel: &AtomicBool) -> (Option<f64>, u64) {
    let program = SheetProgram::new(model, pull);
    let mut x = program.posed(state.clone(), vec![0.0; pull.parameters.len()]);
    let (mut known, mut iterations, mut end) = (Vec::new(), 0, None);
    for _ in 0..RANGE_ROUNDS {
        let found = maximize(&program, x, known, &SqpOptions::default(), cancel);
        iterations += found.iterations as u64;
        (x, known) = (found.point, found.multipliers);
        if found.violation < FEASIBLE && topology::links_kept(model, &x.state) {
            end = Some(x.p[0].max(0.0));
        }
        if found.settled {
            break;
        }
    }
    (end, iterations)
}

impl StretchLattices {
    /// `sign` is 1 where l1 is maximised, −1 where it is minimised.
    pub(crate) fn new(model: &Model, direction: Direction, across: Across, sign: f64) -> Self {
        StretchLattices { reference: [model.start.a1, model.start.a2], direction, across, sign }
    }

    pub fn lattice(&self, l1: f64, l2: f64, shear: f64) -> [Vec3; 2] {
        let f = self.direction.gradient(l1, l2, shear);
        self.reference.map(|a| {
            let v = f * a.xy();
            Vec3::new(v.x, v.y, 0.0)
        })
    }

    /// F at the parameters `p` of [`Self::pull`].
    pub(crate) fn gradient(&self, p: &[f64], l2: f64) -> Matrix2<f64> {
        let [l2, shear] = self.free_of(p, l2);
        self.direction.gradient(self.sign * p[0], l2, shear)
    }

    /// l2 and γ at the parameters `p`.
    pub(super) fn free_of(&self, p: &[f64], l2: f64) -> [f64; 2] {
        let mut free = p[1..].iter().copied();
        let l2 = if self.across.lateral_free { free.next().unwrap_or(l2) } else { l2 };
        [l2, free.next().unwrap_or(0.0)]
    }

    /// Rates of the lattice with l1, l2 and γ.
    fn rates(&self) -> [[Vec3; 2]; 3] {
        let (d, side) = (self.direction.along().push(0.0), self.direction.across().push(0.0));
        [(d, d), (side, side), (d, side)].map(|(to, of)| self.reference.map(|a| to * of.dot(&a)))
    }

    /// l1 maximised, or −l1; l2 held at its value or free, γ held at 0 or free.
    pub(crate) fn pull(&self, l2: f64) -> LatticeFamily {
        let [along, lateral, shear] = self.rates();
        let parameter = |rate, weight| Parameter { rate, weight, ..Parameter::default() };
        let mut parameters = vec![parameter(along.map(|v| v * self.sign), 1.0)];
        parameters.extend(self.across.lateral_free.then(|| parameter(lateral, 0.0)));
        parameters.extend(self.across.shear_free.then(|| parameter(shear, 0.0)));
        let l2 = if self.across.lateral_free { 0.0 } else { l2 };
        LatticeFamily { base: self.lattice(0.0, l2, 0.0), parameters, metric: None, roll: None }
    }

    /// The parameters of [`Self::pull`] at a state.
    pub(crate) fn parameters(&self, at: &Start) -> Vec<f64> {
        let lateral = self.across.lateral_free.then_some(at.l2);
        let shear = self.across.shear_free.then_some(at.shear);
        [Some(self.sign * at.l1), lateral, shear].into_iter().flatten().collect()
    }

    /// From the l2 of a state towards `to`, l1 free, γ as it is there.
    pub(crate) fn approach(&self, at: &Start, to: f64) -> LatticeFamily {
        let [along, lateral, _] = self.rates();
        let sign = (to - at.l2).signum();
        let l1 = Parameter { rate: along, ..Parameter::default() };
        let most = Some((to - at.l2).abs());
        let l2 = Parameter { rate: lateral.map(|v| v * sign), weight: 1.0, most, ..Parameter::default() };
        LatticeFamily { base: self.lattice(0.0, at.l2, at.shear), parameters: vec![l1, l2], metric: None, roll: None }
    }

    /// Least and largest l2 and γ that are found from the state of a limit, with l1 held there less a slack of
    /// [`FREE_SLACK`] (1 + l1); with the quadratic programs that it took.
    pub(crate) fn ranges(
        &self,
        model: &Model,
        limit: &LocalSolution,
        l2: f64,
        cancel: &AtomicBool,
    ) -> (FreeRanges, u64) {
        let l1 = self.sign * limit.p[0];
        let l1 = l1 - self.sign * FREE_SLACK * (1.0 + l1);
        let [l2, shear] = self.free_of(&limit.p, l2);
        let [_, lateral_rate, shear_rate] = self.rates();
        let wanted = [(self.across.lateral_free, lateral_rate), (self.across.shear_free, shear_rate)];
        let mut iterations = 0;
        let mut ends = [[l2; 2], [shear; 2]];
        for (k, end) in ends.iter_mut().enumerate().filter(|(k, _)| wanted[*k].0) {
            let from = end[0];
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                // The wanted one first, then the other if it is free.
                let order = [k, 1 - k].into_iter().filter(|m| wanted[*m].0);
                let parameters = order.map(|m| Parameter {
                    rate: wanted[m].1.map(|v| v * sign),
                    weight: if m == k { 1.0 } else { 0.0 },
                    ..Parameter::default()
                });
                let pull = LatticeFamily {
                    base: self.lattice(l1, l2, shear),
                    parameters: parameters.collect(),
                    metric: None,
                    roll: None,
                };
                let (moved, more) = farthest(model, &pull, &limit.state, cancel);
                iterations += more;
                end[side] = moved.map_or(from, |moved| from + sign * moved);
            }
        }
        let [l2, shear] = ends;
        (FreeRanges { l2, shear }, iterations)
    }
    /// `ranges` without what the bounds exclude at the limit `l1` itself, where `at` are l2 and γ: with l1 given way an end can
    /// lie beyond, by the slack or, where two chains hold it, by the root of the slack.
    ///
    /// l2 is bounded as l1 is, in the direction across: with l1 held there if γ is 0, else with all else free. γ is bounded by
    /// the chains, |F x| ≤ 1 with x = v/d: |(1 + l1) D·x + γ D⊥·x|² ≤ 1 − ((1 + l2) D⊥·x)², with l2 = −1 where it is free.
    pub(crate) fn attainable(
        &self,
        ranges: FreeRanges,
        (chain, link): (&ChainBound, &LinkBound),
        l1: f64,
        at: [f64; 2],
    ) -> FreeRanges {
        let FreeRanges { mut l2, mut shear } = ranges;
        if self.across.lateral_free {
            let free =
                if self.across.shear_free { Across { lateral_free: true, shear_free: true } } else { Across::HELD };
            let most = match best_bound_across(chain, Some(link), self.direction.left(), l1, free) {
                Bound::Finite { l1: most, .. } => most,
                // l1 is above what is proved by rounding: no more room than the limit's own.
                Bound::L2Unreachable { .. } => at[0],
                Bound::Unbounded => f64::INFINITY,
            };
            l2[1] = l2[1].min(most).max(at[0]);
        }
        if self.across.shear_free {
            let width = if self.across.lateral_free { 0.0 } else { 1.0 + at[0] };
            // A chain along D holds no shear.
            let (d, across) = (self.direction.along(), self.direction.across());
            let leaning = chain.directions().filter(|x| across.dot(x).abs() > 1e-9 * x.norm());
            for x in leaning {
                let (along, side) = (d.dot(&x) * (1.0 + l1), across.dot(&x));
                let room = (1.0 - (width * side).powi(2)).max(0.0).sqrt();
                let mut ends = [(-room - along) / side, (room - along) / side];
                ends.sort_by(f64::total_cmp);
                shear = [shear[0].max(ends[0]).min(at[1]), shear[1].min(ends[1]).max(at[1])];
            }
        }
        FreeRanges { l2, shear }
    }
}
