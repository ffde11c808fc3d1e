//! Sensitivities: how a certified value changes with the numbers of its design, at no further solve.
//!
//! A limit is a maximum of p₀ under gaps g_k(y; q) ≥ 0, with unknowns y (poses, p₀, what is free) and the design's numbers q.
//! By the envelope theorem dp₀/dq = Σ μ_k ∂g_k/∂q at fixed y, with the multipliers μ of the certificate. With the contact's
//! points a and b, n from a to b, and u outwards from the ring's centre to the point, in the state of the limit:
//!
//! | number | ∂g/∂q |
//! | --- | --- |
//! | R | n·u_b of B, −n·u_a of A |
//! | r | −1; of the thickest wire −f, the factor of the wire |
//! | offset, turned by the element's rotation Q | Qᵀn of B, −Qᵀn of A |
//! | tilt about the ring's centre, arm ρ = R u | Qᵀ(ρ_b × n) of B, −Qᵀ(ρ_a × n) of A |
//! | lattice vector a_j of the design | w_j Fᵀn, where the contact's image stands w₁ a₁ + w₂ a₂ away in the design's own lattice |
//!
//! as the lattice is F a_j, and F is fixed with the unknowns. Centres of elements are unknowns, so the value does not depend on
//! them. Copies of a ring add up. Derivation, kinks and measurements: `docs/theory/sensitivity.md`.

mod chains;
mod images;
mod multipliers;
mod numbers;
mod point;
mod slope;

pub(crate) use chains::is_link;
pub(crate) use images::permutations;
pub use numbers::{DesignVector, RingVector};
pub use slope::{OneSided, Slope};

use self::{
    chains::ChainLimit,
    multipliers::{Least, Multipliers},
    point::Point,
};
use crate::{
    answer::Answer,
    lattice::Shift,
    model::{Model, RingPair},
    program::{SheetProgram, key::pair_of_key},
    question::{Goal, Question, Sense},
    search::family::family_at,
    solver::{constraints::Row, sqp::Program},
    state::State,
    symmetry::Operation,
};
use maille_design::InvalidInput;
use maille_geometry::{Vec3, point_circle_distance};
use nalgebra::Matrix2;
use std::sync::OnceLock;

/// The derivatives of a certified value by the numbers of its design.
pub struct Sensitivity {
    points: Vec<Point>,
    multipliers: Multipliers,
    rings: usize,
    /// 1 where the value was maximised, −1 where it was minimised.
    sign: f64,
    loose: usize,
    model: Model,
    question: Question,
    /// Where the limit attains its chain bound.
    chains: Option<ChainLimit>,
    /// The symmetries that keep the question, and the design in its own cell, once they are asked for.
    symmetries: OnceLock<(Vec<Operation>, Model)>,
}

/// Forces of a state that is taken for a limit may be out of balance by this; those below 1e-9 are not recorded.
const BALANCED: f64 = 1e-6;

impl Sensitivity {
    /// Of a certified answer to `question`, in the model of the answer's cell (`Sheet::model_of`).
    ///
    /// # Errors
    /// Where the answer is not certified or carries no forces, or its forces do not balance in this question and model;
    /// for the area of a closest cell; for a design with curves that are no circles.
    pub fn of(model: &Model, question: &Question, answer: &Answer) -> Result<Self, InvalidInput> {
        let certified = answer.is_limit() && answer.certificate.as_ref().is_some_and(|c| c.holds());
        if !model.is_round() {
            let help = "its limits, certificates and forces are there; vary a number by a study instead";
            return Err(InvalidInput::new("design", "has curves, for which no derivatives are known yet", help));
        }
        let value = answer.value.filter(|_| certified && !answer.contacts.is_empty()).ok_or_else(|| {
            let problem = format!("an answer that is {} has no certified forces", answer.status.name());
            InvalidInput::new(
                "answer",
                problem,
                "derivatives follow from the forces of a certified limit; search longer",
            )
        })?;
        let (family, p) = family_at(model, question, answer)?;
        let program = SheetProgram::new(model, &family);
        let at = program.posed(answer.state.clone(), p);
        let foreign = |problem: &str| {
            InvalidInput::new("answer", problem, "give the question of this answer, and the model of its cell")
        };
        if answer.state.poses.len() != model.elements.len() {
            return Err(foreign("its state has not the elements of the model"));
        }
        let rows = program
            .closed_points(&at, &answer.contacts)
            .ok_or_else(|| foreign("one of its contacts is open in this model"))?;
        let c = program.objective();
        let multipliers = Multipliers::new(rows, c.len(), answer.contacts.iter().map(|contact| contact.force));
        if multipliers.residual(&c) > BALANCED {
            return Err(foreign("its forces do not balance in this question and model"));
        }
        let wire = matches!(question.goal, Goal::Wire { .. });
        let kinematics = Kinematics {
            model,
            state: &at.state,
            gradient: answer.gradient,
            own: model.rings.len() / model.cell.copies(),
            copies: model.cell.cosets(),
            wire: if wire { value } else { 1.0 },
            length: if matches!(question.goal, Goal::Clearance { .. }) { 1.0 } else { 1.0 / model.unit },
            angle: if matches!(question.goal, Goal::Clearance { .. }) { model.unit } else { 1.0 },
        };
        Ok(Sensitivity {
            points: multipliers.rows.iter().map(|row| kinematics.point(row)).collect(),
            multipliers,
            rings: kinematics.own,
            sign: if question.sense == Sense::Least { -1.0 } else { 1.0 },
            loose: answer.certificate.as_ref().map_or(0, |certificate| certificate.zero_modes),
            model: model.clone(),
            question: question.clone(),
            chains: ChainLimit::of(model, question, answer),
            symmetries: OnceLock::new(),
        })
    }

