//! How far a step of a rolled sheet may go.
//!
//! **Steps.** An element's image is at G_{s+c}(q), with q, the lattice and its turns linear in the part t of the step. With the
//! rates θ̇ and α̇ of the turn and of the length of s + c, and |S′| ≤ ½, |S″| ≤ ⅓ (`state::roll`),
//!
//!   |P̈| ≤ 2E := θ̇² (|q⊥| + |δ| + max|α| / 3) + |α̇ θ̇| + 2 |θ̇ δ|,
//!
//! q⊥ across the axis, for its centre's acceleration is θ̇² (w × (w × R q) + α S″) + 2 α̇ θ̇ S′ + 2 θ̇ w × R δ. So the reference
//! point moves by at most |Ṗ(0)| t + E t², and the element about it by at most reach (|ω| + |θ̇|) t. Two circles cannot meet while the
//! sum of this for both, with the relative Ṗ(0), is below their distance.
//!
//! **Far pairs.** Let b ≥ |q| for all elements, and |θ| ≤ Θ < 2π for all that counts but what one link or two join: such pairs
//! are bounded one by one wherever they are. The origin's image is at a distance
//! h = |(α sinc(θ/2), β)| from it, and sinc(θ/2) ≥ σ := sinc(Θ/2). Reference points that are now L apart have |(α, β)| ≥ L − 2b, and
//! while no lattice vector shrinks by more than a share g, they stay at least σ (1 − g)(L − 2b) − 2 (b + δ) apart. Where this is more
//! than twice the largest reach they cannot meet at any turn; those that are nearer now are bounded one by one. By β alone, as
//! |α| ≤ Θ ϱ with ϱ = |α/θ|, they stay at least (1 − g)(L − 2b − Θ ϱ) − g Θ max(ϱ, 1) − 2 (b + δ) apart, which counts where it is more;
//! where ϱ < 1 the growth is that of (θ, β). Pairs that come to count by the step, as the turn for each length falls, are looked at from then on, and their links at the end.

use super::{
    motion::{MARGIN, Motion, SAFETY, largest_growth},
    near_pairs::NearPair,
    window::{Window, neighbours},
};
use crate::{
    lattice::Shift,
    model::Model,
    state::{Carried, Roll, State},
};
use maille_geometry::Vec3;
use std::collections::BTreeSet;

/// Growth of the lattice in one step at most.
const GROWTH: f64 = 0.25;
/// Motion of an element in one step at most, in largest radii.
const FARTHEST: f64 = 0.5;

/// Pairs that are farther apart than this cannot meet in a step.
fn far(window: &Window<'_>) -> f64 {
    let widest = window.model.elements.iter().map(|e| e.reach).fold(0.0, f64::max);
    let needed = 2.0 * (widest + window.wide + FARTHEST * window.model.largest_radius);
    let (by_turn, shrunk) = (window.length_by_turn, 1.0 - GROWTH);
    let by_chord = needed / (window.least_sinc() * shrunk);
    let beside = window.most_rad * by_turn + (needed + GROWTH * window.most_rad * by_turn.max(1.0)) / shrunk;
    2.0 * window.wide + if by_turn < 1.0 { beside } else { by_chord.min(beside) }
}

/// What bounds the steps from a rolled state.
pub(super) struct RolledBound {
    state: State,
    roll: Roll,
    /// Elements whose reference points are not yet far: (i, j, shift).
    pairs: Vec<(usize, usize, Shift)>,
}

/// How far one image may come: its first-order motion, what it may add beyond, and the turn that comes with it.
struct Moves {
    first: Vec3,
    beyond: f64,
    turn: f64,
}

impl RolledBound {
    pub fn new(model: &Model, state: &State, roll: &Roll) -> Self {
        let far = far(&Window::new(model, state, roll));
        // Its reaches are added there.
        let near = neighbours(model, state, roll, 0.0, far);
        let pairs =
            near.into_iter().enumerate().flat_map(|(i, of)| of.into_iter().map(move |(j, shift)| (i, j, shift)));
        // Joined pairs count at any turn: they are looked at wherever they are.
        let joined = model.joined().iter().enumerate();
        let joined = joined.flat_map(|(i, of)| of.iter().map(move |(j, shift)| (i, *j, *shift)));
        let pairs: BTreeSet<_> = pairs.chain(joined).collect();
        RolledBound { state: state.clone(), roll: *roll, pairs: pairs.into_iter().collect() }
    }

