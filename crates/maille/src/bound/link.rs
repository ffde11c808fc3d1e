//! The link bound: all links at once, with the poses relaxed to a convex set.
//!
//! **Program.** Maximise l1 over centres c_i and matrices Q_i in conv SO(3), subject to, for every tie k,
//!
//! |g_k| ≤ L_k,  g_k = Σ_m w_m (c_m + Q_m o_m + F s_m),  Σ_m w_m = 0,  F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ,
//!
//! the sum being over rings m of the tie, with their elements' c_m and Q_m, offsets o_m and shifts s_m. Each tie is an
//! inequality that every state obeys: links, strand pairs and crossing pairs, see [`super::tie`].
//!
//! conv SO(3) is {Q: I + N(Q) ⪰ 0}, N(Q) being the symmetric 4×4 matrix with uᵀN(Q)u = ⟨Q, R(u)⟩ for the rotation R(u)
//! of a unit quaternion u (Saunderson, Parrilo, Willsky, *Semidefinite descriptions of the convex hull of rotation
//! matrices*, 2015). Elements whose rings are concentric need no Q: the centre of their rings is their reference.
//!
//! **Proof.** What is reported is no solver's primal value, but a value that any forces y_k, one for each tie, prove: let them
//! balance on every element, Σ w_m y_k = 0. Then Σ_k y_k·g_k has no centre in it, and with P = Σ (y_k·D)(S_k·D),
//! T = Σ (y_k·D⊥)(S_k·D⊥), S_k = Σ w_m s_m, M_i = Σ w_m y_k o_mᵀ over the rings m of element i,
//!
//! (1 + l1) P + (1 + l2) T + Σ_i ⟨Q_i, M_i⟩ = Σ_k y_k·g_k ≤ Σ_k |y_k| L_k,
//!
//! and ⟨Q, M⟩ ≥ −σ(−M) with the support function σ(M) = max ⟨Q, M⟩ over rotations, the largest eigenvalue of N(M). So
//!
//! 1 + l1 ≤ (Σ |y_k| L_k + Σ_i σ(−M_i) − (1 + l2) T)/P  for P > 0.
//!
//! Nothing is assumed of y but the balance, which a projection restores to rounding; what it leaves is charged with
//! the largest distance that the links allow. A value below 0 proves that no state with l1 > −1 has this l2.
//!
//! **Free width and shear** ([`Across`]). F = (1 + l1) D Dᵀ + (1 + l2) D⊥ D⊥ᵀ + γ D D⊥ᵀ is linear in what is free, so each is one
//! more unknown of the same program. With U = Σ (y_k·D)(S_k·D⊥) the left side gains γ U. Forces that prove a bound for
//! every l2 have T = 0, for every γ U = 0: the projection restores that as it does the balance, and the rest is charged
//! with the largest stretch that the chains allow.

use super::{
    chain::ChainBound,
    outcome::{BindingChain, Bound, DualForce},
    proof::{Query, quaternion_form},
    tie::{self, Tie, TieKind},
};
use crate::{
    lattice::{Across, Direction},
    model::Model,
    solver::cone::{Cone, ConeProgram, pack},
};
use maille_geometry::Vec3;
use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, Vector2};

/// What the link bound found for one direction and one l2.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkSolution {
    /// The bound that the forces prove; −1 or less: no state with l1 > −1 has this l2. Infinite where nothing is proved.
    pub l1: f64,
    /// What the solver reached from below, not quite feasible: the difference tells how well the program was solved.
    pub primal_l1: f64,
    /// The forces that prove it, for a unit pull: P = 1.
    pub dual: Vec<DualForce>,
    /// Iterations of the solver.
    pub iterations: usize,
}

impl LinkSolution {
    /// Nothing is proved.
    fn nothing() -> Self {
        LinkSolution { l1: f64::INFINITY, primal_l1: f64::INFINITY, dual: Vec::new(), iterations: 0 }
    }

    /// Whether it is proved that no state has this l2.
    pub fn l2_unreachable(&self) -> bool {
        self.l1 < -1.0 - 1e-9
    }
}

/// A proof of l1 below this ends the solve: no state has this l2, and the solver would go on towards −∞.
const UNREACHABLE: f64 = -1.01;

/// The link bound of one design.
#[derive(Clone, Debug)]
pub struct LinkBound {
    ties: Vec<Tie>,
    /// Major radii of the rings.
    radii: Vec<f64>,
    /// Whether all are circles: else normals say nothing.
    round: bool,
    /// First of the nine unknowns of Q, for elements that need it.
    turn: Vec<Option<usize>>,
    /// G and K, complete but for the column of 1 + l1, which depends on the direction.
    template: ConeProgram,
    chain: ChainBound,
}

/// Cells with more elements get the bound of the chains alone: the program is dense, and grows with the cube of their number.
const MOST_ELEMENTS: usize = 400;
/// Cells with more elements get no bound by normals: each of its steps balances all forces.
const MOST_BALANCED: usize = 40;