    /// The derivatives by all numbers of the design, in the design's unit: of l1, a strain or the factor of the wire by lengths per
    /// unit of length, of a clearance as they are; by tilts per radian. With the forces of the answer, which at a kink are one
    /// choice of many, and of the answer's own state, which may be one of several images ([`Self::one_sided`]).
    pub fn gradient(&self) -> DesignVector {
        let mut out = DesignVector::zeros(self.rings);
        for (point, mu) in self.points.iter().zip(&self.multipliers.first).filter(|(_, mu)| **mu != 0.0) {
            point.rings.iter().for_each(|(ring, rates)| out.rings[*ring].add(self.sign * mu, rates));
            (0..2).for_each(|k| out.lattice[k] += point.lattice[k] * (self.sign * mu));
        }
        out
    }

    /// The derivative along a change of the design, with the forces and the state of the answer: at a kink one choice of many, see
    /// [`Self::one_sided`].
    ///
    /// # Panics
    /// For a change of a design with another number of rings.
    pub fn along(&self, change: &DesignVector) -> f64 {
        self.sign * self.multipliers.first_sum(&self.rates(change))
    }

    /// The derivatives along a change of the design to both sides. A maximum rises by the least Σ μ ∂g/∂q over all forces that
    /// balance, forward, and falls by the largest, backward. Where symmetries of the design make other states of the limit, it is the best
    /// of them all to each side. A limit that attains its chain bound goes no further than that, whichever of several taut chains carries the force
    /// in its state.
    ///
    /// # Panics
    /// For a change of a design with another number of rings.
    pub fn one_sided(&self, change: &DesignVector) -> OneSided {
        let images = self.images_of(change);
        let all = std::iter::once(change).chain(&images).map(|change| self.own_one_sided(change));
        let best = images::best(all, self.sign).expect("the state itself");
        self.chains.as_ref().map_or(best, |chains| chains.bounded(best, change))
    }

    /// Whether symmetries of the design make other states of the limit with other derivatives along a change: limits that tie, between
    /// which the change chooses. Then [`Self::along`] is the derivative of the answer's own state alone.
    ///
    /// # Panics
    /// For a change of a design with another number of rings.
    pub fn images_tie(&self, change: &DesignVector) -> bool {
        let own = self.own_one_sided(change);
        self.images_of(change).iter().any(|image| {
            let there = self.own_one_sided(image);
            [(own.backward, there.backward), (own.forward, there.forward)]
                .into_iter()
                .any(|(backward, forward)| OneSided { backward, forward }.is_kink())
        })
    }

    fn images_of(&self, change: &DesignVector) -> Vec<DesignVector> {
        assert_eq!(change.rings.len(), self.rings, "a change of a design with as many rings");
        let (operations, design) =
            self.symmetries.get_or_init(|| (images::symmetries(&self.model, &self.question), self.model.primitive()));
        images::changes(operations, design, &self.points, change)
    }

    /// Of the answer's own state.
    fn own_one_sided(&self, change: &DesignVector) -> OneSided {
        let rates = self.rates(change);
        let slope = |sign: f64| {
            let turned: Vec<f64> = rates.iter().map(|rate| rate * sign).collect();
            match self.multipliers.least(&turned) {
                Least::Value(least) => Slope::Finite(self.sign * sign * least + 0.0),
                Least::Unbounded => Slope::NoState,
                Least::NotFound => Slope::NotFound,
            }
        };
        OneSided { backward: slope(-1.0), forward: slope(1.0) }
    }

