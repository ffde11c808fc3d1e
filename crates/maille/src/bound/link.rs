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
    tie::{self, Tie, TieKind},
};
use crate::{
    lattice::{Across, Direction},
    model::Model,
    solver::cone::{Cone, ConeProgram, eigenvalues, pack},
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
    n_elements: usize,
    /// First of the nine unknowns of Q, for elements that need it.
    turn: Vec<Option<usize>>,
    /// G and K, complete but for the column of 1 + l1, which depends on the direction.
    template: ConeProgram,
    chain: ChainBound,
}

/// Cells with more elements get the bound of the chains alone: the program is dense, and grows with the cube of their number.
const MOST_ELEMENTS: usize = 400;

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
        LinkBound { ties, n_elements, turn, template, chain: chain.clone() }
    }

    /// The program of the chains alone, each of them a tie between a ring and its own image.
    pub fn of_chains(chain: &ChainBound) -> Self {
        let tie = |(x, chain): (Vector2<f64>, &BindingChain)| Tie {
            kind: TieKind::Chain,
            rings: chain.rings.clone(),
            terms: Vec::new(),
            span: (x * chain.length).push(0.0),
            length: chain.length,
        };
        let ties: Vec<Tie> = chain.directions().zip(chain.chains()).map(tie).collect();
        let template = template(&ties, &[], &[], 1);
        LinkBound { ties, n_elements: 0, turn: Vec::new(), template, chain: chain.clone() }
    }

    /// The bound of l1 along a direction with l2 held.
    pub fn limit(&self, direction: Direction, l2: f64) -> LinkSolution {
        self.limit_across(direction, l2, Across::HELD)
    }

    /// The bound of l1 along a direction, with l2 and the shear held or free.
    pub fn limit_across(&self, direction: Direction, l2: f64, free: Across) -> LinkSolution {
        let nothing = LinkSolution { l1: f64::INFINITY, primal_l1: f64::INFINITY, dual: Vec::new(), iterations: 0 };
        let largest_stretch = match self.chain.limit(direction, l2) {
            _ if free.any() => self.chain.largest_stretch(),
            Bound::Unbounded => return nothing,
            Bound::Finite { l1, .. } => (1.0 + l1).max(1.0 + l2),
            Bound::L2Unreachable { .. } => 1.0 + l2.max(0.0),
        };
        let (along, across) = (direction.along().push(0.0), direction.across().push(0.0));
        let query = Query { bound: self, along, across, l2, free, largest_stretch };
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
        let Some((l1, forces)) = best else { return nothing };
        let pull = query.pull(&forces);
        LinkSolution {
            l1,
            primal_l1: solution.x[0] - 1.0,
            dual: self.dual(&forces, pull),
            iterations: solution.iterations,
        }
    }

    /// The forces that are not 0, for a unit pull.
    fn dual(&self, forces: &[Vec3], pull: f64) -> Vec<DualForce> {
        let of = |(tie, y): (&Tie, &Vec3)| DualForce { kind: tie.kind, rings: tie.rings.clone(), force: y / pull };
        self.ties.iter().zip(forces).filter(|(_, y)| **y != Vec3::zeros()).map(of).collect()
    }
}

/// One direction and l2 of a bound.
struct Query<'a> {
    bound: &'a LinkBound,
    along: Vec3,
    across: Vec3,
    l2: f64,
    free: Across,
    largest_stretch: f64,
}