impl LinkBound {
    /// Prepares the program of `model`; its chain bound is used to charge rounding and to recognise free directions.
    pub fn new(model: &Model, chain: &ChainBound) -> Self {
        if model.elements.len() > MOST_ELEMENTS {
            return Self::of_chains(chain);
        }
        let references: Vec<Vec3> = model
            .elements
            .iter()
            .map(|e| e.rings.clone().map(|r| model.rings[r].offset).sum::<Vec3>() / e.rings.len() as f64)
            .collect();
        let mut ties = tie::all(model);
        let n_elements = model.elements.len();
        let mut turned = vec![false; n_elements];
        for tie in &mut ties {
            for term in &mut tie.terms {
                term.offset -= references[term.element];
                turned[term.element] |= term.offset.amax() > 1e-12;
            }
        }
        // Unknowns: 1 + l1, the centres but one in each connected part, the matrices.
        let free = held_apart(n_elements, &ties);
        let mut next = 1;
        let mut take = |yes: bool, n: usize| {
            let at = yes.then_some(next);
            next += if yes { n } else { 0 };
            at
        };
        let center: Vec<_> = free.into_iter().map(|yes| take(yes, 3)).collect();
        let turn: Vec<_> = turned.into_iter().map(|yes| take(yes, 9)).collect();
        let template = template(&ties, &center, &turn, next);
        let radii = model.rings.iter().map(|ring| ring.major_radius).collect();
        LinkBound { ties, radii, round: model.is_round(), turn, template, chain: chain.clone() }
    }

    /// The program of the chains alone, each of them a tie between a ring and its own image.
    pub(crate) fn of_chains(chain: &ChainBound) -> Self {
        let tie = |(x, chain): (Vector2<f64>, &BindingChain)| Tie {
            kind: TieKind::Chain,
            rings: chain.rings.clone(),
            terms: Vec::new(),
            span: (x * chain.length).push(0.0),
            length: chain.length,
        };
        let ties: Vec<Tie> = chain.directions().zip(chain.chains()).map(tie).collect();
        let template = template(&ties, &[], &[], 1);
        LinkBound { ties, radii: Vec::new(), round: true, turn: Vec::new(), template, chain: chain.clone() }
    }

    /// The bound of l1 along a direction with l2 held.
    pub fn limit(&self, direction: Direction, l2: f64) -> LinkSolution {
        self.limit_across(direction, l2, Across::HELD)
    }

    /// The bound of l1 along a direction, with l2 and the shear held or free.
    pub(crate) fn limit_across(&self, direction: Direction, l2: f64, free: Across) -> LinkSolution {
        let Some(query) = self.query(direction, l2, free) else { return LinkSolution::nothing() };
        let Query { along, across, .. } = query;
        let mut program = self.template.clone();
        let held = program.cost.len();
        let axes: Vec<Vec3> = query.free_axes().collect();
        program.cost.resize_vertically_mut(held + axes.len(), 0.0);
        program.matrix.resize_horizontally_mut(held + axes.len(), 0.0);
        for (k, tie) in self.ties.iter().enumerate() {
            let pulled = along * tie.span.dot(&along);
            let width = if free.lateral_free { 0.0 } else { 1.0 + l2 };
            let fixed = across * (tie.span.dot(&across) * width);
            for axis in 0..3 {
                for (m, free) in axes.iter().enumerate() {
                    program.matrix[(4 * k + 1 + axis, held + m)] = -free[axis] * tie.span.dot(&across);
                }
                program.matrix[(4 * k + 1 + axis, 0)] = -pulled[axis];
                program.offset[4 * k + 1 + axis] = fixed[axis];
            }
        }
        let mut best: Option<(f64, Vec<Vec3>)> = None;
        let solution = program.solve(|z| {
            if let Some(proof) = query.polished(&query.forces(z))
                && best.as_ref().is_none_or(|(least, _)| proof.0 < *least)
            {
                best = Some(proof);
            }
            best.as_ref().is_some_and(|(l1, _)| *l1 < UNREACHABLE)
        });
        let Some((l1, forces)) = best else { return LinkSolution::nothing() };
        let pull = query.pull(&forces);
        LinkSolution {
            l1,
            primal_l1: solution.x[0] - 1.0,
            dual: self.dual(&forces, pull),
            iterations: solution.iterations,
        }
    }

    /// The bound with one normal for each ring, `docs/theory/bounds.md`, "Normals of the rings": lower where the forces at a ring
    /// pull out of a plane. It takes longer, and is not solved to the last digit.
    pub fn limit_by_normals(&self, direction: Direction, l2: f64, free: Across) -> LinkSolution {
        let linked = self.ties.iter().any(Tie::is_link) && self.round && self.turn.len() <= MOST_BALANCED;
        let query = self.query(direction, l2, free).filter(|_| linked);
        let found = query.and_then(|query| query.descend().map(|(l1, forces)| (query.pull(&forces), l1, forces)));
        let Some((pull, l1, forces)) = found else { return LinkSolution::nothing() };
        LinkSolution { l1, primal_l1: f64::NEG_INFINITY, dual: self.dual(&forces, pull), iterations: 0 }
    }