    fn moves(&self, model: &Model, motion: &Motion, e: usize, shift: Shift) -> Moves {
        let anchor = if motion.carried { model.elements[e].anchor } else { [0.0; 2] };
        let at: [f64; 2] = std::array::from_fn(|k| f64::from(shift[k]) + anchor[k]);
        let carried: Carried = self.state.carried(&self.roll, e, anchor, shift);
        let (own, swing) = motion.elements[e];
        let lattice = motion.lattice[0] * at[0] + motion.lattice[1] * at[1];
        let turn = motion.turn_rad[0] * at[0] + motion.turn_rad[1] * at[1];
        let first = carried.rate(&lattice, turn) + carried.turned(&own);
        let grown = lattice.dot(&self.roll.along);
        let longest = carried.length.abs().max((carried.length + grown).abs());
        let across = self.roll.axis().cross(&carried.arm).norm();
        let (turn, own) = (turn.abs(), own.norm());
        let twice = turn * turn * (across + own + longest / 3.0) + (grown * turn).abs() + 2.0 * turn * own;
        Moves { first, beyond: 0.5 * twice, turn: model.elements[e].reach * (swing.norm() + turn) }
    }

    /// See [`super::step_bound::StepBound::largest_fraction`].
    pub fn largest_fraction(&self, model: &Model, near: &[NearPair], motion: &Motion, cap: f64) -> f64 {
        let mut fraction: f64 = 1.0;
        // The largest t with t·motion + t²·beyond ≤ allowed.
        let mut limit = |motion: f64, beyond: f64, allowed: f64| {
            if motion * fraction + beyond * fraction * fraction > allowed {
                fraction = 2.0 * allowed / (motion + (motion * motion + 4.0 * beyond * allowed).sqrt());
            }
        };
        let own: Vec<Moves> = (0..model.elements.len()).map(|e| self.moves(model, motion, e, [0, 0])).collect();
        let moves = |i: usize, j: usize, shift: Shift| {
            let (a, b) = (&own[i], self.moves(model, motion, j, shift));
            ((b.first - a.first).norm() + a.turn + b.turn, a.beyond + b.beyond)
        };
        for Moves { first, beyond, turn } in &own {
            limit(first.norm() + turn, *beyond, cap.min(FARTHEST * model.largest_radius));
        }
        let window = Window::new(model, &self.state, &self.roll);
        let lattice = window.coordinates([self.state.a1, self.state.a2], self.roll.turn_rad);
        let change = window.coordinates(motion.lattice, motion.turn_rad);
        limit(largest_growth(lattice, change), 0.0, GROWTH);
        let margin = SAFETY * MARGIN * model.largest_radius;
        // Both lists go through the elements in the same order.
        let mut near = near.iter().peekable();
        for &(i, j, shift) in &self.pairs {
            let bound = moves(i, j, shift);
            let of = |pair: &NearPair| {
                let element = |ring: usize| model.rings[ring].element;
                (element(pair.pair.ring_a), element(pair.pair.ring_b), pair.pair.shift)
            };
            // Rings that are not near are farther apart than the margin.
            let mut apart = 0.0;
            if bound.0 + bound.1 > margin {
                let way = self.state.image(shift).way(&self.state.poses[i].position, &self.state.poses[j].position);
                apart = SAFETY * (way.norm() - model.elements[i].reach - model.elements[j].reach);
            }
            limit(bound.0, bound.1, margin.max(apart));
            while let Some(pair) = near.next_if(|pair| of(pair) <= (i, j, shift)) {
                if bound.0 + bound.1 > SAFETY * pair.floor {
                    limit(bound.0, bound.1, SAFETY * pair.distance());
                }
            }
        }
        fraction
    }
}
