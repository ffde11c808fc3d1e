//! How far a step may go so that no two core circles can meet on the way: what keeps the topology.
//!
//! Along a step every point of a pair of rings moves, relative to the other ring, by at most
//! |relative motion of the reference points| + reach_i |ω_i| + reach_j |ω_j|. While that stays below the pair's core
//! distance the circles cannot meet, so the isotopy class of the whole sheet is kept, which linking numbers alone do
//! not ensure for elements of several rings. Steps of rolled sheets are in `rolled_step`.

use super::{
    motion::{MARGIN, Motion, SAFETY, largest_growth},
    near_pairs::{NearPair, near_pairs},
    rolled_step::RolledBound,
};
use crate::{
    model::{Element, Model},
    state::{Pose, State},
};
use maille_geometry::Vec3;
use std::rc::Rc;

/// Core distances around a state, from which steps are bounded. A distance is looked for only where its floor would cut
/// the step.
pub struct StepBound {
    pairs: Rc<[NearPair]>,
    /// What is known of a rolled state.
    rolled: Option<RolledBound>,
    /// The lattice vectors.
    lattice: [Vec3; 2],
    /// Twice the farthest of an element from the first one; of where the lattice carries it.
    spread: f64,
    spread_carried: f64,
}

impl StepBound {
    /// At `state`.
    pub(crate) fn new(model: &Model, state: &State) -> Self {
        Self::of(model, state, near_pairs(model, state, MARGIN * model.largest_radius).into())
    }

    /// At `state`, whose near pairs up to [`MARGIN`] largest radii or more are `pairs`.
    pub(crate) fn of(model: &Model, state: &State, pairs: Rc<[NearPair]>) -> Self {
        let origin = state.poses[0].position;
        let spread = 2.0 * state.poses.iter().map(|p| (p.position - origin).norm()).fold(0.0, f64::max);
        let beside = |(pose, element): (&Pose, &Element)| {
            let [u, v] = element.anchor;
            (pose.position - origin - state.a1 * u - state.a2 * v).norm()
        };
        let spread_carried = 2.0 * state.poses.iter().zip(&model.elements).map(beside).fold(0.0, f64::max);
        let rolled = state.roll.as_ref().map(|roll| RolledBound::new(model, state, roll));
        StepBound { pairs, rolled, lattice: [state.a1, state.a2], spread, spread_carried }
    }

    /// Largest fraction of `motion`, at most 1, in which no circles can meet and no element moves more than `cap`.
    pub(crate) fn largest_fraction(&self, model: &Model, motion: &Motion, cap: f64) -> f64 {
        if let Some(rolled) = &self.rolled {
            return rolled.largest_fraction(model, &self.pairs, motion, cap);
        }
        let [da1, da2] = motion.lattice;
        let swing = |e: usize| model.elements[e].reach * motion.elements[e].1.norm();
        // What is carried along moves little where a large cell grows by much.
        let (own, spread) = match motion.carried {
            true => (model.cell.primitive(da1, da2), self.spread_carried),
            false => ([da1, da2], self.spread),
        };
        let own = model.short_basis.vectors(own[0], own[1]);
        let mut largest = own[0].norm().max(own[1].norm());
        for e in 0..model.elements.len() {
            largest = largest.max(motion.elements[e].0.norm() + swing(e));
        }
        let mut fraction: f64 = 1.0;
        let mut limit = |motion: f64, allowed: f64| {
            if motion * fraction > allowed {
                fraction = allowed / motion;
            }
        };
        limit(largest, cap);
        // A pair beyond the margin, reference points L apart: core distance ≥ L − 2 widest, motion ≤ 2 largest +
        // growth (L + spread); enough at L = 2 widest + margin, because growth < 1 from there on.
        let margin = MARGIN * model.largest_radius;
        let widest = model.elements.iter().map(|e| e.reach).fold(0.0, f64::max);
        let growth = largest_growth(self.lattice, motion.lattice);
        limit(2.0 * largest + growth * (2.0 * widest + margin + spread), SAFETY * margin);
        limit(growth, 0.5);
        for near in self.pairs.iter() {
            let pair = &near.pair;
            let (i, j) = (model.rings[pair.ring_a].element, model.rings[pair.ring_b].element);
            let (p, q) = (f64::from(pair.shift[0]), f64::from(pair.shift[1]));
            let apart = motion.carries(model, j) - motion.carries(model, i);
            let relative = motion.elements[j].0 - motion.elements[i].0 + da1 * p + da2 * q + apart;
            let motion = relative.norm() + swing(i) + swing(j);
            if motion > SAFETY * near.floor {
                limit(motion, SAFETY * near.distance());
            }
        }
        fraction
    }
}
