//! How far a step may go so that no two core circles can meet on the way: what keeps the topology.
//!
//! Along a step every point of a pair of rings moves, relative to the other ring, by at most
//! |relative motion of the reference points| + reach_i |ω_i| + reach_j |ω_j|. While that stays below the pair's core
//! distance the circles cannot meet, so the isotopy class of the whole sheet is kept, which linking numbers alone do
//! not ensure for elements of several rings.

use super::near_pairs::{NearPair, near_pairs};
use crate::{
    model::{Element, Model},
    state::{Pose, State},
};
use maille_geometry::Vec3;
use std::rc::Rc;

/// A step: translation and rotation vector of every element, and the change of the lattice vectors.
pub(crate) struct Motion {
    /// (translation, rotation vector) of each element.
    pub elements: Vec<(Vec3, Vec3)>,
    /// Change of a1 and a2.
    pub lattice: [Vec3; 2],
    /// Whether the lattice carries the elements along, each at its copy of the design's cell: translations are then what is left.
    pub carried: bool,
}

impl Motion {
    /// Where the lattice carries element `e` to.
    pub(crate) fn carries(&self, model: &Model, e: usize) -> Vec3 {
        let [u, v] = if self.carried { model.elements[e].anchor } else { [0.0; 2] };
        self.lattice[0] * u + self.lattice[1] * v
    }
}

/// Core distances around a state, from which steps are bounded. A distance is looked for only where its floor would cut
/// the step.
pub struct StepBound {
    pairs: Rc<[NearPair]>,
    /// The lattice vectors.
    lattice: [Vec3; 2],
    /// Twice the farthest of an element from the first one; of where the lattice carries it.
    spread: f64,
    spread_carried: f64,
}

/// Pairs up to this many largest radii apart bound a step one by one.
pub(crate) const MARGIN: f64 = 1.5;
/// Largest fraction of a pair's core distance that a step may use.
const SAFETY: f64 = 0.9;

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
        StepBound { pairs, lattice: [state.a1, state.a2], spread, spread_carried }
    }

    /// Largest fraction of `motion`, at most 1, in which no circles can meet and no element moves more than `cap`.
    pub(crate) fn largest_fraction(&self, model: &Model, motion: &Motion, cap: f64) -> f64 {
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

/// Largest |Δa1 s1 + Δa2 s2| / |a1 s1 + a2 s2|: the root of the larger eigenvalue of Gram(a)⁻¹ Gram(Δa), whatever the basis.
fn largest_growth(lattice: [Vec3; 2], change: [Vec3; 2]) -> f64 {
    let gram = |[a, b]: [Vec3; 2]| (a.norm_squared(), a.dot(&b), b.norm_squared());
    let ((g11, g12, g22), (d11, d12, d22)) = (gram(lattice), gram(change));
    let det = g11 * g22 - g12 * g12;
    let half_trace = (g22 * d11 - 2.0 * g12 * d12 + g11 * d22) / (2.0 * det);
    let product = (d11 * d22 - d12 * d12) / det;
    (half_trace + (half_trace * half_trace - product).max(0.0).sqrt()).max(0.0).sqrt()
}