impl Query<'_> {
    /// Where lines across the pull may be moved: along D⊥ where l2 is free, along D where the shear is.
    fn free_axes(&self) -> impl Iterator<Item = Vec3> {
        let lateral = self.free.lateral_free.then_some(self.across);
        lateral.into_iter().chain(self.free.shear_free.then_some(self.along))
    }

    /// T and U of what is free: they should be 0.
    fn unheld(&self, forces: &[Vec3]) -> Vec<f64> {
        let across = |axis: Vec3| {
            let ties = self.bound.ties.iter().zip(forces);
            ties.map(|(tie, y)| y.dot(&axis) * tie.span.dot(&self.across)).sum()
        };
        self.free_axes().map(across).collect()
    }

    /// Forces y of the multipliers z: (|y|, −y) in each cone.
    fn forces(&self, z: &DVector<f64>) -> Vec<Vec3> {
        (0..self.bound.ties.len()).map(|k| -Vec3::new(z[4 * k + 1], z[4 * k + 2], z[4 * k + 3])).collect()
    }

    /// P.
    fn pull(&self, forces: &[Vec3]) -> f64 {
        self.bound.ties.iter().zip(forces).map(|(tie, y)| y.dot(&self.along) * tie.span.dot(&self.along)).sum()
    }

    /// What is left of the balance on each element.
    fn imbalance(&self, forces: &[Vec3]) -> Vec<Vec3> {
        let mut out = vec![Vec3::zeros(); self.bound.n_elements];
        for (tie, y) in self.bound.ties.iter().zip(forces) {
            for term in &tie.terms {
                out[term.element] += term.weight * y;
            }
        }
        out
    }

    /// The l1 that these forces prove; `None` where they do not pull.
    fn prove(&self, forces: &[Vec3]) -> Option<f64> {
        let pull = self.pull(forces);
        if !(pull > 0.0 && pull.is_finite()) {
            return None;
        }
        let mut total = 0.0;
        let mut moments = vec![Matrix3::zeros(); self.bound.n_elements];
        let mut farthest = 0.0;
        for (tie, y) in self.bound.ties.iter().zip(forces) {
            total += y.norm() * tie.length;
            if !self.free.lateral_free {
                total -= (1.0 + self.l2) * y.dot(&self.across) * tie.span.dot(&self.across);
            }
            farthest += tie.length + self.largest_stretch * tie.span.norm();
            for term in &tie.terms {
                moments[term.element] -= term.weight * y * term.offset.transpose();
                farthest += term.offset.norm();
            }
        }
        for (moment, turn) in moments.iter().zip(&self.bound.turn) {
            if turn.is_some() {
                total += eigenvalues(quaternion_form(moment)).into_iter().fold(f64::NEG_INFINITY, f64::max);
            }
        }
        // Every centre is within `farthest` of the one that is held: along a path of ties each is used at most once.
        let left: f64 = self.imbalance(forces).iter().map(|r| r.norm()).sum();
        let unheld: f64 = self.unheld(forces).iter().map(|u| u.abs()).sum();
        if unheld > 0.0 {
            total += unheld * self.largest_stretch;
        }
        let l1 = (total + left * farthest) / pull - 1.0;
        l1.is_finite().then_some(l1)
    }

    /// The best that forces near `forces` prove, with them.
    ///
    /// Slack ties keep a small force in an interior point. Without them the value is flat to first order in the rest, so
    /// that half of the digits of y give all digits of the bound: cut at several levels, balance, and take the least.
    fn polished(&self, forces: &[Vec3]) -> Option<(f64, Vec<Vec3>)> {
        let most = forces.iter().map(|y| y.norm()).fold(0.0, f64::max);
        let mut best: Option<(f64, Vec<Vec3>)> = None;
        let mut kept_before = usize::MAX;
        for cut in [0.0, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3] {
            let kept: Vec<bool> = forces.iter().map(|y| y.norm() > cut * most).collect();
            let n_kept = kept.iter().filter(|k| **k).count();
            if n_kept == kept_before {
                continue;
            }
            kept_before = n_kept;
            let balanced = self.balanced(forces, &kept);
            if let Some(l1) = self.prove(&balanced)
                && best.as_ref().is_none_or(|(least, _)| l1 < *least)
            {
                best = Some((l1, balanced));
            }
        }
        best
    }

    /// The nearest balanced forces that vanish where `kept` is false: y − Bᵀ(B Bᵀ)⁺ B y.
    ///
    /// B Bᵀ is singular (a connected part moves freely); a small shift and a few rounds give the pseudo-inverse. The rows of
    /// what is free couple the three axes of space; without them each axis is solved for itself.
    fn balanced(&self, forces: &[Vec3], kept: &[bool]) -> Vec<Vec3> {
        let n = self.bound.n_elements;
        let mut square = DMatrix::<f64>::identity(n, n) * 1e-6;
        for (tie, _) in self.bound.ties.iter().zip(kept).filter(|(_, k)| **k) {
            for a in &tie.terms {
                for b in &tie.terms {
                    square[(a.element, b.element)] += a.weight * b.weight;
                }
            }
        }
        let mut out: Vec<Vec3> = forces.iter().zip(kept).map(|(y, k)| if *k { *y } else { Vec3::zeros() }).collect();
        if self.free.any() {
            self.balance_all(&mut out, kept);
            return out;
        }
        let Some(factor) = square.cholesky() else { return out };
        for _ in 0..4 {
            let left = self.imbalance(&out);
            let right = DMatrix::from_fn(n, 3, |i, axis| left[i][axis]);
            let shift = factor.solve(&right);
            for ((tie, y), _) in self.bound.ties.iter().zip(&mut out).zip(kept).filter(|(_, k)| **k) {
                for term in &tie.terms {
                    *y -= term.weight
                        * Vec3::new(shift[(term.element, 0)], shift[(term.element, 1)], shift[(term.element, 2)]);
                }
            }
        }
        out
    }

    /// The same with the rows of what is free.
    fn balance_all(&self, forces: &mut [Vec3], kept: &[bool]) {
        let n = 3 * self.bound.n_elements;
        let axes: Vec<Vec3> = self.free_axes().collect();
        // The rows of B that a tie's force enters, with its part in each of them.
        let entries = |tie: &Tie| -> Vec<(usize, Vec3)> {
            let balance = tie.terms.iter().flat_map(|term| {
                let axis = |k: usize| Vec3::from_fn(|i, _| if i == k { term.weight } else { 0.0 });
                (0..3).map(move |k| (3 * term.element + k, axis(k)))
            });
            let free = axes.iter().enumerate().map(|(m, axis)| (n + m, axis * tie.span.dot(&self.across)));
            balance.chain(free).collect()
        };
        let rows: Vec<Vec<(usize, Vec3)>> = self.bound.ties.iter().map(entries).collect();
        let mut square = DMatrix::<f64>::identity(n + axes.len(), n + axes.len()) * 1e-6;
        for (rows, _) in rows.iter().zip(kept).filter(|(_, k)| **k) {
            for (i, a) in rows {
                rows.iter().for_each(|(j, b)| square[(*i, *j)] += a.dot(b));
            }
        }
        let Some(factor) = square.cholesky() else { return };
        for _ in 0..4 {
            let balance = self.imbalance(forces).into_iter().flat_map(|r| [r.x, r.y, r.z]);
            let right: Vec<f64> = balance.chain(self.unheld(forces)).collect();
            let shift = factor.solve(&DVector::from_vec(right));
            for ((rows, y), _) in rows.iter().zip(&mut *forces).zip(kept).filter(|(_, k)| **k) {
                rows.iter().for_each(|(i, part)| *y -= part * shift[*i]);
            }
        }
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

/// N(M): uᵀN(M)u = ⟨M, R(u)⟩ for the rotation R(u) of the unit quaternion u = (w, x, y, z).
fn quaternion_form(m: &Matrix3<f64>) -> Matrix4<f64> {
    let [[xx, xy, xz], [yx, yy, yz], [zx, zy, zz]] = std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)]));
    Matrix4::new(
        xx + yy + zz,
        zy - yz,
        xz - zx,
        yx - xy, //
        zy - yz,
        xx - yy - zz,
        xy + yx,
        xz + zx, //
        xz - zx,
        xy + yx,
        yy - xx - zz,
        yz + zy, //
        yx - xy,
        xz + zx,
        yz + zy,
        zz - xx - yy,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
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
