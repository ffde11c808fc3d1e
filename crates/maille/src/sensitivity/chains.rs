//! Derivatives of the chain bound, where a limit attains it.
//!
//! A limit is never above its bound. Where it attains it, its derivative forward is at most that of the bound, and its derivative backward at
//! least that. The bound is the least over all chains, so at a tie each chain of the tie says something: also those that carry nothing
//! in the state that was found, and are not quite straight in it, so that their forces do not balance there.
//!
//! For a chain of length d along the lattice vector v, (1 + l1)² (v·D)² + (1 + l2)² (v·D⊥)² = d², and so
//!
//! dl1 = (d dd − (1 + l1)² (v·D)(dv·D) − (1 + l2)² (v·D⊥)(dv·D⊥)) / ((1 + l1)(v·D)²),
//!
//! with dd = dR_a + dR_b − dr_a − dr_b for each link of a and b, and o·(do_a − do_b) for two rings of one element, o being the unit vector
//! between their centres.

use super::{
    numbers::DesignVector,
    slope::{OneSided, Slope},
};
use crate::{
    answer::Answer,
    bound::{BindingChain, Bound, BoundKind, ChainBound},
    lattice::{Direction, Shift},
    model::Model,
    question::{Goal, Question},
    record::Status,
};
use maille_geometry::Vec3;

/// A limit attains its bound within this, and chains tie within it.
const TIE: f64 = 1e-9;
/// Step of the design that shows which chain of a tie counts to one side, in reference radii.
const STEP: f64 = 1e-7;

/// A limit that attains its chain bound.
pub(super) struct ChainLimit {
    /// The design in its own cell.
    design: Model,
    direction: Direction,
    l1: f64,
    l2: f64,
}

impl ChainLimit {
    /// Of an answer that is proved by the chain bound; `None` of others.
    pub fn of(model: &Model, question: &Question, answer: &Answer) -> Option<Self> {
        let Goal::Stretch { direction_deg, l2, across } = question.goal else { return None };
        let proved = answer.status == Status::Global && answer.bound_kind == Some(BoundKind::Chain) && !across.any();
        let (direction, l1) = (Direction::of_degrees(direction_deg), answer.bound?);
        proved.then(|| ChainLimit { design: model.primitive(), direction, l1, l2 })
    }

    /// The derivatives as no further than the bound lets them be.
    pub fn bounded(&self, found: OneSided, change: &DesignVector) -> OneSided {
        let side = |found: Slope, sign: f64| match (found, self.slope(change, sign)) {
            (Slope::Finite(found), Some(bound)) => {
                Slope::Finite(if sign * found > sign * bound { bound } else { found })
            }
            (found, _) => found,
        };
        OneSided { backward: side(found.backward, -1.0), forward: side(found.forward, 1.0) }
    }

    /// The derivative of the bound for a step with this sign.
    fn slope(&self, change: &DesignVector, sign: f64) -> Option<f64> {
        let size = change.dot(change).sqrt() / self.design.unit;
        if size == 0.0 {
            return None;
        }
        let beside = changed(&self.design, change, sign * STEP / size);
        let Bound::Finite { chain: Some(chain), .. } = ChainBound::new(&beside).limit(self.direction, self.l2) else {
            return None;
        };
        self.slope_of(&chain, change, sign).filter(|slope| slope.is_finite())
    }

    /// That of one chain; `None` where it does not tie.
    fn slope_of(&self, chain: &BindingChain, change: &DesignVector, sign: f64) -> Option<f64> {
        let (mut length, mut rate) = (0.0, 0.0);
        for ends in chain.rings.windows(2) {
            let [a, b] = [ends[0].0, ends[1].0];
            let [ring_a, ring_b] = [a, b].map(|k| &self.design.rings[k]);
            let [by_a, by_b] = [a, b].map(|k| &change.rings[k]);
            if is_link(&self.design, ends) {
                length += ring_a.major_radius + ring_b.major_radius - self.design.contact_distance(a, b);
                rate += by_a.major_radius + by_b.major_radius - by_a.minor_radius - by_b.minor_radius;
            } else {
                let (apart, by) = (ring_a.offset - ring_b.offset, by_a.offset - by_b.offset);
                length += apart.norm();
                // Rings that share a centre are further apart after any step.
                rate += apart.try_normalize(TIE).map_or(sign * by.norm(), |along: Vec3| along.dot(&by));
            }
        }
        let (stretch, side) = (1.0 + self.l1, 1.0 + self.l2);
        let v = self.design.start.translation(chain.vector).xy();
        let dv = change.lattice[0] * f64::from(chain.vector[0]) + change.lattice[1] * f64::from(chain.vector[1]);
        let [along, across] = [self.direction.along(), self.direction.across()];
        let excess = (stretch * v.dot(&along)).hypot(side * v.dot(&across)) - length;
        let lattice =
            stretch * stretch * v.dot(&along) * dv.dot(&along) + side * side * v.dot(&across) * dv.dot(&across);
        let slope = (length * rate - lattice) / (stretch * v.dot(&along).powi(2)) / self.design.unit;
        (excess.abs() < TIE * (1.0 + length)).then_some(slope)
    }
}

/// Whether two neighbours along a chain are linked; else they are of one element.
pub(crate) fn is_link(model: &Model, ends: &[(usize, Shift)]) -> bool {
    let element = |end: &(usize, Shift)| (model.rings[end.0].element, end.1);
    element(&ends[0]) != element(&ends[1])
}

/// The design changed by a step, as far as chains go.
fn changed(design: &Model, change: &DesignVector, step: f64) -> Model {
    let mut out = design.clone();
    let step = step / design.unit;
    for (ring, by) in out.rings.iter_mut().zip(&change.rings) {
        ring.major_radius += step * by.major_radius;
        ring.minor_radius += step * by.minor_radius;
        ring.offset += by.offset * step;
    }
    out.start.a1 += (change.lattice[0] * step).push(0.0);
    out.start.a2 += (change.lattice[1] * step).push(0.0);
    out
}