    /// What each pair of rings contributes to [`Self::along`], the largest first; pairs that contribute nothing are left out. Rings and
    /// shifts are those of the design's own cell: the copies of a pair in a larger one are summed.
    ///
    /// # Panics
    /// For a change of a design with another number of rings.
    pub fn by_pair(&self, change: &DesignVector) -> Vec<(RingPair, f64)> {
        let mut out: Vec<(RingPair, f64)> = Vec::new();
        for ((point, mu), rate) in self.points.iter().zip(&self.multipliers.first).zip(self.rates(change)) {
            let part = self.sign * mu * rate;
            match out.iter_mut().find(|(pair, _)| *pair == point.pair) {
                Some((_, sum)) => *sum += part,
                None => out.push((point.pair, part)),
            }
        }
        let largest = out.iter().map(|(_, part)| part.abs()).fold(0.0, f64::max);
        out.retain(|(_, part)| part.abs() > 1e-9 * largest);
        out.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        out
    }

    /// Whether the forces that balance are the only ones. Else, and where another chain is taut without force, some numbers of the design may
    /// have different derivatives to both sides: see [`Self::one_sided`].
    pub fn forces_are_unique(&self) -> bool {
        self.multipliers.unique()
    }

    /// Motions of loose rings that keep the loaded contacts. Where a state is not unique, other states could carry other forces;
    /// the derivatives are those of this state, and the value changes by no less than the forward one promises.
    pub fn loose_motions(&self) -> usize {
        self.loose
    }

    fn rates(&self, change: &DesignVector) -> Vec<f64> {
        assert_eq!(change.rings.len(), self.rings, "a change of a design with as many rings");
        let rate = |point: &Point| {
            let rings = point.rings.iter().map(|(ring, rates)| rates.dot(&change.rings[*ring])).sum::<f64>();
            rings + (0..2).map(|k| point.lattice[k].dot(&change.lattice[k])).sum::<f64>()
        };
        self.points.iter().map(rate).collect()
    }
}

/// The derivatives of an answer along changes of its design.
///
/// # Errors
/// As [`Sensitivity::of`], and for changes of a design with another number of rings.
pub fn gradient(
    model: &Model,
    question: &Question,
    answer: &Answer,
    changes: &[DesignVector],
) -> Result<Vec<f64>, InvalidInput> {
    let all = Sensitivity::of(model, question, answer)?.gradient();
    if changes.iter().any(|change| change.rings.len() != all.rings.len()) {
        let help = "give changes of the design of this model";
        return Err(InvalidInput::new("changes", "one is of a design with another number of rings", help));
    }
    Ok(changes.iter().map(|change| all.dot(change)).collect())
}

/// What turns a closed point into derivatives by the design's numbers.
struct Kinematics<'a> {
    model: &'a Model,
    state: &'a State,
    /// F: the lattice is F times that of the design.
    gradient: Matrix2<f64>,
    /// Rings of the design.
    own: usize,
    /// Where the cell's copies of the design's cell stand, in lattice vectors of the design.
    copies: Vec<Shift>,
    /// Factor of all minor radii.
    wire: f64,
    /// Factors that turn derivatives into the design's unit.
    length: f64,
    angle: f64,
}

impl Kinematics<'_> {
    fn point(&self, row: &Row) -> Point {
        let pair = pair_of_key(row.key);
        let (a, b) = (
            self.state.circle(self.model, pair.ring_a, [0, 0]),
            self.state.circle(self.model, pair.ring_b, pair.shift),
        );
        let point_b = b.point(row.angle);
        let point_a = point_circle_distance(&point_b, &a).point;
        let n = (point_b - point_a).normalize();
        let ring = |ring: usize, arm: Vec3, push: Vec3| {
            let turn = self.state.poses[self.model.rings[ring].element].rotation.inverse();
            let rates = RingVector {
                major_radius: push.dot(&arm.normalize()),
                minor_radius: -self.wire,
                offset: turn * push,
                tilt: turn * arm.cross(&push),
            };
            (ring % self.own, rates.times(self.length, self.angle))
        };
        let rings = [ring(pair.ring_a, point_a - a.center, -n), ring(pair.ring_b, point_b - b.center, n)];
        let pulled = self.gradient.transpose() * n.xy() * self.length;
        let apart = self.apart(&pair);
        let own = RingPair { ring_a: pair.ring_a % self.own, ring_b: pair.ring_b % self.own, shift: apart };
        let [one, other] = own.both_ways();
        Point { pair: one.min(other), rings, lattice: apart.map(|weight| pulled * f64::from(weight)) }
    }

    /// From the design's cell that ring A belongs to, to that of ring B.
    fn apart(&self, pair: &RingPair) -> Shift {
        let [from, to] = [pair.ring_a, pair.ring_b].map(|ring| self.copies[ring / self.own]);
        let cell = self.model.cell.rows();
        [0, 1].map(|j| to[j] - from[j] + (0..2).map(|k| pair.shift[k] * cell[k][j]).sum::<i32>())
    }
}