    /// What is asked; `None` where the chains give no bound.
    fn query(&self, direction: Direction, l2: f64, free: Across) -> Option<Query<'_>> {
        let largest_stretch = match self.chain.limit(direction, l2) {
            _ if free.any() => self.chain.largest_stretch(),
            Bound::Unbounded => return None,
            Bound::Finite { l1, .. } => (1.0 + l1).max(1.0 + l2),
            Bound::L2Unreachable { .. } => 1.0 + l2.max(0.0),
        };
        let (along, across) = (direction.along().push(0.0), direction.across().push(0.0));
        let LinkBound { ties, radii, turn, .. } = self;
        Some(Query { ties, radii, turn, along, across, l2, free, largest_stretch })
    }

    /// The forces that are not 0, for a unit pull.
    fn dual(&self, forces: &[Vec3], pull: f64) -> Vec<DualForce> {
        let of = |(tie, y): (&Tie, &Vec3)| DualForce { kind: tie.kind, rings: tie.rings.clone(), force: y / pull };
        self.ties.iter().zip(forces).filter(|(_, y)| **y != Vec3::zeros()).map(of).collect()
    }
}

/// For each element whether its centre is an unknown: all but the first of every connected part.
fn held_apart(n: usize, ties: &[Tie]) -> Vec<bool> {
    let mut part: Vec<usize> = (0..n).collect();
    for tie in ties {
        for pair in tie.terms.windows(2) {
            let (a, b) = (part[pair[0].element], part[pair[1].element]);
            part.iter_mut().filter(|p| **p == a.max(b)).for_each(|p| *p = a.min(b));
        }
    }
    (0..n).map(|i| part[i] != i).collect()
}

/// G, h and K without the column and the offsets that depend on the query.
fn template(ties: &[Tie], center: &[Option<usize>], turn: &[Option<usize>], n: usize) -> ConeProgram {
    let mut cones = vec![Cone::Norm; ties.len()];
    cones.extend(turn.iter().flatten().map(|_| Cone::Positive));
    let rows = cones.iter().map(|c| c.rows()).sum();
    let mut program =
        ConeProgram { cost: DVector::zeros(n), matrix: DMatrix::zeros(rows, n), offset: DVector::zeros(rows), cones };
    program.cost[0] = -1.0;
    for (k, tie) in ties.iter().enumerate() {
        program.offset[4 * k] = tie.length;
        for term in &tie.terms {
            for axis in 0..3 {
                let row = 4 * k + 1 + axis;
                if let Some(first) = center[term.element] {
                    program.matrix[(row, first + axis)] -= term.weight;
                }
                if let Some(first) = turn[term.element] {
                    for column in 0..3 {
                        program.matrix[(row, first + 3 * axis + column)] -= term.weight * term.offset[column];
                    }
                }
            }
        }
    }
    for (k, first) in turn.iter().flatten().enumerate() {
        let row = 4 * ties.len() + 10 * k;
        program.offset.as_mut_slice()[row..row + 10].copy_from_slice(&pack(&Matrix4::identity()));
        for (entry, column) in (*first..first + 9).enumerate() {
            let mut unit = Matrix3::zeros();
            unit[(entry / 3, entry % 3)] = 1.0;
            for (m, value) in pack(&quaternion_form(&unit)).into_iter().enumerate() {
                program.matrix[(row + m, column)] = -value;
            }
        }
    }
    program
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::cone::eigenvalues;
    use nalgebra::{Quaternion, UnitQuaternion, Vector4};

    #[test]
    fn quaternion_form_is_the_rotation() {
        let m = Matrix3::from_fn(|i, j| (2.0 * i as f64 + 3.1 * j as f64).sin());
        let u = UnitQuaternion::new_normalize(Quaternion::new(0.3, -0.7, 0.2, 0.5));
        let v = Vector4::new(u.w, u.i, u.j, u.k);
        let direct = m.dot(u.to_rotation_matrix().matrix());
        assert!((v.dot(&(quaternion_form(&m) * v)) - direct).abs() < 1e-14);
    }

    /// σ of a moment is reached by a rotation: s1 + s2 ± s3 by the sign of det M.
    #[test]
    fn support_of_the_rotations() {
        let most = |m: Matrix3<f64>| eigenvalues(quaternion_form(&m)).into_iter().fold(f64::NEG_INFINITY, f64::max);
        assert!((most(Matrix3::from_diagonal(&Vec3::new(3.0, 2.0, 1.0))) - 6.0).abs() < 1e-14);
        assert!((most(Matrix3::from_diagonal(&Vec3::new(3.0, 2.0, -1.0))) - 4.0).abs() < 1e-14);
    }
}
